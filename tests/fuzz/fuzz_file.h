/// What the fuzz targets of bake files share. Bytes of a fuzzer become the blocks of a file whose checksums are right,
/// so that it is what the file says that is tried, and not XXH3; block_file_fuzz tries the container itself.
///
/// Input: per block a header of two bytes, low byte first, then the block's bytes. Bits 0 to 13 are its size (what is
/// left, if that is less); bit 14: a byte with the block's tag follows the header, otherwise the tag is the block's
/// number; bit 15: the tag is that of the block before plus the byte that follows.
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/block_contents.h"

namespace luxel::fuzz {

/// A promise that a reader gives. What breaks it is a finding.
inline void require(bool holds) {
    if (!holds) std::abort();
}

/// Calls body(). True: it returned. False: it refused its input as a damaged store. Anything else is a finding.
template <class Body>
bool accepts(const Body& body) {
    try {
        body();
        return true;
    } catch (const Error& error) {
        require(error.code == ErrorCode::damaged_store && !error.where.empty());
        return false;
    }
}

/// A folder of this process in memory, where there is one: files are synced when they are published.
inline const std::filesystem::path& scratch_folder() {
    struct Folder {
        std::filesystem::path path;
        Folder() {
            const std::filesystem::path memory = "/dev/shm";
            path = (std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path()) /
                   ("luxel-fuzz-" + std::to_string(::getpid()));
            std::filesystem::create_directories(path);
        }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    };
    static const Folder folder;
    return folder.path;
}

constexpr Key key{0x1234, 0x5678};

inline test::BlockContents contents_from(ByteView input, FileKind kind, std::uint32_t version) {
    test::BlockContents contents{kind, version, key, {}};
    while (input.size() >= 2 && contents.parts.size() < 64) {
        const unsigned header = input[0] | unsigned{input[1]} << 8;
        input = input.subspan(2);
        std::uint64_t tag = contents.parts.size();
        if (header & 0xc000 && !input.empty()) {
            tag = input[0] + ((header & 0x8000) && !contents.parts.empty() ? contents.parts.back().tag : 0);
            input = input.subspan(1);
        }
        const std::size_t size = std::min<std::size_t>(header & 0x3fff, input.size());
        contents.parts.push_back({tag, Bytes(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(size))});
        input = input.subspan(size);
    }
    return contents;
}

/// The input that gives these contents: seeds are valid files. Blocks must be below 16 KiB.
inline Bytes input_for(const test::BlockContents& contents) {
    ByteWriter out;
    std::uint64_t before = 0;
    for (std::size_t k = 0; k < contents.parts.size(); ++k) {
        const auto& [tag, bytes] = contents.parts[k];
        const bool numbered = tag == k;
        out.put(static_cast<std::uint16_t>(bytes.size() | (numbered ? 0 : 0x8000)));
        if (!numbered) out.put(static_cast<std::uint8_t>(tag - before));
        out.put_array(std::span<const std::uint8_t>(bytes));
        before = tag;
    }
    return out.take();
}

/// The contents as a file under one name, whichever came before.
inline std::filesystem::path scratch_file(const test::BlockContents& contents) {
    const auto path = scratch_folder() / "file";
    test::write_contents(path, contents);
    return path;
}

}  // namespace luxel::fuzz
