#include "baker/formfactors/hemicube_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/formfactors/hemicube_weights.h"
#include "baker/trace/surface_map.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"

namespace luxel {
namespace {

constexpr std::size_t batch = 64;

/// Weights per patch met. Pixels beside each other mostly see the same patch: runs are added up as they come, and the list of
/// runs is summed up whenever it has grown, so that memory follows the patches seen, not the pixels.
class SeenPatches {
  public:
    void add(PatchNumber patch, std::uint32_t weight) {
        if (!seen_.empty() && seen_.back().patch == patch) {
            seen_.back().weight += weight;
            return;
        }
        if (seen_.size() >= limit_) {
            sum_up();
            limit_ = std::max<std::size_t>(first_limit, 2 * seen_.size());
        }
        seen_.push_back({patch, weight});
    }
    void give(Landings& out) {
        sum_up();
        for (const Seen& seen : seen_) out.patches.push_back(seen.patch), out.weights.push_back(seen.weight);
    }

  private:
    struct Seen {
        PatchNumber patch;
        std::uint32_t weight;
    };
    void sum_up() {
        std::sort(seen_.begin(), seen_.end(), [](const Seen& a, const Seen& b) { return a.patch < b.patch; });
        std::size_t kept = 0;
        for (const Seen& seen : seen_)
            if (kept && seen_[kept - 1].patch == seen.patch)
                seen_[kept - 1].weight += seen.weight;
            else
                seen_[kept++] = seen;
        seen_.resize(kept);
    }
    static constexpr std::size_t first_limit = 1 << 14;
    std::size_t limit_ = first_limit;
    std::vector<Seen> seen_;
};

/// Is the point (barycentrics) inside the convex polygon, its border included?
bool inside(std::span<const Vec2f> corners, const Vec2f& at) {
    bool left = false, right = false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec2f& a = corners[k];
        const Vec2f& b = corners[k + 1 == corners.size() ? 0 : k + 1];
        const float side = (b - a).cross(at - a);
        // A centre on the line between two texels belongs to both: rounding must not put it outside of either.
        if (std::fabs(side) <= 1e-4f * (b - a).length() * ((b - a).length() + (at - a).length())) continue;
        (side > 0 ? left : right) = true;
    }
    return !(left && right);
}

/// Barycentrics of the foot of `point` on the triangle's plane.
Vec2f foot_on(const Scene& scene, std::uint32_t triangle, const Vec3f& point) {
    const Vec3d a = to_double(scene.corner(triangle, 0));
    const Vec3d u = to_double(scene.corner(triangle, 1)) - a, v = to_double(scene.corner(triangle, 2)) - a;
    const Vec3d p = to_double(point) - a, n = u.cross(v);
    return {static_cast<float>(p.cross(v).dot(n) / n.length2()), static_cast<float>(u.cross(p).dot(n) / n.length2())};
}

/// What panes leave of a pixel's weight, by the mean of their channels: exact up to the steps of weights.
std::uint32_t surviving(std::uint32_t weight, const Rgb& tint) {
    if (tint == Rgb(1, 1, 1)) return weight;
    return static_cast<std::uint32_t>(std::lround(static_cast<double>(weight) * static_cast<double>(tint.x + tint.y + tint.z) / 3));
}

class HemicubeEstimator final : public Estimator {
  public:
    HemicubeEstimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                      const HemicubeOptions& options)
        : scene_(scene), atlas_(atlas), patches_(patches), tracer_(tracer), options_(options), weights_(options.resolution) {}

    void cast(PatchNumber patch, LevelRange levels, std::vector<Landings>& out) const override {
        if (levels != LevelRange{0, hemicube_level})
            throw Error(ErrorCode::internal, "hemicube", "has all levels at once, found " + std::to_string(levels.first) + " to " +
                                                             std::to_string(levels.last));
        out.resize(1);
        out[0].clear();
        const HemicubePlace place = hemicube_place(scene_, atlas_, patches_, patch);
        const Vec3f origin = offset_origin(place.position, place.normal, scene_.corner_extent(place.triangle));
        const Frame frame = turned_frame(place.normal, patch);
        SeenPatches seen;
        for (std::uint32_t face = 0; face < weights_.face_count(); ++face)
            for (std::uint32_t row = 0; row < weights_.rows(face); ++row)
                for (std::uint32_t column = 0; column < weights_.resolution(); column += batch)
                    cast_run(frame, origin, place.triangle, face, row, column, seen, out[0]);
        seen.give(out[0]);
    }

    [[nodiscard]] std::uint32_t replicate_count() const override { return 1; }

