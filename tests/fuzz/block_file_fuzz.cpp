/// Any bytes as a block file, with wrong or (first byte odd) right checksums: refused as a damaged store, or a file
/// that can be read to its end and that is, written again, the same.
#include <cstddef>
#include <fstream>

#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    if (size == 0) return 0;
    Bytes bytes(data + 1, data + size);
    if (data[0] & 1) test::reseal(bytes);
    const auto path = fuzz::scratch_folder() / "file";
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    test::BlockContents contents;
    if (!fuzz::accepts([&] { contents = test::contents_of(path); })) return 0;
    test::write_contents(path, contents);
    const test::BlockContents again = test::contents_of(path);
    fuzz::require(again.kind == contents.kind && again.version == contents.version && again.key == contents.key);
    fuzz::require(again.parts.size() == contents.parts.size());
    for (std::size_t k = 0; k < again.parts.size(); ++k)
        fuzz::require(again.parts[k].tag == contents.parts[k].tag && again.parts[k].bytes == contents.parts[k].bytes);
    return 0;
}
