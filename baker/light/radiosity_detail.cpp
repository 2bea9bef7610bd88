#include "baker/light/radiosity_detail.h"

#include <algorithm>

namespace luxel {
namespace {

constexpr std::uint32_t neutral = 512;
constexpr double root_of_two = 1.0054299011128028;  // 2^(1/128)

}  // namespace

const std::array<float, 1024>& RadiosityDetail::factors() {
    // Products only: a power function differs between machines.
    static const std::array<float, 1024> table = [] {
        std::array<float, 1024> made{};
        double up = 1, down = 1;
        made[neutral] = 1;
        for (std::uint32_t step = 1; step < neutral; ++step) {
            up *= root_of_two, down /= root_of_two;
            made[neutral + step] = static_cast<float>(up);
            made[neutral - step] = static_cast<float>(down);
        }
        made[0] = 0;
        return made;
    }();
    return table;
}

std::uint32_t RadiosityDetail::code(double factor) {
    const auto& table = factors();
    const auto value = static_cast<float>(factor);
    if (!(value > table[1] / 2)) return 0;
    const auto above = std::lower_bound(table.begin() + 1, table.end() - 1, value);
    const auto below = above == table.begin() + 1 ? above : above - 1;
    return static_cast<std::uint32_t>((value - *below < *above - value ? below : above) - table.begin());
}

void RadiosityDetail::add_page(const TexelSet& texels, const PatchSet& patches, std::uint32_t page,
                               std::span<const Rgb> irradiance) {
    if (pages_.empty()) pages_.resize(texels.pages.size()), sums_.resize(reflected_.size());
    std::vector<std::uint32_t>& codes = pages_[page];
    codes.assign(std::size_t{texels.page_size} * texels.page_size, neutral | neutral << 10 | neutral << 20);
    const std::vector<Texel>& content = texels.pages[page].texels;
    const auto place = [&](const Texel& texel) { return std::size_t{texel.y} * texels.page_size + texel.x; };
    // What both sides of a wall have on average is true on neither.
    const auto counts = [&](const Texel& texel) {
        return patches.page_patch[page][place(texel)] != no_patch && texel.visible_m2 > 0 && texel.own_side == all_visible;
    };
    // Radiosity that the texels of a patch would have, so that only what differs between them is kept.
    std::vector<std::array<double, 4>> mean(reflected_.size());
    for (std::size_t k = 0; k < content.size(); ++k) {
        if (!counts(content[k])) continue;
        const PatchNumber patch = patches.page_patch[page][place(content[k])];
        const auto area = static_cast<double>(content[k].visible_m2);
        for (int c = 0; c < 3; ++c)
            mean[patch][static_cast<std::size_t>(c)] += area * static_cast<double>(content[k].reflectance[c] * irradiance[k][c]);
        mean[patch][3] += area;
    }
    if (mean_ == PatchMean::texels)
        for (std::size_t p = 0; p < mean.size(); ++p)
            if (mean[p][3] > 0)
                for (std::size_t c = 0; c < 3; ++c) reflected_[p][static_cast<int>(c)] = static_cast<float>(mean[p][c] / mean[p][3]);
    for (std::size_t k = 0; k < content.size(); ++k) {
        if (!counts(content[k])) continue;
        const PatchNumber patch = patches.page_patch[page][place(content[k])];
        std::uint32_t packed = 0;
        for (int c = 0; c < 3; ++c) {
            const auto channel = static_cast<std::size_t>(c);
            const double whole = mean[patch][channel];
            const auto own = static_cast<double>(content[k].reflectance[c] * irradiance[k][c]);
            const std::uint32_t chosen = whole > 0 ? code(own * mean[patch][3] / whole) : neutral;
            packed |= chosen << (10 * c);
            sums_[patch][channel] += static_cast<double>(content[k].visible_m2) * static_cast<double>(factors()[chosen]);
        }
        sums_[patch][3] += static_cast<double>(content[k].visible_m2);
        codes[place(content[k])] = packed;
    }
}

void RadiosityDetail::finish() {
    for (std::size_t p = 0; p < sums_.size(); ++p)
        for (int c = 0; c < 3; ++c) {
            const double sum = sums_[p][static_cast<std::size_t>(c)];
            if (sum > 0) reflected_[p][c] = static_cast<float>(static_cast<double>(reflected_[p][c]) * sums_[p][3] / sum);
        }
    std::vector<std::array<double, 4>>().swap(sums_);
}

std::uint64_t RadiosityDetail::resident_bytes() const {
    std::uint64_t bytes = reflected_.size() * sizeof(Rgb);
    for (const auto& page : pages_) bytes += page.size() * sizeof(page[0]);
    return bytes;
}

}  // namespace luxel