    [[nodiscard]] std::uint64_t rays_of(LevelRange levels) const override {
        return levels.empty() ? 0 : std::uint64_t{3} * options_.resolution * options_.resolution;
    }

    [[nodiscard]] Key identity() const override {
        return KeyBuilder("hemicube estimator 3")
            .text(tracer_identity())
            .integer(static_cast<std::int64_t>(options_.seed))
            .integer(options_.resolution)
            .finish();
    }

  private:
    /// The patch's frame, turned about the normal. The angle is that of a uniform point of the disk: no libm, same bits.
    [[nodiscard]] Frame turned_frame(const Vec3f& normal, PatchNumber patch) const {
        const std::uint64_t random = mix(patches_.patches[patch].id, options_.seed);
        const auto unit = [](std::uint64_t bits) { return static_cast<float>(bits & 0xffffff) * 0x1p-24f; };
        Vec3f turn = cosine_direction(unit(random), unit(random >> 24));
        turn.z = 0;
        // The middle of the disk has no angle.
        turn = turn.length2() > 1e-12f ? turn.normalized() : Vec3f(1, 0, 0);
        const Frame plain(normal);
        Frame turned = plain;
        turned.tangent = plain.to_world({turn.x, turn.y, 0});
        turned.bitangent = plain.to_world({-turn.y, turn.x, 0});
        return turned;
    }

    void cast_run(const Frame& frame, const Vec3f& origin, std::uint32_t triangle, std::uint32_t face, std::uint32_t row,
                  std::uint32_t column, SeenPatches& seen, Landings& out) const {
        std::array<TraceRay, batch> rays;
        std::array<TraceHit, batch> hits;
        const std::size_t count = std::min<std::size_t>(batch, weights_.resolution() - column);
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3f way = weights_.direction(face, row, column + static_cast<std::uint32_t>(k));
            rays[k] = {origin, frame.to_world(way.normalized()), triangle};
        }
        tracer_.first_hits({rays.data(), count}, {hits.data(), count});
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint32_t whole = weights_.weight(face, row, column + static_cast<std::uint32_t>(k));
            const std::uint32_t weight = surviving(whole, hits[k].tint);
            out.back += whole - weight;
            if (weight == 0) continue;
            const Landing at = landing(scene_, atlas_, patches_, hits[k]);
            if (at.end == RayEnd::patch)
                seen.add(at.patch, weight);
            else
                (at.end == RayEnd::open ? out.open : out.back) += weight;
        }
    }

    const Scene& scene_;
    const Atlas& atlas_;
    const PatchSet& patches_;
    const Tracer& tracer_;
    HemicubeOptions options_;
    HemicubeWeights weights_;
};

}  // namespace

HemicubePlace hemicube_place(const Scene& scene, const Atlas& atlas, const PatchSet& patches, PatchNumber patch) {
    const PatchSampler sampler(scene, atlas, patches, patch);
    if (sampler.flat()) {
        const SurfacePoint at = sampler.point(0.5f, 0.5f);
        return {at.position, at.normal, at.triangle};
    }
    const Vec3f& centre = patches.patches[patch].center;
    HemicubePlace best;
    float best_distance = std::numeric_limits<float>::infinity();
    const auto consider = [&](std::uint32_t triangle, const Vec2f& at) {
        const Vec3f position = surface_position(scene, triangle, at);
        const float distance = (position - centre).length2();
        if (!(distance < best_distance) && best.triangle != none) return;
        best_distance = distance;
        best = {position, scene.geometric_normal(triangle), triangle};
    };
    for (const Fragment& fragment : patches.fragments_of(patch)) {
        const FragmentPolygon polygon = fragment_polygon(scene, atlas, fragment);
        if (fragment.visible == all_visible) {
            const Vec2f foot = foot_on(scene, fragment.triangle, centre);
            consider(fragment.triangle, inside(polygon.corners(), foot) ? foot : polygon.centroid());
        } else {
            for (std::uint32_t cell = 0; cell < cells_across * cells_across; ++cell)
                if ((fragment.visible >> cell) & 1u)
                    consider(fragment.triangle, polygon.point(cell_middle(cell).x, cell_middle(cell).y));
        }
    }
    if (patches.patches[patch].is_back) best.normal = -best.normal;
    return best;
}

std::unique_ptr<Estimator> make_hemicube_estimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                                   const Tracer& tracer, const HemicubeOptions& options) {
    return std::make_unique<HemicubeEstimator>(scene, atlas, patches, tracer, options);
}

}  // namespace luxel
