/// The container of every file in a bake folder: a header, checksummed blocks, an index, a footer (block_file.md).
/// A file is either whole or absent: it is published by rename, and a reader refuses anything that does not add up.
#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "formats/base/bytes.h"
#include "formats/base/file.h"
#include "formats/base/hash.h"
#include "formats/base/publisher.h"

namespace luxel {

/// What a file holds. Stored: never renumber.
enum class FileKind : std::uint32_t {
    atlas = 1,      ///< unwrap result
    evidence = 2,   ///< formfactors/evidence_file
    strip = 3,      ///< formfactors/strip_file
    closure = 4,    ///< one mu per patch
    solution = 5,   ///< radiosity per patch
    lightmap = 6,   ///< float texels of one page
    sides = 7,      ///< which backs are open
    lamps = 8,      ///< direct light of lamps per patch
    plan = 9,       ///< levels of rays of one round
    accuracy = 10,  ///< standard error per patch
    patches = 11,   ///< bake/patches_file
    directory = 12, ///< bake/directory_file
    checkpoint = 13, ///< a solve that has not ended
    sky_view = 14   ///< bake/sky_view_file
};

/// Stored with each block: never renumber.
enum class Codec : std::uint32_t { raw = 0, zstd = 1 };

struct BlockEntry {
    std::uint64_t tag = 0;           ///< meaning belongs to the kind; need not be unique
    std::uint64_t offset = 0;        ///< of the stored bytes in the file
    std::uint64_t stored_bytes = 0;  ///< in the file, without the 16-byte trailer
    std::uint64_t raw_bytes = 0;     ///< after decoding
    Codec codec = Codec::raw;
};

class BlockFileWriter {
  public:
    /// `version` is the kind's own; `key` names the inputs (zero if none).
    BlockFileWriter(const std::filesystem::path& path, FileKind kind, std::uint32_t version, const Key& key);
    /// Compresses (level 0: stores raw) and appends.
    void append(std::uint64_t tag, ByteView raw, int level = 3);
    /// A block as it would be stored, prepared on any thread; appended in the order that append_packed is called.
    struct Packed {
        Bytes stored;
        std::uint64_t raw_bytes = 0;
        Codec codec = Codec::raw;
    };
    static Packed pack(ByteView raw, int level);
    /// The bytes that pack() was given. Throws Error{damaged_store} naming `where`.
    static Bytes unpack(const Packed& block, const std::string& where);
    void append_packed(std::uint64_t tag, const Packed& block);
    [[nodiscard]] std::size_t block_count() const { return entries_.size(); }
    /// Writes index and footer; the file appears under its name. Nothing may be appended afterwards.
    void publish();
    /// The same by the publisher, which knows when it is done.
    void publish(Publisher& publisher);
    /// Bytes of the file, complete after publish().
    [[nodiscard]] std::uint64_t file_bytes() const { return file_.size(); }

  private:
    void append_index();
    PublishedFile file_;
    std::vector<BlockEntry> entries_;
};

/// What a file says of itself: enough to open it. Throws Error{damaged_store}: missing, not a block file, damaged header.
struct BlockFileIdentity {
    FileKind kind = FileKind::atlas;
    std::uint32_t version = 0;
    Key key;
};
BlockFileIdentity identify_block_file(const std::filesystem::path& path);

/// Threads: read() is const and reentrant.
class BlockFileReader {
  public:
    /// Throws Error{damaged_store}: missing, other kind, newer version, damaged header, index or footer,
    /// or a key other than `expected_key` (if given).
    BlockFileReader(const std::filesystem::path& path, FileKind kind, std::uint32_t version,
                    const Key* expected_key = nullptr);
    [[nodiscard]] const std::vector<BlockEntry>& blocks() const { return entries_; }
    [[nodiscard]] const Key& key() const { return key_; }
    [[nodiscard]] std::uint64_t file_bytes() const { return file_.size(); }
    [[nodiscard]] std::string name() const { return file_.path().string(); }
    /// Decoded bytes of block `index`; throws Error{damaged_store} with file, block and byte on any damage.
    [[nodiscard]] Bytes read(std::size_t index) const;

  private:
    RandomFile file_;
    Key key_;
    std::vector<BlockEntry> entries_;
};

/// Is a whole file of this kind, version and key there? Any damage counts as "no".
bool block_file_is_whole(const std::filesystem::path& path, FileKind kind, std::uint32_t version, const Key& key);

/// The kinds whose blocks are numbered: throws Error{damaged_store} unless there are `count` blocks with the tags 0, 1,
/// 2, ...
void require_numbered_blocks(const BlockFileReader& file, std::size_t count);

/// Block `index` as a name: up to 64 printable characters of ASCII. Throws Error{damaged_store}.
std::string read_name(const BlockFileReader& file, std::size_t index);

/// One array of scalars as one block (codec zstd, level 1).
template <Scalar T>
void append_column(BlockFileWriter& file, std::uint64_t tag, std::span<const T> values) {
    file.append(tag, {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()}, 1);
}

/// The array in block `index`; throws Error{damaged_store} unless its size is a whole number of elements.
template <Scalar T>
std::vector<T> read_column(const BlockFileReader& file, std::size_t index) {
    const Bytes bytes = file.read(index);
    if (bytes.size() % sizeof(T))
        throw Error(ErrorCode::damaged_store, file.name(),
                    "column " + std::to_string(index) + " has " + std::to_string(bytes.size()) +
                        " bytes, not a multiple of " + std::to_string(sizeof(T)),
                    "remove the file and run the same command again");
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

}  // namespace luxel
