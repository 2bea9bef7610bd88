/// The self-check of the sampler: right samplers fail it as rarely as it says, wrong ones do not get past it.
#include "baker/store/flux_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/core/units.h"
#include "baker/formfactors/evidence.h"
#include "baker/trace/surface_map.h"
#include "baker/patches/patch_sampler.h"
#include "baker/store/probability.h"
#include "baker/core/ray_offset.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

using Point = std::array<float, 4>;  ///< where on the patch, which direction

/// What may go wrong on the way from a point of the sequence to a ray.
struct Sampling {
    std::function<Point(Point)> points = [](Point u) { return u; };
    std::function<Vec3f(float, float)> direction = cosine_direction;
    std::function<Vec3f(Vec3f)> normal = [](Vec3f n) { return n; };
    std::function<PatchNumber(PatchNumber)> landing = [](PatchNumber p) { return p; };
};

/// The ray estimator, spelled out ray by ray, with a way of sampling per patch.
class SpelledOut final : public Estimator {
  public:
    SpelledOut(const test::Prepared& made, std::uint64_t seed, std::function<const Sampling&(PatchNumber)> way)
        : made_(made), seed_(seed), way_(std::move(way)) {}

    void cast(PatchNumber patch, LevelRange levels, std::vector<Landings>& out) const override {
        out.assign(replicate_count(), {});
        const PatchSampler sampler(made_.scene, made_.atlas, made_.patches, patch);
        const Sampling& way = way_(patch);
        const std::uint64_t end = std::uint64_t{1} << levels.last;
        for (std::uint32_t replicate = 0; replicate < out.size(); ++replicate) {
            const SobolSequence sequence(mix(mix(made_.patches.patches[patch].id, seed_), replicate));
            for (std::uint64_t k = end - ray_count(levels); k < end; ++k)
                cast_ray(sampler, way, way.points(sequence.point(static_cast<std::uint32_t>(k))), out[replicate]);
        }
    }
    [[nodiscard]] std::uint32_t replicate_count() const override { return 4; }
    [[nodiscard]] Key identity() const override { return {}; }

  private:
    void cast_ray(const SurfaceSampler& sampler, const Sampling& way, const Point& u, Landings& out) const {
        const SurfacePoint at = sampler.point(u[0], u[1]);
        const Vec3f normal = way.normal(at.normal);
        const Vec3f origin = offset_origin(at.position, normal, made_.scene.corner_extent(at.triangle));
        const Vec3f direction = Frame(normal).to_world(way.direction(u[2], u[3]));
        const Landing end = landing(made_.scene, made_.atlas, made_.patches,
                                    made_.tracer->first_hit({origin, direction, at.triangle}));
        if (end.end == RayEnd::patch)
            out.patches.push_back(way.landing(end.patch));
        else
            ++(end.end == RayEnd::open ? out.open : out.back);
    }

    const test::Prepared& made_;
    std::uint64_t seed_;
    std::function<const Sampling&(PatchNumber)> way_;
};

std::unique_ptr<test::Prepared> furnished_room(double texels_per_metre) {
    test::SceneMaker maker;
    return test::prepare(test::add_furnished_room(maker, "room", Vec3d(0, 0, 0)).build(),
                         {.texels_per_metre = texels_per_metre});
}

/// Levels 0 to `level`, of every eighth patch two more: as importance would have it.
FluxCheck check(const test::Prepared& made, const Estimator& estimator, std::uint8_t level, const FluxOptions& options = {}) {
    const test::TemporaryFolder folder;
    const auto ids = made.ids();
    LevelPlan plan{std::vector<LevelRange>(ids.size(), LevelRange{0, level})};
    std::vector<std::uint32_t> rays;
    for (std::size_t p = 0; p < ids.size(); ++p) {
        if (p % 8 == 0) plan.levels[p].last = static_cast<std::uint8_t>(level + 2);
        rays.push_back(estimator.replicate_count() << plan.levels[p].last);
    }
    std::vector<EvidenceFile> files;
    Publisher publisher;
    for (ChunkNumber chunk = 0; chunk < made.layout.chunk_count(); ++chunk) {
        files.push_back({folder / std::to_string(chunk), Key{1, 2}});
        write_chunk_evidence(estimator, made.layout, ids, chunk, plan, files.back().path, files.back().key, publisher, nullptr);
    }
    publisher.finish();
    const auto area_m2 = made.area_m2();
    return check_flux({ids, area_m2, rays}, files, options);
}

FluxCheck check(const test::Prepared& made, const Sampling& way, std::uint64_t seed, std::uint8_t level = 7) {
    return check(made, SpelledOut(made, seed, [&](PatchNumber) -> const Sampling& { return way; }), level);
}

/// Directions uniform over the half space.
Sampling uniform_directions() {
    Sampling way;
    way.direction = [](float u, float v) {
        const float r = std::sqrt(std::max(0.0f, 1 - u * u)), turn = 2 * static_cast<float>(pi) * v;
        return Vec3f(r * std::cos(turn), r * std::sin(turn), std::max(u, 1e-6f));
    };
    return way;
}

/// Twice as many points at one border of the patch as on average, none at the other.
Sampling crowded_points() {
    Sampling way;
    way.points = [](Point u) { return Point{1 - std::sqrt(1 - u[0]), u[1], u[2], u[3]}; };
    return way;
}

/// Normals mirrored as by a transform with a negative scale: those along x point into the wall.
Sampling mirrored_normals() {
    Sampling way;
    way.normal = [](Vec3f n) { return Vec3f(-n.x, n.y, n.z); };
    return way;
}

