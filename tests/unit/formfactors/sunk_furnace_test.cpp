/// The furnace with things that are sunk into each other: every surface emits M and reflects rho, so B = M / (1 - rho)
/// wherever anybody can look. What lies inside solids or behind walls must not show beside it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "baker/formfactors/closure.h"
#include "tests/support/see_through.h"
#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

using test::box;
using test::MadeMesh;
using test::moved;
using test::SceneMaker;

constexpr double rho = 0.8;

test::MadeMaterial furnace_wall() {
    test::MadeMaterial material;
    material.reflectance = {rho, rho, rho};
    material.nits = {1 / 3.14159265358979, 1 / 3.14159265358979, 1 / 3.14159265358979};
    return material;
}

/// Counts of a whole scene as one block of one chunk.
class OneBlock final : public CountSource {
  public:
    explicit OneBlock(const std::map<std::pair<PatchNumber, PatchNumber>, std::uint32_t>& pairs, PatchNumber patches) {
        layout_.first_patch.push_back(patches);
        block_.row_begin.assign(patches + 1, 0);
        for (const auto& [pair, count] : pairs) {
            ++block_.row_begin[pair.first + 1];
            block_.columns.push_back(static_cast<std::uint16_t>(pair.second));
            block_.counts.push_back(count);
        }
        for (std::size_t r = 1; r < block_.row_begin.size(); ++r) block_.row_begin[r] += block_.row_begin[r - 1];
    }
    const ChunkLayout& layout() const override { return layout_; }
    std::size_t block_count() const override { return 1; }
    void load(std::size_t, CountBlock& out) const override { out = block_; }

  private:
    ChunkLayout layout_;
    CountBlock block_;
};

struct Furnace {
    std::unique_ptr<test::Prepared> made;
    std::vector<double> radiosity;                ///< B, in M / (1 - rho)
    std::vector<std::uint64_t> rays, lost;        ///< of the patch's own: on backs or into the open
};

/// Pools, closes and solves what rays find.
Furnace bake_furnace(Scene scene, const test::PrepareOptions& options = {}) {
    Furnace f;
    f.made = test::prepare(std::move(scene), options);
    const auto ids = f.made->ids();
    const auto count = static_cast<PatchNumber>(ids.size());
    std::map<PatchId, PatchNumber> number;
    for (PatchNumber p = 0; p < count; ++p) number[ids[p]] = p;
    std::map<std::pair<PatchNumber, PatchNumber>, std::uint32_t> pairs;
    std::vector<std::uint64_t> self(count);
    f.rays.resize(count), f.lost.resize(count);
    for (const auto& [id, records] : test::evidence_of(*f.made, *test::estimator_of(*f.made), {0, 8}))
        for (const EvidenceRecord& record : records) {
            const PatchNumber i = number[id];
            f.rays[i] += record.ray_count();
            f.lost[i] += record.open + record.back;
            for (std::size_t k = 0; k < record.count.size(); ++k) {
                const PatchNumber j = number[record.target_id[k]];
                if (i == j) self[i] += record.count[k];
                else pairs[std::minmax(i, j)] += record.count[k];
            }
        }
    const auto area = f.made->area_m2();
    const OneBlock counts(pairs, count);
    const Closure closure = close_rows(counts, {area, f.rays, self, f.lost}, {64, 1e-9});
    f.radiosity.assign(count, 1);
    for (int bounce = 0; bounce < 200; ++bounce) {
        std::vector<double> gathered(count);
        for (PatchNumber p = 0; p < count; ++p) gathered[p] = closure.diagonal_m2[p] * f.radiosity[p];
        for (const auto& [pair, c] : pairs) {
            const double g = static_cast<double>(exchange_area(c, closure.mu[pair.first], closure.mu[pair.second]));
            gathered[pair.first] += g * f.radiosity[pair.second];
            gathered[pair.second] += g * f.radiosity[pair.first];
        }
        for (PatchNumber p = 0; p < count; ++p) f.radiosity[p] = 1 - rho + rho * gathered[p] / area[p];
    }
    return f;
}

/// Does the patch face what is between the walls of the room?
bool in_the_room(const Patch& patch, const Vec3d& origin) {
    const Vec3d at = to_double(patch.center) + origin + 1e-3 * to_double(patch.normal);
    return at.x > 0 && at.y > 0 && at.z > 0 && at.x < 4 && at.y < 3 && at.z < 4;
}

/// Largest number of n rays that are lost with probability p each, but for one case in a million.
std::uint64_t most_lost(double n, double p) {
    double term = std::exp(n * std::log1p(-p)), sum = term;
    std::uint64_t k = 0;
    for (; sum < 1 - 1e-6; ++k) sum += term *= (n - static_cast<double>(k)) / static_cast<double>(k + 1) * p / (1 - p);
    return k;
}

