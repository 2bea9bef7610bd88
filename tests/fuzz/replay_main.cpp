/// NAME_replay FOLDER: what NAME_fuzz does with every file of a folder, in the order of their names, in a build that
/// needs no libFuzzer. A broken promise aborts, as it does there; the file is the last one named.
///
/// Returns 0; 1 if there is no file, so that a lost folder is no success.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "formats/base/file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* count, char*** arguments);

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: %s FOLDER\n", arguments[0]);
        return 1;
    }
    if (LLVMFuzzerInitialize) LLVMFuzzerInitialize(&count, &arguments);
    std::vector<std::filesystem::path> files;
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(arguments[1], missing)) files.push_back(entry.path());
    std::ranges::sort(files);
    for (const auto& file : files) {
        std::fprintf(stderr, "%s\n", file.c_str());
        // A copy of exactly its size, so that a sanitizer sees the first byte that is read beyond.
        const luxel::Bytes bytes = luxel::read_file(file);
        LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    }
    std::printf("%zu files\n", files.size());
    return files.empty() ? 1 : 0;
}
