/// Any blocks as a patches file: refused as a damaged store, or patches that are, written again, the same.
#include <cstddef>

#include "formats/bake/patches_file.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    const auto path = fuzz::scratch_file(fuzz::contents_from({data, size}, FileKind::patches, patches_version));
    PatchesFile patches;
    if (!fuzz::accepts([&] { patches = load_patches(path, fuzz::key); })) return 0;
    fuzz::require(patches.area_m2.size() == patches.ids.size() && patches.first_patch.back() == patches.ids.size());
    save_patches(path, fuzz::key, patches);
    fuzz::require(load_patches(path, fuzz::key) == patches);
    return 0;
}
