#include "formats/image/hdr_file.h"

#include <algorithm>

namespace luxel {
namespace {

constexpr std::uint32_t least_run_width = 8, most_run_width = 0x7fff;  ///< of rows that may be in runs
constexpr std::size_t most_run = 127, most_plain = 128;                ///< bytes behind one length
constexpr std::size_t least_run = 4;  ///< shorter ones cost as much as plain bytes, and a length more around them

void append(Bytes& out, const std::string& text) { out.insert(out.end(), text.begin(), text.end()); }

/// How many bytes from `at` on are the same, as far as one run goes.
std::size_t run_length(std::span<const std::uint8_t> bytes, std::size_t at) {
    const std::size_t end = std::min(bytes.size(), at + most_run);
    std::size_t next = at + 1;
    while (next < end && bytes[next] == bytes[at]) ++next;
    return next - at;
}

void append_runs(Bytes& out, std::span<const std::uint8_t> bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t run = run_length(bytes, at);
        if (run >= least_run) {
            out.push_back(static_cast<std::uint8_t>(128 + run));
            out.push_back(bytes[at]);
            at += run;
            continue;
        }
        std::size_t end = at + run;
        while (end < bytes.size() && end - at < most_plain && run_length(bytes, end) < least_run) ++end;
        out.push_back(static_cast<std::uint8_t>(end - at));
        out.insert(out.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(end));
        at = end;
    }
}

}  // namespace

Bytes write_hdr(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgbe,
                const std::vector<std::pair<std::string, std::string>>& texts) {
    Bytes out;
    append(out, "#?RADIANCE\n");
    for (const auto& [name, text] : texts) {
        std::string line = "# " + name + "=" + text;
        std::ranges::replace_if(line, [](char c) { return c == '\n' || c == '\r'; }, ' ');
        append(out, line + "\n");
    }
    append(out, "FORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n");
    if (width < least_run_width || width > most_run_width) {
        out.insert(out.end(), rgbe.begin(), rgbe.end());
        return out;
    }
    std::vector<std::uint8_t> channel(width);
    for (std::uint32_t y = 0; y < height; ++y) {
        const auto row = rgbe.subspan(std::size_t{4} * width * y, std::size_t{4} * width);
        for (const std::uint32_t byte : {2u, 2u, width >> 8, width & 0xffu}) out.push_back(static_cast<std::uint8_t>(byte));
        for (std::size_t c = 0; c < 4; ++c) {
            for (std::size_t x = 0; x < width; ++x) channel[x] = row[4 * x + c];
            append_runs(out, channel);
        }
    }
    return out;
}

}  // namespace luxel
