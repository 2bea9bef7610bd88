#include "baker/output/seam_samples.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "baker/core/parallel.h"
#include "baker/trace/texel_joints.h"

namespace luxel {
namespace {

/// Points per texel of the denser side: along a line the filter is a parabola between texels.
constexpr float points_per_texel = 2;
/// Seams of less than this, in texels, do not matter to any pixel.
constexpr float shortest = 1e-4f;
/// How far inside its border the texel of a side is looked for, in texels: first a way that leaves no doubt which one
/// is meant, then, for surface narrower than that, hardly any.
constexpr std::array<float, 2> insets{0.25f, 1e-3f};

float length_in_texels(const Seam& seam) {
    return std::max((seam.a.to - seam.a.from).length(), (seam.b.to - seam.b.from).length());
}

std::uint32_t point_count(const Seam& seam) {
    const float length = length_in_texels(seam);
    return length < shortest ? 0u : static_cast<std::uint32_t>(std::ceil(points_per_texel * length));
}

/// A sample whose texels have no numbers yet.
struct RawSample {
    std::array<SeamTexel, 8> texels;
    std::array<float, 8> weights;
    float length;
};

struct Tally {
    std::vector<RawSample> samples;
    std::uint64_t blocked = 0, hidden = 0, crowded = 0;
};

class SeamSampler {
  public:
    SeamSampler(const Scene& scene, const Atlas& atlas, const TexelSet& texels, const Tracer& tracer)
        : atlas_(atlas), texels_(texels), probe_(scene, atlas, tracer) {}

    void sample(const Seam& seam, Tally& out) {
        const std::uint32_t count = point_count(seam);
        for (std::uint32_t k = 0; k < count; ++k) {
            const float t = (static_cast<float>(k) + 0.5f) / static_cast<float>(count);
            const Vec2f a = seam.a.from + (seam.a.to - seam.a.from) * t,
                        b = seam.b.from + (seam.b.to - seam.b.from) * t;
            RawSample sample{};
            sample.length = length_in_texels(seam) / static_cast<float>(count);
            if (!take(seam.a, a, sample, 0) || !take(seam.b, b, sample, 4)) {
                ++out.crowded;
                continue;
            }
            const std::uint32_t texel_a = texel_inside(seam.a, a), texel_b = texel_inside(seam.b, b);
            if (!sees(seam.a, texel_a) || !sees(seam.b, texel_b))
                ++out.hidden;
            else if (!is_free(seam, texel_a, texel_b))
                ++out.blocked;
            else
                out.samples.push_back(sample);
        }
    }

  private:
    [[nodiscard]] const Chart& chart(const SeamSide& side) const {
        return atlas_.charts[atlas_.triangle_chart[side.triangle]];
    }
    [[nodiscard]] const PageTexels& page(const SeamSide& side) const { return texels_.pages[chart(side).page]; }

    /// False if one of the texels belongs to another chart.
    bool take(const SeamSide& side, const Vec2f& at, RawSample& sample, std::size_t first) const {
        const BilinearTap tap = bilinear_tap(at, atlas_.page_size);
        const PageTexels& texels = page(side);
        for (std::size_t k = 0; k < 4; ++k) {
            const std::uint32_t texel = texels.find(tap.x[k], tap.y[k]);
            if (tap.weight[k] > 0 && texel != none &&
                texels.texels[texel].chart != atlas_.triangle_chart[side.triangle])
                return false;
            sample.texels[first + k] = {chart(side).page, static_cast<std::uint16_t>(tap.x[k]),
                                        static_cast<std::uint16_t>(tap.y[k])};
            sample.weights[first + k] = tap.weight[k];
        }
        return true;
    }

    /// The texel that the surface beside a point of the border lies in.
    [[nodiscard]] std::uint32_t texel_inside(const SeamSide& side, const Vec2f& at) const {
        const int corner = static_cast<int>(side.edge);
        const Vec2f p = atlas_.page_uv(side.triangle, corner), q = atlas_.page_uv(side.triangle, (corner + 1) % 3),
                    third = atlas_.page_uv(side.triangle, (corner + 2) % 3);
        Vec2f inwards(p.y - q.y, q.x - p.x);
        if (inwards.dot(third - p) < 0) inwards = -inwards;
        const float length = inwards.length();
        for (const float inset : insets) {
            const Vec2f place = length > 0 ? at + inwards * (inset / length) : at;
            if (!(place.x >= 0 && place.y >= 0)) continue;
            const std::uint32_t texel =
                page(side).find(static_cast<std::uint32_t>(place.x), static_cast<std::uint32_t>(place.y),
                                atlas_.triangle_chart[side.triangle]);
            if (texel != none) return texel;
        }
        return none;
    }

