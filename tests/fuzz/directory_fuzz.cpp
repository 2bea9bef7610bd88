/// Any blocks as the directory of a matrix that is not kept: refused as a damaged store, or a directory that is, written
/// again, the same file.
#include <cstddef>

#include "formats/bake/directory_file.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    const test::BlockContents contents = fuzz::contents_from({data, size}, FileKind::directory, directory_version);
    const auto path = fuzz::scratch_file(contents);
    std::optional<StripDirectory> directory;
    if (!fuzz::accepts([&] { directory = load_directory(path, fuzz::key); })) return 0;
    save_directory(path, fuzz::key, *directory);
    const test::BlockContents written = test::contents_of(path);
    fuzz::require(written.parts.size() == contents.parts.size());
    for (std::size_t k = 0; k < written.parts.size(); ++k)
        fuzz::require(written.parts[k].bytes == contents.parts[k].bytes);
    return 0;
}
