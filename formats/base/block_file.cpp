#include "formats/base/block_file.h"

#include <algorithm>

#include "formats/base/compress.h"

namespace luxel {
namespace {

// Layout constants; block_file.md explains each field.
constexpr std::uint64_t header_magic = 0x314b4c424c55580aULL;  // "\nXULBLK1" read as little-endian
constexpr std::uint64_t footer_magic = 0x0a444e454c55584bULL;
constexpr std::uint32_t container_version = 1;
constexpr std::uint64_t header_bytes = 48, trailer_bytes = 16, entry_bytes = 40, footer_bytes = 40;
constexpr std::uint64_t raw_limit = std::uint64_t{1} << 36;

[[noreturn]] void damaged(const std::string& where, const std::string& what) {
    throw Error(ErrorCode::damaged_store, where, what, "remove the file and run the same command again");
}

/// Ties a block's checksum to its codec, tag and decoded size, so that none of them can be altered alone.
std::uint64_t block_checksum(ByteView stored, const BlockEntry& entry) {
    ByteWriter identity;
    identity.put(static_cast<std::uint64_t>(entry.codec));
    identity.put(entry.tag);
    identity.put(entry.raw_bytes);
    return hash64(stored, hash64(identity.bytes()));
}

Bytes encode_header(FileKind kind, std::uint32_t version, const Key& key) {
    ByteWriter out;
    out.put(header_magic);
    out.put(container_version);
    out.put(static_cast<std::uint32_t>(kind));
    out.put(version);
    out.put(std::uint32_t{0});
    out.put(key.low);
    out.put(key.high);
    out.put(hash64(out.bytes()));
    return out.take();
}

struct Header {
    std::uint32_t kind = 0, version = 0;
    Key key;
};

/// The header of a file of this container, whatever it holds.
Header read_header(const RandomFile& file, const std::string& where) {
    if (file.size() < header_bytes + footer_bytes)
        damaged(where, "file of " + std::to_string(file.size()) + " bytes is shorter than header and footer");
    Bytes header(header_bytes);
    file.read(0, header);
    ByteCursor in(header, where);
    if (in.get<std::uint64_t>("magic") != header_magic) damaged(where, "not a luxel block file (magic at byte 0)");
    const auto container = in.get<std::uint32_t>("container version");
    Header found;
    found.kind = in.get<std::uint32_t>("kind");
    found.version = in.get<std::uint32_t>("version");
    if (in.get<std::uint32_t>("reserved") != 0) damaged(where, "reserved field at byte 20 is not zero");
    found.key.low = in.get<std::uint64_t>("key");
    found.key.high = in.get<std::uint64_t>("key");
    if (in.get<std::uint64_t>("header checksum") != hash64(ByteView(header).first(header_bytes - 8)))
        damaged(where, "header checksum mismatch at byte 40");
    if (container != container_version)
        damaged(where, "container version " + std::to_string(container) + ", this program reads " +
                           std::to_string(container_version));
    return found;
}

}  // namespace

BlockFileWriter::BlockFileWriter(const std::filesystem::path& path, FileKind kind, std::uint32_t version,
                                 const Key& key)
    : file_(path) {
    file_.append(encode_header(kind, version, key));
}

BlockFileWriter::Packed BlockFileWriter::pack(ByteView raw, int level) {
    Packed block;
    block.raw_bytes = raw.size();
    if (level > 0) {
        block.stored = compress(raw, level);
        block.codec = Codec::zstd;
    }
    // Compression that saves less than an eighth is not worth its decoding time.
    if (level <= 0 || block.stored.size() > raw.size() - raw.size() / 8) {
        block.stored.assign(raw.begin(), raw.end());
        block.codec = Codec::raw;
    }
    return block;
}

Bytes BlockFileWriter::unpack(const Packed& block, const std::string& where) {
    return block.codec == Codec::raw ? block.stored : decompress(block.stored, block.raw_bytes, where);
}

void BlockFileWriter::append(std::uint64_t tag, ByteView raw, int level) { append_packed(tag, pack(raw, level)); }

void BlockFileWriter::append_packed(std::uint64_t tag, const Packed& block) {
    BlockEntry entry{tag, file_.size(), block.stored.size(), block.raw_bytes, block.codec};
    file_.append(block.stored);
    ByteWriter trailer;
    trailer.put(static_cast<std::uint64_t>(entry.codec));
    trailer.put(block_checksum(block.stored, entry));
    file_.append(trailer.bytes());
    entries_.push_back(entry);
}

void BlockFileWriter::append_index() {
    ByteWriter index;
    for (const BlockEntry& entry : entries_) {
        index.put(entry.tag);
        index.put(entry.offset);
        index.put(entry.stored_bytes);
        index.put(entry.raw_bytes);
        index.put(static_cast<std::uint64_t>(entry.codec));
    }
    ByteWriter footer;
    footer.put(file_.size());
    footer.put(static_cast<std::uint64_t>(entries_.size()));
    footer.put(hash64(index.bytes()));
    footer.put(hash64(footer.bytes()));
    footer.put(footer_magic);
    file_.append(index.bytes());
    file_.append(footer.bytes());
}

void BlockFileWriter::publish() {
    append_index();
    file_.publish();
}

void BlockFileWriter::publish(Publisher& publisher) {
    append_index();
    publisher.add(std::move(file_));
}

BlockFileIdentity identify_block_file(const std::filesystem::path& path) {
    const RandomFile file(path);
    const Header header = read_header(file, path.string());
    return {static_cast<FileKind>(header.kind), header.version, header.key};
}

BlockFileReader::BlockFileReader(const std::filesystem::path& path, FileKind kind, std::uint32_t version,
                                 const Key* expected_key)
    : file_(path) {
    const std::string where = name();
    const auto [found_kind, found_version, found_key] = read_header(file_, where);
    key_ = found_key;
    if (found_kind != static_cast<std::uint32_t>(kind))
        damaged(where, "file kind " + std::to_string(found_kind) + ", expected " +
                           std::to_string(static_cast<std::uint32_t>(kind)));
    if (found_version != version)
        damaged(where, "format version " + std::to_string(found_version) + ", this program reads " +
                           std::to_string(version));
    if (expected_key && key_ != *expected_key)
        damaged(where, "made from other inputs: key " + key_.text() + ", expected " + expected_key->text());

    Bytes footer(footer_bytes);
    file_.read(file_.size() - footer_bytes, footer);
    ByteCursor tail(footer, where);
    const auto index_offset = tail.get<std::uint64_t>("index offset");
    const auto count = tail.get<std::uint64_t>("block count");
    const auto index_checksum = tail.get<std::uint64_t>("index checksum");
    if (tail.get<std::uint64_t>("footer checksum") != hash64(ByteView(footer).first(24)) ||
        tail.get<std::uint64_t>("footer magic") != footer_magic)
        damaged(where, "footer is damaged: the file was cut or altered");
    const std::uint64_t index_end = file_.size() - footer_bytes;
    if (index_offset < header_bytes || index_offset > index_end || (index_end - index_offset) % entry_bytes != 0 ||
        (index_end - index_offset) / entry_bytes != count)
        damaged(where, "index of " + std::to_string(count) + " blocks does not fit the file");

    Bytes index(index_end - index_offset);
    file_.read(index_offset, index);
    if (hash64(index) != index_checksum) damaged(where, "index checksum mismatch at byte " + std::to_string(index_offset));
    ByteCursor table(index, where);
    entries_.reserve(count);
    std::uint64_t expected_offset = header_bytes;
    for (std::uint64_t i = 0; i < count; ++i) {
        BlockEntry entry;
        entry.tag = table.get<std::uint64_t>("tag");
        entry.offset = table.get<std::uint64_t>("offset");
        entry.stored_bytes = table.get<std::uint64_t>("stored bytes");
        entry.raw_bytes = table.get<std::uint64_t>("raw bytes");
        const auto codec = table.get<std::uint64_t>("codec");
        if (codec > 1) damaged(where, "block " + std::to_string(i) + ": unknown codec " + std::to_string(codec));
        entry.codec = static_cast<Codec>(codec);
        if (entry.offset != expected_offset || entry.stored_bytes > index_offset ||
            entry.offset + entry.stored_bytes + trailer_bytes > index_offset || entry.raw_bytes > raw_limit)
            damaged(where, "block " + std::to_string(i) + " lies outside the file");
        expected_offset = entry.offset + entry.stored_bytes + trailer_bytes;
        entries_.push_back(entry);
    }
    if (expected_offset != index_offset) damaged(where, "bytes between the last block and the index");
}

Bytes BlockFileReader::read(std::size_t index) const {
    const BlockEntry& entry = entries_.at(index);
    Bytes stored(entry.stored_bytes + trailer_bytes);
    file_.read(entry.offset, stored);
    const std::string where = name() + ": block " + std::to_string(index) + " at byte " + std::to_string(entry.offset);
    ByteCursor trailer(ByteView(stored).subspan(entry.stored_bytes), where);
    const auto codec = trailer.get<std::uint64_t>("codec");
    const auto checksum = trailer.get<std::uint64_t>("checksum");
    stored.resize(entry.stored_bytes);
    if (codec != static_cast<std::uint64_t>(entry.codec) || checksum != block_checksum(stored, entry))
        damaged(where, "checksum mismatch");
    if (entry.codec == Codec::zstd) return decompress(stored, entry.raw_bytes, where);
    if (stored.size() != entry.raw_bytes) damaged(where, "raw block of another size than its index entry");
    return stored;
}

void require_numbered_blocks(const BlockFileReader& file, std::size_t count) {
    const std::vector<BlockEntry>& blocks = file.blocks();
    if (blocks.size() != count)
        damaged(file.name(), std::to_string(blocks.size()) + " blocks, expected " + std::to_string(count));
    for (std::size_t k = 0; k < count; ++k)
        if (blocks[k].tag != k)
            damaged(file.name(), "block " + std::to_string(k) + " has the tag " + std::to_string(blocks[k].tag));
}

std::string read_name(const BlockFileReader& file, std::size_t index) {
    const Bytes name = file.read(index);
    const auto printable = [](std::uint8_t c) { return c >= 32 && c <= 126; };
    if (name.size() > 64 || !std::all_of(name.begin(), name.end(), printable))
        damaged(file.name(), "the name in block " + std::to_string(index) + " is not up to 64 printable characters");
    return {name.begin(), name.end()};
}

bool block_file_is_whole(const std::filesystem::path& path, FileKind kind, std::uint32_t version, const Key& key) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return false;
    try {
        BlockFileReader(path, kind, version, &key);
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace luxel
