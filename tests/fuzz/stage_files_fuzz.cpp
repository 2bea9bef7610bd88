/// Any blocks as the result of a small stage; the first byte says which one, the second for how many patches or texels.
/// Refused as a damaged store, or a value that is, written again, the same file.
#include <cstddef>

#include "baker/bake/stage_files.h"
#include "tests/fuzz/fuzz_file.h"

namespace luxel {
namespace {

/// Loads and writes what was loaded.
void again(FileKind kind, const std::filesystem::path& path, std::size_t count) {
    if (kind == FileKind::closure) save_closure(path, fuzz::key, *load_closure(path, fuzz::key, count));
    if (kind == FileKind::solution) save_solution(path, fuzz::key, *load_solution(path, fuzz::key, count));
    if (kind == FileKind::plan) save_plan(path, fuzz::key, *load_plan(path, fuzz::key, count));
    if (kind == FileKind::accuracy) save_accuracy(path, fuzz::key, *load_accuracy(path, fuzz::key, count));
    if (kind == FileKind::checkpoint) save_checkpoint(path, fuzz::key, *load_checkpoint(path, fuzz::key));
    if (kind == FileKind::lightmap) save_page_light(path, fuzz::key, *load_page_light(path, fuzz::key, count));
}

}  // namespace
}  // namespace luxel

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    if (size < 2) return 0;
    constexpr FileKind kinds[]{FileKind::closure, FileKind::solution, FileKind::plan, FileKind::accuracy,
                               FileKind::lightmap, FileKind::checkpoint};
    const FileKind kind = kinds[data[0] % std::size(kinds)];
    const std::uint32_t version = kind == FileKind::checkpoint || kind == FileKind::lightmap ? 2 : 1;
    const test::BlockContents contents = fuzz::contents_from({data + 2, size - 2}, kind, version);
    const auto path = fuzz::scratch_file(contents);
    if (!fuzz::accepts([&] { again(kind, path, data[1]); })) return 0;
    const test::BlockContents written = test::contents_of(path);
    fuzz::require(written.parts.size() == contents.parts.size());
    for (std::size_t k = 0; k < written.parts.size(); ++k)
        fuzz::require(written.parts[k].bytes == contents.parts[k].bytes);
    return 0;
}
