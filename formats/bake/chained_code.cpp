#include "formats/bake/chained_code.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <vector>

namespace luxel {
namespace {

constexpr std::size_t symbol_count = 256;

using Lengths = std::array<std::uint8_t, symbol_count>;
using Codes = std::array<std::uint16_t, symbol_count>;

std::size_t class_count(const ClassAfter& class_after) {
    return 1 + std::size_t{*std::max_element(class_after.begin(), class_after.end())};
}

/// Where a lane begins.
std::size_t lane_begin(std::size_t count, std::size_t lane) {
    return count / lane_count * lane + std::min(lane, count % lane_count);
}

/// Lengths of the best complete code of at most longest_code bits. Package-merge: Larmore and Hirschberg, A fast
/// algorithm for optimal length-limited Huffman codes, J. ACM 37(3) 1990; a level of the lists is a bit of the codes.
Lengths code_lengths(std::array<std::uint32_t, symbol_count> weights) {
    // A complete code has two symbols at least.
    for (std::size_t s = 0;
         std::count(weights.begin(), weights.end(), 0u) > static_cast<std::ptrdiff_t>(symbol_count - 2); ++s)
        weights[s] = std::max(weights[s], 1u);
    struct Item {
        std::uint64_t weight;
        bool single;  ///< a symbol, not a package of two items of the level before
        bool operator<(const Item& o) const { return weight < o.weight; }
    };
    std::vector<std::uint8_t> symbols;
    for (std::size_t s = 0; s < symbol_count; ++s)
        if (weights[s]) symbols.push_back(static_cast<std::uint8_t>(s));
    std::stable_sort(symbols.begin(), symbols.end(),
                     [&](std::uint8_t a, std::uint8_t b) { return weights[a] < weights[b]; });
    std::vector<Item> singles;
    for (const std::uint8_t s : symbols) singles.push_back({weights[s], true});
    std::array<std::vector<Item>, longest_code> levels;
    levels[0] = singles;
    for (std::size_t level = 1; level < longest_code; ++level) {
        const std::vector<Item>& below = levels[level - 1];
        std::vector<Item> packages;
        for (std::size_t k = 0; k + 1 < below.size(); k += 2)
            packages.push_back({below[k].weight + below[k + 1].weight, false});
        std::merge(singles.begin(), singles.end(), packages.begin(), packages.end(), std::back_inserter(levels[level]));
    }
    Lengths lengths{};
    std::size_t taken = 2 * symbols.size() - 2;
    for (std::size_t level = longest_code; level-- > 0;) {
        const auto end = levels[level].begin() + static_cast<std::ptrdiff_t>(taken);
        const auto own = static_cast<std::size_t>(
            std::count_if(levels[level].begin(), end, [](const Item& item) { return item.single; }));
        for (std::size_t k = 0; k < own; ++k) ++lengths[symbols[k]];
        taken = 2 * (taken - own);
    }
    return lengths;
}

std::uint16_t reversed(std::uint32_t code, std::uint32_t length) {
    std::uint32_t result = 0;
    for (std::uint32_t bit = 0; bit < length; ++bit) result |= ((code >> bit) & 1) << (length - 1 - bit);
    return static_cast<std::uint16_t>(result);
}

/// Shorter codes first, equal lengths by symbol; the first bit of a code is its lowest.
Codes canonical_codes(const Lengths& lengths) {
    std::array<std::uint32_t, longest_code + 2> next{};
    for (const std::uint8_t length : lengths) ++next[length + std::size_t{1}];
    next[1] = 0;  // symbols without a code
    for (std::size_t length = 2; length < next.size(); ++length) next[length] = (next[length] + next[length - 1]) * 2;
    Codes codes{};
    for (std::size_t s = 0; s < symbol_count; ++s)
        if (lengths[s]) codes[s] = reversed(next[lengths[s]]++, lengths[s]);
    return codes;
}

constexpr std::uint32_t longest_run = 16;

/// Half bytes, the low one first: a length, or 0 and how many more symbols without a code follow.
void put_lengths(ByteWriter& out, const Lengths& lengths) {
    Bytes halves;
    for (std::size_t s = 0; s < symbol_count;) {
        halves.push_back(lengths[s]);
        if (lengths[s++]) continue;
        std::uint8_t more = 0;
        for (; s < symbol_count && !lengths[s] && more + 1u < longest_run; ++s) ++more;
        halves.push_back(more);
    }
    if (halves.size() % 2) halves.push_back(0);
    for (std::size_t k = 0; k < halves.size(); k += 2)
        out.put(static_cast<std::uint8_t>(halves[k] | halves[k + 1] << 4));
}

/// The inverse; lengths are at most longest_code, their code is complete.
Lengths get_lengths(ByteCursor& in) {
    Lengths lengths{};
    std::size_t filled = 0, s = 0;
    for (bool run = false; s < symbol_count || run;) {
        const auto byte = in.get<std::uint8_t>("codes");
        for (const std::uint8_t half : {static_cast<std::uint8_t>(byte & 15), static_cast<std::uint8_t>(byte >> 4)}) {
            if (run) {
                s += half, run = false;
            } else if (s < symbol_count) {
                if (half > longest_code) in.fail("codes", "a length above 10");
                run = half == 0;
                filled += half ? std::size_t{1} << (longest_code - half) : 0;
                lengths[s++] = half;
            } else if (half) {
                in.fail("codes", "more than symbols");
            }
        }
    }
    if (s > symbol_count) in.fail("codes", "more than symbols");
    if (filled != std::size_t{1} << longest_code) in.fail("codes", "a code is not complete");
    return lengths;
}

class BitWriter {
  public:
    void put(std::uint32_t bits, std::uint32_t count) {
        held_ |= std::uint64_t{bits} << held_bits_;
        for (held_bits_ += count; held_bits_ >= 8; held_bits_ -= 8, held_ >>= 8)
            bytes_.push_back(static_cast<std::uint8_t>(held_));
    }
    Bytes take() {
        if (held_bits_) bytes_.push_back(static_cast<std::uint8_t>(held_));
        return std::move(bytes_);
    }