    [[nodiscard]] bool sees(const SeamSide& side, std::uint32_t texel) const {
        return texel != none && page(side).can_send(page(side).texels[texel]);
    }

    /// Points follow each other: most ask for the same pair of texels again.
    bool is_free(const Seam& seam, std::uint32_t texel_a, std::uint32_t texel_b) {
        const std::array<std::uint32_t, 4> pair{chart(seam.a).page, texel_a, chart(seam.b).page, texel_b};
        if (pair != last_pair_) {
            last_pair_ = pair;
            last_is_free_ = probe_.joined(probe_.post(page(seam.a), page(seam.a).texels[texel_a]),
                                          probe_.post(page(seam.b), page(seam.b).texels[texel_b]));
        }
        return last_is_free_;
    }

    const Atlas& atlas_;
    const TexelSet& texels_;
    const JointProbe probe_;
    std::array<std::uint32_t, 4> last_pair_{none, none, none, none};
    bool last_is_free_ = false;
};

std::vector<SeamTexel> distinct_texels(const std::vector<Tally>& parts) {
    std::vector<SeamTexel> texels;
    for (const Tally& part : parts)
        for (const RawSample& sample : part.samples)
            for (std::size_t k = 0; k < 8; ++k)
                if (sample.weights[k] > 0) texels.push_back(sample.texels[k]);
    std::sort(texels.begin(), texels.end());
    texels.erase(std::unique(texels.begin(), texels.end()), texels.end());
    texels.shrink_to_fit();
    return texels;
}

SeamTap numbered(const std::vector<SeamTexel>& texels, const RawSample& raw, std::size_t first) {
    SeamTap tap;
    std::uint32_t any = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        tap.weight[k] = raw.weights[first + k];
        if (!(tap.weight[k] > 0)) continue;
        const auto at = std::lower_bound(texels.begin(), texels.end(), raw.texels[first + k]);
        any = tap.texel[k] = static_cast<std::uint32_t>(at - texels.begin());
    }
    // What has no weight still names a texel that is there.
    for (std::size_t k = 0; k < 4; ++k)
        if (!(tap.weight[k] > 0)) tap.texel[k] = any;
    return tap;
}

}  // namespace

BilinearTap bilinear_tap(const Vec2f& at, std::uint32_t page_size) {
    BilinearTap tap;
    const auto last = static_cast<std::int64_t>(page_size) - 1;
    const float u = at.x - 0.5f, v = at.y - 0.5f;
    const float left = std::floor(u), top = std::floor(v);
    for (std::size_t k = 0; k < 4; ++k) {
        const bool right = k & 1, down = k & 2;
        tap.x[k] =
            static_cast<std::uint32_t>(std::clamp(static_cast<std::int64_t>(left) + right, std::int64_t{0}, last));
        tap.y[k] = static_cast<std::uint32_t>(std::clamp(static_cast<std::int64_t>(top) + down, std::int64_t{0}, last));
        tap.weight[k] = (right ? u - left : 1 - (u - left)) * (down ? v - top : 1 - (v - top));
    }
    return tap;
}

std::uint64_t seam_point_count(std::span<const Seam> seams) {
    std::uint64_t points = 0;
    for (const Seam& seam : seams) points += point_count(seam);
    return points;
}

SeamSamples sample_seams(const Scene& scene, const Atlas& atlas, const TexelSet& texels, const Tracer& tracer,
                         std::span<const Seam> seams) {
    constexpr std::size_t range_seams = 512;
    std::vector<Tally> parts((seams.size() + range_seams - 1) / range_seams);
    parallel_ranges(seams.size(), range_seams, [&](std::size_t range, std::size_t begin, std::size_t end) {
        SeamSampler sampler(scene, atlas, texels, tracer);
        for (std::size_t s = begin; s < end; ++s) sampler.sample(seams[s], parts[range]);
    });
    SeamSamples all;
    all.texels = distinct_texels(parts);
    std::size_t count = 0;
    for (const Tally& part : parts) count += part.samples.size();
    all.samples.reserve(count);
    for (Tally& part : parts) {
        for (const RawSample& raw : part.samples)
            all.samples.push_back({numbered(all.texels, raw, 0), numbered(all.texels, raw, 4), raw.length});
        all.blocked += part.blocked;
        all.hidden += part.hidden;
        all.crowded += part.crowded;
        std::vector<RawSample>().swap(part.samples);
    }
    return all;
}

}  // namespace luxel