/// What is narrower than a 256th of a fragment is not found (trace/visible_area.h): at two borders of each at most, rays of
/// such a share start inside a solid and are lost. In units of M / (1 - rho), 1 - B = rho (F (1 - B) + lost share), and rows of F
/// sum to 1 at most: so no patch misses more than rho / (1 - rho) times the largest share that is lost.
void expect_furnace(const char* what, const Scene& scene) {
    const Furnace f = bake_furnace(scene);
    double worst = 0, worst_lost = 0, area_m2 = 0, missing = 0;
    std::uint64_t lost = 0, rays = 0;
    for (PatchNumber p = 0; p < f.radiosity.size(); ++p) {
        const Patch& patch = f.made->patches.patches[p];
        if (!in_the_room(patch, f.made->scene.origin)) continue;
        const double n = static_cast<double>(f.rays[p]), off = 1 - f.radiosity[p], area = static_cast<double>(patch.area_m2);
        EXPECT_LE(f.lost[p], most_lost(n, 2.0 / 256)) << what << ": patch of " << f.made->path_of(p) << " at " << patch.center;
        worst = std::max(worst, std::fabs(off));
        worst_lost = std::max(worst_lost, static_cast<double>(f.lost[p]) / n);
        area_m2 += area, missing += area * std::fabs(off);
        lost += f.lost[p], rays += f.rays[p];
    }
    // Closure moves the share a little: the factor is that of its multipliers.
    EXPECT_LE(worst, rho / (1 - rho) * worst_lost * 1.25 + 1e-6) << what;
    std::printf("%-34s B off by %.5f at most, %.6f on average; %llu of %llu rays lost\n", what, worst, missing / area_m2,
                static_cast<unsigned long long>(lost), static_cast<unsigned long long>(rays));
}

SceneMaker furnace_room() {
    SceneMaker maker;
    maker.add("walls", test::room({0, 0, 0}, {4, 3, 4}), furnace_wall());
    return maker;
}

/// A cube of 1 m around `center`, turned so that no side runs along texels.
MadeMesh turned_cube(const Vec3f& center) {
    MadeMesh cube = moved(box(1, 1, 1), {-0.5f, -0.5f, -0.5f});
    for (Vec3f& p : cube.positions) p = Vec3f{0.8f * p.x + 0.6f * p.z, p.y, -0.6f * p.x + 0.8f * p.z} + center;
    return cube;
}

TEST(SunkFurnace, BallInTheFloor) {
    for (const float y : {0.3f, 0.0f, -0.4f}) {
        const std::string what = "ball, its centre at " + std::to_string(y) + " m";
        expect_furnace(what.c_str(), furnace_room().add("ball", moved(test::icosphere(3, 0.8f), {2.01f, y, 1.97f}), furnace_wall()).build());
    }
}

TEST(SunkFurnace, BallInASlab) {
    expect_furnace("ball in a slab", furnace_room()
                                         .add("slab", moved(box(3.8f, 0.8f, 3.8f), {0.1f, 0.1f, 0.1f}), furnace_wall())
                                         .add("ball", moved(test::icosphere(3, 0.6f), {2.01f, 0.95f, 1.97f}), furnace_wall())
                                         .build());
}

TEST(SunkFurnace, BeamThroughAWall) {
    MadeMesh beam = moved(box(1.5f, 0.5f, 0.4f), {-0.7f, 1.03f, 1.7f});
    for (Vec3f& p : beam.positions) p.y += 0.3f * p.x;
    expect_furnace("beam through a wall", furnace_room().add("beam", beam, furnace_wall()).build());
}

TEST(SunkFurnace, BoxAHairInTheFloor) {
    for (const float hair : {3e-2f, 1e-3f, 1e-4f, 1e-5f, 0.0f}) {
        const std::string what = "box, " + std::to_string(1000 * hair) + " mm in the floor";
        expect_furnace(what.c_str(), furnace_room().add("box", moved(box(1, 1, 1), {1.03f, -hair, 1.01f}), furnace_wall()).build());
    }
}

TEST(SunkFurnace, TwoBoxes) {
    expect_furnace("two boxes in each other", furnace_room()
                                                  .add("box", moved(box(1, 1, 1), {1.03f, 0.7f, 1.01f}), furnace_wall())
                                                  .add("cube", turned_cube({2, 1.2f, 2}), furnace_wall())
                                                  .build());
}

/// Half a sheet, a checker of holes and a pane in the furnace: what passes is as bright as what is met, so B stays. Rays that
/// are lost would be surface that rays meet but that no patch stands for.
TEST(SeeThroughFurnace, NothingIsMadeUpOrLost) {
    for (const std::string kind : {"sheet", "mask", "pane"}) {
        test::MadeMaterial two_sided = furnace_wall();
        two_sided.double_sided = true;
        SceneMaker maker;
        maker.add("walls", test::room({0, 0, 0}, {4, 3, 4}), furnace_wall());
        maker.add(kind, test::quad({0.6f, 0.5f, 1.1f}, {0.3f, 2, 0.2f}, {2.5f, 0.1f, 1}), two_sided);
        if (kind == "mask") test::checker_mask(maker, 0.21f);
        test::last_material(maker).base_color = {rho, rho, rho, kind == "sheet" ? 0.5 : 1.0};
        if (kind == "sheet") test::last_material(maker).alpha_mode = AlphaMode::blend;
        // A clear pane reflects nothing, and emits nothing.
        if (kind == "pane") test::last_material(maker).emission = {0, 0, 0}, test::glass(maker, {1, 1, 1});
        const Furnace f = bake_furnace(test::build_with_pictures(maker));
        std::uint64_t rays = 0, lost = 0;
        for (PatchNumber p = 0; p < f.made->patches.count(); ++p) {
            rays += f.rays[p], lost += f.lost[p];
            EXPECT_NEAR(f.radiosity[p], 1, 0.01) << kind << ' ' << f.made->path_of(p);
        }
        std::printf("%-6s %llu of %llu rays lost\n", kind.c_str(), static_cast<unsigned long long>(lost), static_cast<unsigned long long>(rays));
        EXPECT_LE(lost, rays / 2000) << kind;
    }
}

}  // namespace
}  // namespace luxel