  private:
    Bytes bytes_;
    std::uint64_t held_ = 0;
    std::uint32_t held_bits_ = 0;
};

/// For every class the entries of all next `bits` bits of a lane, classes `class_stride` entries apart. An entry says
/// of the code that the bits begin with: its length (low 8 bits), its symbol (8), and the first entry of the class
/// after it (16).
struct DecodeTable {
    std::uint32_t bits = 0;
    std::unique_ptr<std::uint32_t[]> entries;
};
constexpr std::size_t class_stride = std::size_t{1} << longest_code;

/// The entries of one class: its codes are complete.
void fill_class(const Lengths& lengths, const ClassAfter& class_after, std::size_t size, std::uint32_t* entries) {
    const Codes codes = canonical_codes(lengths);
    for (std::size_t s = 0; s < symbol_count; ++s) {
        if (!lengths[s]) continue;
        const auto entry = static_cast<std::uint32_t>(lengths[s] | s << 8 | class_after[s] * class_stride << 16);
        for (std::size_t at = codes[s]; at < size; at += std::size_t{1} << lengths[s]) entries[at] = entry;
    }
}

DecodeTable read_codes(ByteCursor& in, const ClassAfter& class_after) {
    std::vector<Lengths> lengths(class_count(class_after));
    DecodeTable table;
    for (Lengths& own : lengths) {
        own = get_lengths(in);
        table.bits = std::max<std::uint32_t>(table.bits, *std::max_element(own.begin(), own.end()));
    }
    table.entries = std::make_unique_for_overwrite<std::uint32_t[]>(lengths.size() * class_stride);
    for (std::size_t c = 0; c < lengths.size(); ++c)
        fill_class(lengths[c], class_after, std::size_t{1} << table.bits, table.entries.get() + c * class_stride);
    return table;
}

/// A lane while it is read: `at` and `end` count bits from the first byte of all lanes.
struct Lane {
    std::size_t at, end;
    std::uint32_t entry;  ///< of the last symbol: its class chooses the next code
    std::uint8_t* out;
};

/// 57 bits of a lane at least, never from beyond its end.
std::uint64_t next_bits(const std::uint8_t* bytes, Lane& lane) {
    lane.at = std::min(lane.at, lane.end);
    std::uint64_t bits;
    std::memcpy(&bits, bytes + lane.at / 8, sizeof bits);
    return bits >> (lane.at % 8);
}

/// Decodes `Symbols` symbols each of lanes [first, first + Lanes) in turn; their codes fit into 56 bits.
template <std::size_t Symbols, std::size_t Lanes>
inline void step(const DecodeTable& table, const std::uint8_t* bytes, Lane* lanes) {
    static_assert(Symbols * longest_code <= 56);
    const std::uint64_t mask = (std::uint64_t{1} << table.bits) - 1;
    const std::uint32_t* const entries = table.entries.get();
    std::uint64_t bits[Lanes];
    std::uint32_t entry[Lanes];
    std::uint8_t* out[Lanes];
    // What has been used is counted by a bit on top that moves down with the rest.
    for (std::size_t l = 0; l < Lanes; ++l)
        bits[l] = next_bits(bytes, lanes[l]) | std::uint64_t{1} << 63, entry[l] = lanes[l].entry, out[l] = lanes[l].out;
#pragma GCC unroll 5
    for (std::size_t k = 0; k < Symbols; ++k)
#pragma GCC unroll 4
        for (std::size_t l = 0; l < Lanes; ++l) {
            entry[l] = entries[(entry[l] >> 16) + (bits[l] & mask)];
            bits[l] >>= entry[l] & 63;
            out[l][k] = static_cast<std::uint8_t>(entry[l] >> 8);
        }
    for (std::size_t l = 0; l < Lanes; ++l) {
        lanes[l].at += static_cast<std::size_t>(std::countl_zero(bits[l]));
        lanes[l].entry = entry[l];
        lanes[l].out = out[l] + Symbols;
    }
}

/// A function of its own, so that nothing else takes its registers.
[[gnu::noinline]] void run(const DecodeTable& table, const std::uint8_t* bytes, std::size_t rounds, Lane* lanes) {
    constexpr std::size_t at_once = 56 / longest_code;
    for (std::size_t k = 0; k < rounds; ++k) step<at_once, lane_count>(table, bytes, lanes);
}

}  // namespace

void put_symbols(ByteWriter& out, ByteView symbols, const ClassAfter& class_after) {
    const std::size_t classes = class_count(class_after);
    std::vector<std::array<std::uint32_t, symbol_count>> weights(classes);
    for (std::size_t l = 0; l < lane_count; ++l) {
        std::size_t current = 0;
        for (std::size_t k = lane_begin(symbols.size(), l); k < lane_begin(symbols.size(), l + 1); ++k) {
            ++weights[current][symbols[k]];
            current = class_after[symbols[k]];
        }
    }
    std::vector<Codes> codes;
    std::vector<Lengths> code_length;
    for (const auto& weight : weights) {
        code_length.push_back(code_lengths(weight));
        codes.push_back(canonical_codes(code_length.back()));
        put_lengths(out, code_length.back());
    }
    std::array<Bytes, lane_count> lanes;
    for (std::size_t l = 0; l < lane_count; ++l) {
        BitWriter bits;
        std::size_t current = 0;
        for (std::size_t k = lane_begin(symbols.size(), l); k < lane_begin(symbols.size(), l + 1); ++k) {
            bits.put(codes[current][symbols[k]], code_length[current][symbols[k]]);
            current = class_after[symbols[k]];
        }
        lanes[l] = bits.take();
        out.put_varint(lanes[l].size());
    }
    for (const Bytes& lane : lanes) out.put_array(std::span<const std::uint8_t>(lane));
}

std::unique_ptr<std::uint8_t[]> get_symbols(ByteCursor& in, std::size_t count, std::size_t slack,
                                            const ClassAfter& class_after) {
    const DecodeTable table = read_codes(in, class_after);
    std::array<std::uint64_t, lane_count> sizes;
    std::uint64_t total = 0;
    for (std::uint64_t& size : sizes) {
        size = in.get_varint("lane bytes");
        if (size > in.remaining()) in.fail("lane bytes", "more than what is left");
        total += size;
    }
    const ByteView stored = in.get_view(total, "lanes");
    // A code has one bit at least: this bounds what is allocated by what is there.
    if (count > 8 * total) in.fail("lanes", "fewer bits than symbols");
    // next_bits() reads up to 8 bytes from any place, the end included.
    const auto bytes = std::make_unique_for_overwrite<std::uint8_t[]>(total + 8);
    std::memcpy(bytes.get(), stored.data(), total);
    std::memset(bytes.get() + total, 0, 8);
    auto symbols = std::make_unique_for_overwrite<std::uint8_t[]>(count + slack);
    std::memset(symbols.get() + count, 0, slack);

    std::array<Lane, lane_count> lanes;
    std::size_t first = 0;
    for (std::size_t l = 0; l < lane_count; ++l) {
        lanes[l] = {first * 8, (first + sizes[l]) * 8, 0, symbols.get() + lane_begin(count, l)};
        first += sizes[l];
    }
    constexpr std::size_t at_once = 56 / longest_code;
    run(table, bytes.get(), count / lane_count / at_once, lanes.data());
    for (std::size_t l = 0; l < lane_count; ++l) {
        std::array<Lane, 1> lane{lanes[l]};
        while (lane[0].out != symbols.get() + lane_begin(count, l + 1)) step<1, 1>(table, bytes.get(), lane.data());
        const std::size_t left = lane[0].end - std::min(lane[0].at, lane[0].end);
        if (lane[0].at > lane[0].end || left >= 8 || next_bits(bytes.get(), lane[0]) << (64 - 8) << (8 - left))
            in.fail("lanes", "a lane ends early or late");
    }
    return symbols;
}

}  // namespace luxel
