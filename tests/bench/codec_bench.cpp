/// Ways to store the pairs of a strip, side by side: bytes per pair and speed of decoding, on the strips of a bake folder.
///
/// usage: codec_bench BAKE_FOLDER [REPEATS]
/// Every way holds the same blocks and is checked by decoding it again. Decoding ends in compressed rows of columns and counts on
/// one thread, "areas" in the form that solvers use, with exchange areas instead of counts; "memory" is the speed of copying rows of columns
/// and counts. Times are processor time.
#include <fmt/format.h>
#include <roaring/roaring.hh>
#include <time.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <functional>

#include "baker/formfactors/exchange_area.h"
#include "formats/bake/gap_symbols.h"
#include "formats/base/compress.h"

using namespace luxel;
namespace fs = std::filesystem;

namespace {

struct Way {
    std::string name;
    std::function<Bytes(const StripPairs&)> encode;
    std::function<void(ByteView, StripPairs&)> decode;  ///< rows, columns are set; fills the rest
};

using Words = std::vector<std::uint64_t>;

std::size_t row_words(const StripPairs& block) { return (block.columns + 63) / 64; }

Words bitmap(const StripPairs& block) {
    Words words(block.rows * row_words(block));
    for (std::uint32_t row = 0; row < block.rows; ++row)
        for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
            words[row * row_words(block) + block.column[k] / 64] |= std::uint64_t{1} << (block.column[k] % 64);
    return words;
}

void from_bitmap(const Words& words, StripPairs& block) {
    block.row_begin.assign(1, 0);
    block.column.clear();
    for (std::uint32_t row = 0; row < block.rows; ++row) {
        for (std::size_t w = 0; w < row_words(block); ++w)
            for (std::uint64_t word = words[row * row_words(block) + w]; word; word &= word - 1)
                block.column.push_back(static_cast<std::uint16_t>(w * 64 + static_cast<std::size_t>(std::countr_zero(word))));
        block.row_begin.push_back(static_cast<std::uint32_t>(block.column.size()));
    }
}

void put_frame(ByteWriter& out, ByteView raw, const Bytes& frame) {
    out.put_varint(raw.size());
    out.put_varint(frame.size());
    out.put_array(std::span<const std::uint8_t>(frame));
}

Bytes get_frame(ByteCursor& in) {
    const std::uint64_t raw = in.get_varint("raw"), size = in.get_varint("size");
    return decompress(in.get_view(size, "frame"), raw, "bench");
}

Bytes varints(std::span<const std::uint32_t> values) {
    ByteWriter out;
    for (const std::uint32_t value : values) out.put_varint(value);
    return out.take();
}

void from_varints(const Bytes& bytes, std::size_t count, std::vector<std::uint32_t>& values) {
    ByteCursor in(bytes, "bench");
    values.resize(count);
    for (std::uint32_t& value : values) value = static_cast<std::uint32_t>(in.get_varint("value"));
}

Bytes words_bytes(const Words& words) {
    ByteWriter out;
    out.put_array(std::span<const std::uint64_t>(words));
    return out.take();
}

/// Index as a plain bitmap (or each row exclusive-or the row above), counts as varints: one zstd frame each.
Way plain(const std::string& name, int level, bool difference, bool literals) {
    return {name,
            [=](const StripPairs& block) {
                Words words = bitmap(block);
                if (difference)
                    for (std::size_t k = words.size(); k-- > row_words(block);) words[k] ^= words[k - row_words(block)];
                ByteWriter out;
                const Bytes index = words_bytes(words), counts = varints(block.count);
                put_frame(out, index, compress(index, level));
                put_frame(out, counts, literals ? compress_literals(counts) : compress(counts, level));
                return out.take();
            },
            [=](ByteView bytes, StripPairs& block) {
                ByteCursor in(bytes, "bench");
                const Bytes index = get_frame(in);
                Words words(index.size() / 8);
                std::memcpy(words.data(), index.data(), index.size());
                if (difference)
                    for (std::size_t k = row_words(block); k < words.size(); ++k) words[k] ^= words[k - row_words(block)];
                from_bitmap(words, block);
                from_varints(get_frame(in), block.column.size(), block.count);
            }};
}

/// Today's file: hierarchical bitmap and varints in one frame.
Way hierarchical(int level) {
    return {fmt::format("three-level bitmap + varints, zstd {}", level),
            [=](const StripPairs& block) {
                ByteWriter out;
                const Bytes raw = encode_counts(block);
                put_frame(out, raw, compress(raw, level));
                return out.take();
            },
            [](ByteView bytes, StripPairs& block) {
                ByteCursor in(bytes, "bench");
                block = decode_counts(get_frame(in), false, "bench");
            }};
}

Way gaps() {
    return {"gaps as varints + varints, zstd 3",
            [](const StripPairs& block) {
                std::vector<std::uint32_t> gaps, sizes;
                for (std::uint32_t row = 0; row < block.rows; ++row) {
                    sizes.push_back(block.row_begin[row + 1] - block.row_begin[row]);
                    std::uint32_t next = 0;
                    for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
                        gaps.push_back(block.column[k] - next);
                        next = block.column[k] + 1u;
                    }
                }
                ByteWriter out;
                for (const auto& part : {varints(sizes), varints(gaps), varints(block.count)}) put_frame(out, part, compress(part, 3));
                return out.take();
            },
            [](ByteView bytes, StripPairs& block) {
                ByteCursor in(bytes, "bench");
                std::vector<std::uint32_t> sizes, gaps;
                from_varints(get_frame(in), block.rows, sizes);
                block.row_begin.assign(1, 0);
                for (const std::uint32_t size : sizes) block.row_begin.push_back(block.row_begin.back() + size);
                from_varints(get_frame(in), block.row_begin.back(), gaps);
                block.column.resize(gaps.size());
                for (std::uint32_t row = 0; row < block.rows; ++row) {
                    std::uint32_t next = 0;
                    for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
                        block.column[k] = static_cast<std::uint16_t>(next + gaps[k]);
                        next += gaps[k] + 1;
                    }
                }
                from_varints(get_frame(in), block.column.size(), block.count);
            }};
}