TEST(FluxCheck, SpelledOutIsTheRayEstimator) {
    const auto made = furnished_room(6);
    const Sampling right;
    const SpelledOut spelled(*made, 3, [&](PatchNumber) -> const Sampling& { return right; });
    EXPECT_EQ(test::evidence_of(*made, spelled, {0, 5}), test::evidence_of(*made, *test::estimator_of(*made, {3}), {0, 5}));
}

TEST(FluxCheck, FindsDirectionsThatAreUniform) {
    const auto made = furnished_room(6);
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const FluxCheck found = check(*made, uniform_directions(), seed);
        EXPECT_FALSE(found.passed) << seed << ": " << found.probability_all << ", " << found.probability_each;
    }
}

TEST(FluxCheck, FindsPointsThatAreNotUniform) {
    const auto made = furnished_room(6);
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const FluxCheck found = check(*made, crowded_points(), seed);
        EXPECT_FALSE(found.passed) << seed << ": " << found.probability_all << ", " << found.probability_each;
    }
}

TEST(FluxCheck, FindsMirroredNormals) {
    const auto made = furnished_room(6);
    for (std::uint64_t seed = 0; seed < 5; ++seed) EXPECT_FALSE(check(*made, mirrored_normals(), seed).passed) << seed;
}

TEST(FluxCheck, FindsHitsGivenToTheNeighbour) {
    const auto made = furnished_room(6);
    Sampling way;
    const auto count = static_cast<PatchNumber>(made->patches.count());
    way.landing = [count](PatchNumber p) { return p % 16 == 0 ? (p + 1) % count : p; };
    for (std::uint64_t seed = 0; seed < 5; ++seed) EXPECT_FALSE(check(*made, way, seed).passed) << seed;
}

/// One patch, whichever it is, is enough: its rays go the other way.
TEST(FluxCheck, FindsASinglePatch) {
    const auto made = furnished_room(6);
    const Sampling right;
    Sampling turned;
    turned.normal = [](Vec3f n) { return -n; };
    const auto few = [&](const Sampling& wrong, PatchNumber patch) {
        return check(*made, SpelledOut(*made, patch, [&, patch](PatchNumber p) -> const Sampling& { return p == patch ? wrong : right; }), 9);
    };
    for (PatchNumber patch = 20; patch < made->patches.count(); patch += 40) {
        const FluxCheck found = few(turned, patch);
        EXPECT_FALSE(found.passed) << patch << ": " << found.probability_each;
        ASSERT_FALSE(found.worst.empty());
        EXPECT_EQ(found.worst.front().patch, patch);
    }
}

/// P(X >= k) of n trials with probability p each.
double binomial_tail(int k, int n, double p) {
    double sum = 0;
    for (int x = k; x <= n; ++x)
        sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(x + 1.0) - std::lgamma(n - x + 1.0) + x * std::log(p) +
                        (n - x) * std::log1p(-p));
    return sum;
}

/// Right samplers: alarms over many seeds are no more than the stated rate allows, at a usual and at a small one.
TEST(FluxCheck, RightSamplersPass) {
    constexpr int seeds = LUXEL_FLUX_SEEDS;
    for (const std::uint8_t level : {std::uint8_t{5}, std::uint8_t{8}}) {
        const auto made = furnished_room(4);
        int often = 0, seldom = 0;
        for (int seed = 0; seed < seeds; ++seed) {
            const FluxCheck found = check(*made, *test::estimator_of(*made, {static_cast<std::uint64_t>(seed) + 100}), level);
            ASSERT_GT(found.patches, made->patches.count() / 2) << "patches with enough rays to be judged";
            const double smaller = 2 * std::min(found.probability_all, found.probability_each);
            often += smaller < 0.05;
            seldom += !found.passed;
        }
        std::printf("%d rays per patch, %zu patches: alarms %d of %d at a rate of 0.05, %d at 0.001\n", 4 << level,
                    made->patches.count(), often, seeds, seldom);
        EXPECT_GT(binomial_tail(often, seeds, 0.05), 1e-4);
        EXPECT_GT(binomial_tail(seldom, seeds, 0.001), 1e-4);
    }
}

TEST(FluxCheck, DoesNotDependOnThreads) {
    const auto made = furnished_room(4);
    std::vector<FluxCheck> found;
    for (const unsigned threads : {1u, 4u}) {
        const ThreadLimit limit(threads);
        found.push_back(check(*made, *test::estimator_of(*made), 6));
    }
    EXPECT_EQ(found[0].probability_all, found[1].probability_all);
    EXPECT_EQ(found[0].probability_each, found[1].probability_each);
    EXPECT_EQ(found[0].mean_difference, found[1].mean_difference);
    ASSERT_EQ(found[0].worst.size(), found[1].worst.size());
    for (std::size_t k = 0; k < found[0].worst.size(); ++k) EXPECT_EQ(found[0].worst[k].t, found[1].worst[k].t);
}

TEST(Probability, KnownValues) {
    // Tables of the t distribution, two-sided; digamma and trigamma at 1 and 1/2.
    EXPECT_NEAR(student_tail(12.706204736, 1), 0.05, 1e-9);
    EXPECT_NEAR(student_tail(2.2281388520, 10), 0.05, 1e-9);
    EXPECT_NEAR(student_tail(3.4602, 60), 0.001, 1e-6);
    EXPECT_EQ(student_tail(0, 3), 1);
    EXPECT_NEAR(digamma(1), -0.57721566490153286, 1e-12);
    EXPECT_NEAR(digamma(0.5), -1.9635100260214235, 1e-12);
    EXPECT_NEAR(trigamma(1), pi * pi / 6, 1e-12);
    EXPECT_NEAR(trigamma(0.5), pi * pi / 2, 1e-11);
    for (const double x : {1e-3, 0.5, 3.0, 1e4}) EXPECT_NEAR(inverse_trigamma(trigamma(x)), x, 1e-9 * x);
}

}  // namespace
}  // namespace luxel
