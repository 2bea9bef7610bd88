#include "baker/output/unlit_page.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "baker/core/parallel.h"
#include "baker/output/dilate.h"
#include "baker/output/lightmap_encode.h"
#include "baker/output/viewer_profile.h"
#include "baker/patches/see_through_texels.h"

namespace luxel {
namespace {

constexpr std::size_t grain = 1024;  ///< texels of one task

/// Mean alpha of what lies in a texel, by area.
float cover_of(const Scene& scene, const Atlas& atlas, const PageTexels& page, const Texel& texel) {
    double cover = 0, area = 0;
    for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
        const Fragment& fragment = page.fragments[f];
        const bool is_opaque = scene.material_of(fragment.triangle).alpha_mode == AlphaMode::opaque;
        cover += static_cast<double>(fragment.area_m2) * (is_opaque ? 1.0 : static_cast<double>(fragment_passage(scene, atlas, fragment).mean.coverage));
        area += static_cast<double>(fragment.area_m2);
    }
    return static_cast<float>(cover / area);
}

bool has_alpha(const Scene& scene, const PageTexels& page) {
    return std::any_of(page.fragments.begin(), page.fragments.end(), [&](const Fragment& fragment) {
        return scene.material_of(fragment.triangle).alpha_mode != AlphaMode::opaque;
    });
}

/// Floats >= 0 are ordered as their bits are: the upper 16 are sign, exponent and 7 bits of mantissa.
constexpr unsigned dropped_bits = 16;
std::size_t bin_of(float value) { return std::bit_cast<std::uint32_t>(std::max(value, 0.0f)) >> dropped_bits; }
double upper_end(std::size_t bin) {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bin + 1) << dropped_bits));
}

}  // namespace

UnlitPage unlit_page(const Scene& scene, const Atlas& atlas, const PageTexels& texels, std::span<const Rgb> irradiance) {
    const std::uint32_t size = atlas.page_size;
    const std::size_t square = std::size_t{size} * size;
    if (irradiance.size() != square)
        throw Error(ErrorCode::internal, "unlit page", "expected " + std::to_string(square) + " texels, found " + std::to_string(irradiance.size()));
    UnlitPage page{std::vector<Rgb>(square, Rgb(0, 0, 0)), {}, std::vector<std::uint8_t>(square, texel_empty)};
    const bool with_cover = has_alpha(scene, texels);
    std::vector<Rgb> cover(with_cover ? square : 0, Rgb(0, 0, 0));
    parallel_for(texels.texels.size(), grain, [&](std::size_t k) {
        const Texel& texel = texels.texels[k];
        const std::size_t at = std::size_t{texel.y} * size + texel.x;
        page.nits[at] = (texel.reflectance * irradiance[at] + texel.emission) * static_cast<float>(inverse_pi);
        if (with_cover) cover[at] = Rgb(cover_of(scene, atlas, texels, texel));
        page.mask[at] = texel_covered;
    });
    std::vector<std::uint8_t> mask = page.mask;
    const std::uint32_t steps = std::max(1u, atlas.padding);
    dilate(page.nits, page.mask, size, size, steps);
    if (!with_cover) return page;
    dilate(cover, mask, size, size, steps);
    page.cover.resize(square);
    std::transform(cover.begin(), cover.end(), page.cover.begin(), [](const Rgb& value) { return value.x; });
    return page;
}

BrightnessCount::BrightnessCount() : bins_(std::size_t{1} << (32 - dropped_bits), 0) {}

void BrightnessCount::add(const UnlitPage& page) {
    for (std::size_t at = 0; at < page.nits.size(); ++at)
        if (page.mask[at] == texel_covered)
            for (int c = 0; c < 3; ++c) ++bins_[bin_of(page.nits[at][c])];
}

double BrightnessCount::value_of_share(double share) const {
    const auto all = std::accumulate(bins_.begin(), bins_.end(), std::uint64_t{0});
    std::uint64_t below = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        below += bins_[bin];
        // The first bin is darkness: of a scene of which most is black, the rest decides.
        if (bin > 0 && bins_[bin] > 0 && static_cast<double>(below) >= share * static_cast<double>(all)) return upper_end(bin);
    }
    return 1;
}

double BrightnessCount::share_above(double value) const {
    const auto all = std::accumulate(bins_.begin(), bins_.end(), std::uint64_t{0});
    const auto first = bins_.begin() + static_cast<std::ptrdiff_t>(bin_of(static_cast<float>(value)));
    return all ? static_cast<double>(std::accumulate(first, bins_.end(), std::uint64_t{0})) / static_cast<double>(all) : 0;
}

Bytes unlit_png(const UnlitPage& page, std::uint32_t size, double exposure, const std::string& software) {
    std::vector<Rgb> shares(page.nits.size());
    parallel_for(shares.size(), grain, [&](std::size_t at) {
        for (int c = 0; c < 3; ++c)
            shares[at][c] = static_cast<float>(std::min(1.0, static_cast<double>(page.nits[at][c]) * exposure));
    });
    const EncodedPage encoded = encode_shares(shares, page.mask, LightmapEncoding::srgb8, size);
    ImageMetadata metadata{"luminance", "nit", "srgb8", 1 / exposure, software, {}};
    if (page.cover.empty()) return encode_png(size, size, encoded.rgb, metadata);
    std::vector<std::uint8_t> rgba(page.nits.size() * 4);
    parallel_for(page.nits.size(), grain, [&](std::size_t at) {
        for (std::size_t c = 0; c < 3; ++c) rgba[4 * at + c] = encoded.rgb[3 * at + c];
        rgba[4 * at + 3] = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(page.cover[at], 0.0f, 1.0f)));
    });
    return encode_png_rgba(size, size, rgba, metadata);
}

}  // namespace luxel