Way roaring_bits() {
    return {"Roaring + varints, zstd 3",
            [](const StripPairs& block) {
                std::vector<std::uint32_t> places;
                for (std::uint32_t row = 0; row < block.rows; ++row)
                    for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
                        places.push_back(row * block.columns + block.column[k]);
                Roaring set(places.size(), places.data());
                set.runOptimize();
                Bytes index(set.getSizeInBytes());
                set.write(reinterpret_cast<char*>(index.data()));
                const Bytes counts = varints(block.count);
                ByteWriter out;
                put_frame(out, index, compress(index, 3));
                put_frame(out, counts, compress(counts, 3));
                return out.take();
            },
            [](ByteView bytes, StripPairs& block) {
                ByteCursor in(bytes, "bench");
                const Bytes index = get_frame(in);
                const Roaring set = Roaring::readSafe(reinterpret_cast<const char*>(index.data()), index.size());
                std::vector<std::uint32_t> places(set.cardinality());
                set.toUint32Array(places.data());
                block.row_begin.assign(block.rows + 1, 0);
                block.column.resize(places.size());
                std::uint32_t row = 0, begin = 0;
                for (std::size_t k = 0; k < places.size(); ++k) {
                    while (places[k] - begin >= block.columns) begin += block.columns, block.row_begin[++row] = static_cast<std::uint32_t>(k);
                    block.column[k] = static_cast<std::uint16_t>(places[k] - begin);
                }
                while (row < block.rows) block.row_begin[++row] = static_cast<std::uint32_t>(places.size());
                from_varints(get_frame(in), block.column.size(), block.count);
            }};
}

Way symbols() {
    return {"gaps and counts as one symbol, by class",
            [](const StripPairs& block) { return encode_gaps(block); },
            [](ByteView bytes, StripPairs& block) { block = decode_gaps(bytes, false, "bench", std::move(block)); }};
}

double processor_seconds() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double seconds_of(const std::function<void()>& body) {
    const double begin = processor_seconds();
    body();
    return processor_seconds() - begin;
}

