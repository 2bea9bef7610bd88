#include "formats/image/exr_check.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "formats/image/codec.h"

namespace luxel {
namespace {

constexpr std::uint32_t deep_flag = 0x800, parts_flag = 0x1000;

/// Attributes of these types have one size. The library does not look at the size that the file states: it must be the true one, else
/// library and check would read on from different places.
// clang-format off
constexpr std::pair<std::string_view, std::int32_t> fixed_sizes[]{
    {"box2f", 16}, {"box2i", 16}, {"chromaticities", 32}, {"compression", 1}, {"deepImageState", 1}, {"double", 8}, {"envmap", 1},
    {"float", 4},  {"int", 4},    {"keycode", 28},        {"lineOrder", 1},   {"m33d", 72},          {"m33f", 36},  {"m44d", 128},
    {"m44f", 64},  {"rational", 8}, {"tiledesc", 9},      {"timecode", 8},    {"v2d", 16},           {"v2f", 8},    {"v2i", 8},
    {"v3d", 24},   {"v3f", 12},   {"v3i", 12}};
// clang-format on

/// Rows of a chunk by number of the compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
constexpr std::int64_t chunk_rows[]{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

struct Attribute {
    std::string_view name, type;
    ByteView value;
};

/// What is looked at of one part.
struct Head {
    std::int64_t left = 0, top = 0, right = -1, bottom = -1;
    std::int64_t tile_width = 0, tile_height = 0;  ///< 0: no tiles
    std::int64_t stated_chunks = 0;
    std::size_t compression = 0;
    std::string_view kind;
};

class HeadReader {
  public:
    explicit HeadReader(ByteView bytes) : bytes_(bytes) {}

    [[nodiscard]] bool failed() const { return failed_; }
    static std::int32_t number(ByteView bytes, std::size_t at) {
        return static_cast<std::int32_t>(bytes[at] | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
                                         std::uint32_t{bytes[at + 3]} << 24);
    }
    ByteView take(std::int64_t count) {
        if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size() - at_) {
            failed_ = true;
            return {};
        }
        at_ += static_cast<std::size_t>(count);
        return bytes_.subspan(at_ - static_cast<std::size_t>(count), static_cast<std::size_t>(count));
    }
    /// Up to a zero byte, which is passed over.
    std::string_view text() {
        const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_), end = std::find(begin, bytes_.end(), 0);
        const ByteView found = take(end - begin);
        if (take(1).empty()) return {};
        return {reinterpret_cast<const char*>(found.data()), found.size()};
    }
    /// False: a zero byte instead of an attribute, or a failure.
    bool next(Attribute& attribute) {
        attribute.name = text();
        if (failed_ || attribute.name.empty()) return false;
        attribute.type = text();
        const ByteView size = take(4);
        if (failed_) return false;
        attribute.value = take(number(size, 0));
        for (const auto& [type, right] : fixed_sizes)
            if (attribute.type == type && attribute.value.size() != static_cast<std::size_t>(right)) failed_ = true;
        if (attribute.type == "chlist" && !is_channel_list(attribute.value)) failed_ = true;
        return !failed_;
    }

  private:
    /// Names with 16 bytes each, and a zero byte at the very end.
    static bool is_channel_list(ByteView list) {
        HeadReader reader(list);
        while (!reader.failed_ && !reader.text().empty()) reader.take(16);
        return !reader.failed_ && reader.at_ == list.size();
    }

    ByteView bytes_;
    std::size_t at_ = 0;
    bool failed_ = false;
};

void note(const Attribute& attribute, Head& head) {
    const auto number = [&](std::size_t at) { return std::int64_t{HeadReader::number(attribute.value, at)}; };
    const auto is = [&](std::string_view name, std::string_view type) { return attribute.name == name && attribute.type == type; };
    if (is("dataWindow", "box2i")) head.left = number(0), head.top = number(4), head.right = number(8), head.bottom = number(12);
    // Sides are unsigned; beyond 2^31 they become negative, which is refused too.
    if (is("tiles", "tiledesc")) head.tile_width = number(0), head.tile_height = number(4);
    if (is("compression", "compression")) head.compression = attribute.value[0];
    if (is("chunkCount", "int")) head.stated_chunks = number(0);
    if (is("type", "string")) head.kind = {reinterpret_cast<const char*>(attribute.value.data()), attribute.value.size()};
}

/// Adds the chunks of a part.
std::string part_trouble(const Head& head, const ImageLimits& limits, std::int64_t& chunks) {
    if (head.kind.starts_with("deep")) return "deep pictures are not supported";
    const std::int64_t width = head.right - head.left + 1, height = head.bottom - head.top + 1;
    if (std::string why = size_trouble(width, height, limits); !why.empty()) return why;
    if (head.compression >= std::size(chunk_rows)) return "its compression is not known";
    const bool has_tiles = head.tile_width != 0 || head.tile_height != 0;
    if (has_tiles && !size_trouble(head.tile_width, head.tile_height, limits).empty()) return "its tiles are too large";
    const std::int64_t rows = chunk_rows[head.compression], lines = (height + rows - 1) / rows;
    const std::int64_t tiles = !has_tiles ? 0 : ((width - 1) / head.tile_width + 1) * ((height - 1) / head.tile_height + 1);
    // A part says in more than one way whether it has tiles; whichever counts. Smaller levels of tiles at most treble the table.
    chunks += std::max({head.stated_chunks, tiles, has_tiles ? 0 : lines});
    return {};
}

}  // namespace

std::string exr_trouble(ByteView bytes, const ImageLimits& limits) {
    HeadReader reader(bytes);
    reader.take(4);  // magic
    const ByteView version = reader.take(4);
    if (reader.failed()) return "the file ends inside its head";
    const auto flags = static_cast<std::uint32_t>(HeadReader::number(version, 0));
    if (flags & deep_flag) return "deep pictures are not supported";
    std::int64_t chunks = 0;
    for (;;) {
        Head head;
        Attribute attribute;
        bool has_attributes = false;
        while (reader.next(attribute)) note(attribute, head), has_attributes = true;
        if (reader.failed()) return "its head is damaged, or cut short";
        if (!has_attributes) break;
        if (std::string why = part_trouble(head, limits, chunks); !why.empty()) return why;
        if (!(flags & parts_flag)) break;
    }
    constexpr std::int64_t bytes_per_offset = 8;
    if (chunks == 0) return "it has no pixels";
    if (chunks > static_cast<std::int64_t>(bytes.size()) / bytes_per_offset) return "the file ends inside its table of offsets";
    return {};
}

}  // namespace luxel
