/// The inside of block files, to be changed and closed again with right checksums: what a reader must refuse by what it
/// says.
#pragma once
#include <functional>
#include <vector>

#include "formats/base/block_file.h"

namespace luxel::test {

/// Everything that a block file holds, decoded.
struct BlockContents {
    struct Part {
        std::uint64_t tag = 0;
        Bytes bytes;
    };
    FileKind kind = FileKind::atlas;
    std::uint32_t version = 0;
    Key key;
    std::vector<Part> parts;
};

inline BlockContents contents_of(const std::filesystem::path& path) {
    const BlockFileIdentity identity = identify_block_file(path);
    BlockContents contents{identity.kind, identity.version, identity.key, {}};
    const BlockFileReader file(path, identity.kind, identity.version);
    for (std::size_t k = 0; k < file.blocks().size(); ++k)
        contents.parts.push_back({file.blocks()[k].tag, file.read(k)});
    return contents;
}

/// Blocks are stored as they are, so that a small change stays one.
inline void write_contents(const std::filesystem::path& path, const BlockContents& contents) {
    BlockFileWriter file(path, contents.kind, contents.version, contents.key);
    for (const BlockContents::Part& part : contents.parts) file.append(part.tag, part.bytes, 0);
    file.publish();
}

/// Replaces the file by one with other contents.
inline void rewrite(const std::filesystem::path& path, const std::function<void(BlockContents&)>& change) {
    BlockContents contents = contents_of(path);
    change(contents);
    write_contents(path, contents);
}

/// Number `at` of a block that is a column of T.
template <Scalar T>
T element(const BlockContents::Part& part, std::size_t at) {
    T value;
    std::memcpy(&value, part.bytes.data() + at * sizeof(T), sizeof(T));
    return value;
}

template <Scalar T>
void set_element(BlockContents::Part& part, std::size_t at, T value) {
    std::memcpy(part.bytes.data() + at * sizeof(T), &value, sizeof(T));
}

/// Makes every checksum of the bytes of a block file right, as far as its fields say where they are (block_file.md).
inline void reseal(Bytes& file) {
    constexpr std::size_t header = 48, footer = 40, entry = 40, trailer = 16;
    if (file.size() < header + footer) return;
    const auto get = [&](std::size_t at) {
        std::uint64_t value;
        std::memcpy(&value, file.data() + at, 8);
        return value;
    };
    const auto put = [&](std::size_t at, std::uint64_t value) { std::memcpy(file.data() + at, &value, 8); };
    const auto part = [&](std::size_t at, std::size_t size) { return ByteView(file).subspan(at, size); };
    put(40, hash64(part(0, 40)));
    const std::size_t end = file.size() - footer;
    const std::uint64_t index = get(end);
    if (index >= header && index <= end) {
        for (std::size_t at = index; at + entry <= end; at += entry) {
            const std::uint64_t tag = get(at), offset = get(at + 8), stored = get(at + 16), raw = get(at + 24),
                                codec = get(at + 32);
            if (offset < header || offset > index || stored > index - offset || index - offset - stored < trailer)
                continue;
            ByteWriter identity;
            identity.put(codec), identity.put(tag), identity.put(raw);
            put(offset + stored, codec);
            put(offset + stored + 8, hash64(part(offset, stored), hash64(identity.bytes())));
        }
        put(end + 16, hash64(part(index, end - index)));
    }
    put(end + 24, hash64(part(end, 24)));
}

}  // namespace luxel::test