std::vector<StripPairs> blocks_of(const fs::path& folder, std::uint64_t& file_bytes) {
    std::vector<StripPairs> blocks;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".lxs") continue;
        const BlockFileReader file(entry.path(), FileKind::strip, strip_version);
        file_bytes += file.file_bytes();
        const auto directory = read_strip_directory(file);
        const std::string number = entry.path().stem().string().substr(std::string("strip-").size());
        for (std::size_t k = 0; k < directory.size(); ++k)
            blocks.push_back(unpack_pairs(file.read(first_pair_block + k), std::to_string(directory[k].b) == number, file.name()));
    }
    return blocks;
}

void measure(const Way& way, const std::vector<StripPairs>& blocks, double pairs, int repeats) {
    std::vector<Bytes> stored;
    std::uint64_t bytes = 0;
    const double encoding = seconds_of([&] {
        for (const StripPairs& block : blocks) stored.push_back(way.encode(block)), bytes += stored.back().size();
    });
    StripPairs found;
    const std::vector<double> mu(65536, 1.5);
    std::vector<float> areas;
    double least = 1e30, least_with_areas = 1e30;
    for (int r = 0; r < repeats; ++r) {
        const auto decode_all = [&](bool with_areas) {
            return seconds_of([&] {
                for (std::size_t k = 0; k < blocks.size(); ++k) {
                    found.rows = blocks[k].rows;
                    found.columns = blocks[k].columns;
                    way.decode(stored[k], found);
                    if (!with_areas) continue;
                    areas.resize(found.column.size());
                    exchange_areas(found.row_begin, found.column, found.count, mu.data(), mu.data(), areas);
                }
            });
        };
        least = std::min(least, decode_all(false));
        least_with_areas = std::min(least_with_areas, decode_all(true));
    }
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        found.rows = blocks[k].rows;
        found.columns = blocks[k].columns;
        way.decode(stored[k], found);
        if (found.column != blocks[k].column || found.count != blocks[k].count || found.row_begin != blocks[k].row_begin)
            fmt::print("{}: block {} DIFFERS\n", way.name, k);
    }
    fmt::print("{:<48} {:6.3f} bytes/pair  decode {:6.1f}  areas {:6.1f}  encode {:6.1f} M pairs/s\n", way.name,
               static_cast<double>(bytes) / pairs, pairs / least * 1e-6, pairs / least_with_areas * 1e-6, pairs / encoding * 1e-6);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 1;
    const int repeats = argc > 2 ? std::atoi(argv[2]) : 3;
    std::uint64_t file_bytes = 0;
    const std::vector<StripPairs> blocks = blocks_of(argv[1], file_bytes);
    double pairs = 0, cells = 0, ones = 0, rays = 0;
    for (const StripPairs& block : blocks) {
        pairs += static_cast<double>(block.column.size());
        cells += static_cast<double>(block.rows) * block.columns;
        for (const std::uint32_t count : block.count) rays += count, ones += count == 1 ? 1 : 0;
    }
    fmt::print("{} blocks, {:.1f} M pairs, density {:.1f} %, mean count {:.2f}, {:.0f} % of counts are 1, files {:.3f} bytes/pair\n", blocks.size(),
               pairs * 1e-6, 100 * pairs / cells, rays / pairs, 100 * ones / pairs, static_cast<double>(file_bytes) / pairs);
    double copying = 1e30;
    for (int r = 0; r < repeats; ++r)
        copying = std::min(copying, seconds_of([&] {
            StripPairs copy;
            for (const StripPairs& block : blocks) copy = block;
        }));
    fmt::print("{:<48} {:>18} copy   {:6.1f} M pairs/s\n", "memory", "", pairs / copying * 1e-6);
    for (const Way& way : {plain("plain bitmap + varints, zstd 3", 3, false, false), hierarchical(3), hierarchical(9), symbols(), gaps(), roaring_bits(),
                               plain("plain bitmap + varints as literals", 3, false, true),
                               plain("bitmap xor row above + literals", 3, true, true)})
        measure(way, blocks, pairs, repeats);
}
