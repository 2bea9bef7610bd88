#include "baker/formfactors/closure.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "baker/core/parallel.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

/// Rays of a scene whose exact factors are known: F_ij in proportion to A_j (the inside of a sphere), times 1 - open.
class Simulated final : public CountSource {
  public:
    Simulated(std::size_t patches, std::size_t chunk_patches, double open, std::uint64_t rays_per_patch,
              unsigned seed) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> uniform(0.1, 2.0);
        for (std::size_t i = 0; i < patches; ++i) area_m2.push_back(uniform(random));
        rays.assign(patches, rays_per_patch);
        // Importance: some patches send many times as many.
        for (std::size_t i = 0; i < patches; i += 5) rays[i] *= 16;
        self_hits.assign(patches, 0);
        open_hits.assign(patches, 0);
        std::discrete_distribution<std::size_t> target(area_m2.begin(), area_m2.end());
        std::bernoulli_distribution leaves(open);
        for (std::size_t i = 0; i < patches; ++i)
            for (std::uint64_t ray = 0; ray < rays[i]; ++ray) {
                const std::size_t j = target(random);
                if (leaves(random))
                    ++open_hits[i];
                else if (i == j)
                    ++self_hits[i];
                else
                    ++counts_[{std::min(i, j), std::max(i, j)}];
            }
        for (std::size_t first = 0; first < patches; first += chunk_patches)
            layout_.first_patch.push_back(static_cast<PatchNumber>(std::min(patches, first + chunk_patches)));
        for (const auto& [pair, count] : counts_) add(pair.first, pair.second, count);
        for (auto& [key, block] : by_chunk_) {
            for (std::size_t r = 1; r < block.row_begin.size(); ++r) block.row_begin[r] += block.row_begin[r - 1];
            blocks_.push_back(block);
        }
    }

    const ChunkLayout& layout() const override { return layout_; }
    std::size_t block_count() const override { return blocks_.size(); }
    void load(std::size_t index, CountBlock& out) const override { out = blocks_[index]; }
    [[nodiscard]] ClosureInput input() const { return {area_m2, rays, self_hits, open_hits}; }

    /// sum over j of the row as a reader of the store would add it up, diagonal and open share included.
    [[nodiscard]] std::vector<double> rows(const Closure& closure) const {
        std::vector<double> sum(area_m2.size());
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = closure.diagonal_m2[i] + closure.row_open_m2[i];
        for (const auto& [pair, count] : counts_) {
            const double g = exchange_area(count, closure.mu[pair.first], closure.mu[pair.second]);
            sum[pair.first] += g;
            sum[pair.second] += g;
        }
        return sum;
    }

    template <class Body>
    void each_pair(const Body& body) const {
        for (const auto& [pair, count] : counts_) body(pair.first, pair.second, count);
    }

    std::vector<double> area_m2;
    std::vector<std::uint64_t> rays, self_hits, open_hits;

  private:
    void add(std::size_t i, std::size_t j, std::uint32_t count) {
        const ChunkNumber a = layout_.chunk_of(static_cast<PatchNumber>(i));
        const ChunkNumber b = layout_.chunk_of(static_cast<PatchNumber>(j));
        CountBlock& block = by_chunk_[{a, b}];
        block.a = a;
        block.b = b;
        block.row_begin.resize(layout_.size(a) + 1);
        ++block.row_begin[i - layout_.first_patch[a] + 1];
        block.columns.push_back(static_cast<std::uint16_t>(j - layout_.first_patch[b]));
        block.counts.push_back(count);
    }

    ChunkLayout layout_;
    std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> counts_;
    std::map<std::pair<ChunkNumber, ChunkNumber>, CountBlock> by_chunk_;
    std::vector<CountBlock> blocks_;
};

TEST(Closure, RowsAreExactOpenAndClosed) {
    for (const double open : {0.0, 0.3, 0.81}) {
        const Simulated scene(200, 64, open, 256, 1);
        for (const std::uint32_t iterations : {0u, 1u, 4u, 16u, 64u}) {
            const Closure closure = close_rows(scene, scene.input(), {.iterations = iterations, .tolerance = 0});
            const std::vector<double> rows = scene.rows(closure);
            for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_NEAR(rows[i] / scene.area_m2[i], 1.0, 1e-14);
            std::printf(
                "open %.2f, %2u iterations: largest row error %.2g -> %.2g, mean %.2g -> %.2g, remainder %.2g\n", open,
                iterations, closure.report.max_row_error_before, closure.report.max_row_error_after,
                closure.report.mean_row_error_before, closure.report.mean_row_error_after,
                closure.report.remainder_share);
            if (iterations == 16) {
                EXPECT_LT(closure.report.max_row_error_after, 1e-3);
            }
            if (iterations == 64) {
                EXPECT_LT(closure.report.max_row_error_after, 1e-6);
            }
        }
    }
}

TEST(Closure, IsCloserToTheTruthThanPlainPooling) {
    const Simulated scene(120, 64, 0.0, 256, 1);
    double area_sum = 0;
    for (const double area : scene.area_m2) area_sum += area;
    const auto error = [&](std::uint32_t iterations) {
        const Closure closure = close_rows(scene, scene.input(), {.iterations = iterations});
        double sum = 0;
        CountBlock block;
        for (std::size_t k = 0; k < scene.block_count(); ++k) {
            scene.load(k, block);
            for (std::size_t r = 0; r + 1 < block.row_begin.size(); ++r)
                for (std::size_t p = block.row_begin[r]; p < block.row_begin[r + 1]; ++p) {
                    const std::size_t i = scene.layout().first_patch[block.a] + r;
                    const std::size_t j = scene.layout().first_patch[block.b] + block.columns[p];
                    const double g = exchange_area(block.counts[p], closure.mu[i], closure.mu[j]);
                    const double wanted = scene.area_m2[i] * scene.area_m2[j] / area_sum;
                    sum += (g - wanted) * (g - wanted);
                }
        }
        return std::sqrt(sum);
    };
    EXPECT_LT(error(16), error(0));
}

/// Exchange areas by plain pooling, dense, diagonal included; variance of each.
struct Pooled {
    Eigen::MatrixXd area_m2, variance;
};

Pooled pool(const Simulated& scene) {
    const auto n = static_cast<Eigen::Index>(scene.area_m2.size());
    Pooled pooled{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
    const auto mu = [&](Eigen::Index i) {
        return static_cast<double>(scene.rays[static_cast<std::size_t>(i)]) / scene.area_m2[static_cast<std::size_t>(i)];
    };
    const auto set = [&](Eigen::Index i, Eigen::Index j, double count, double density) {
        pooled.area_m2(i, j) = pooled.area_m2(j, i) = count / density;
        pooled.variance(i, j) = pooled.variance(j, i) = count / (density * density);
    };
    for (Eigen::Index i = 0; i < n; ++i) set(i, i, static_cast<double>(scene.self_hits[static_cast<std::size_t>(i)]), mu(i));
    scene.each_pair([&](std::size_t i, std::size_t j, std::uint32_t count) {
        const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
        set(a, b, count, mu(a) + mu(b));
    });
    return pooled;
}

/// d_i G_ij d_j with the rows of a closed room.
Eigen::MatrixXd sinkhorn(Eigen::MatrixXd g, const Eigen::VectorXd& area_m2) {
    for (int step = 0; step < 500; ++step) {
        const Eigen::VectorXd scale = (area_m2.array() / g.rowwise().sum().array()).sqrt();
        g = scale.asDiagonal() * g * scale.asDiagonal();
    }
    return g;
}

/// Least sum of (x_ij - G_ij)^2 / variance with the rows of a closed room: x_ij = G_ij + variance_ij (l_i + l_j).
Eigen::MatrixXd least_squares(const Pooled& pooled, const Eigen::VectorXd& area_m2) {
    Eigen::MatrixXd system = pooled.variance;
    system.diagonal() += pooled.variance.rowwise().sum();
    const Eigen::VectorXd missing = area_m2 - pooled.area_m2.rowwise().sum();
    const Eigen::VectorXd l = system.ldlt().solve(missing);
    Eigen::MatrixXd found = pooled.area_m2;
    for (Eigen::Index i = 0; i < found.rows(); ++i)
        for (Eigen::Index j = 0; j < found.cols(); ++j) found(i, j) += pooled.variance(i, j) * (l(i) + l(j));
    return found;
}

/// The likelihood against what else could make the rows exact: symmetric scaling, and weighted least squares. Judged by
/// what patches gather from a lamp and from even light, and by negative areas.
TEST(Closure, NoOtherWayToExactRowsIsMuchBetter) {
    constexpr int seeds = 60;
    for (const std::uint64_t rays : {16u, 64u, 1024u}) {
        std::map<std::string, double> square;
        double negative = 0;
        for (unsigned seed = 1; seed <= seeds; ++seed) {
            const Simulated scene(60, 64, 0.0, rays, seed);
            const auto n = static_cast<Eigen::Index>(scene.area_m2.size());
            const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(scene.area_m2.data(), n);
            const Eigen::MatrixXd truth = area * area.transpose() / area.sum();
            // A sixth of the patches are lamps, the rest gets brighter from one end to the other.
            const Eigen::VectorXd light = Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return i % 6 == 1 ? 20.0 : 1 + static_cast<double>(i) / 60; });
            const Pooled pooled = pool(scene);
            const Closure closure = close_rows(scene, scene.input(), {.iterations = 200, .tolerance = 1e-12});
            Eigen::MatrixXd likely = Eigen::MatrixXd::Zero(n, n);
            scene.each_pair([&](std::size_t i, std::size_t j, std::uint32_t count) {
                const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
                likely(a, b) = likely(b, a) = static_cast<double>(exchange_area(count, closure.mu[i], closure.mu[j]));
            });
            for (Eigen::Index i = 0; i < n; ++i) likely(i, i) = closure.diagonal_m2[static_cast<std::size_t>(i)];
            const Eigen::MatrixXd squares = least_squares(pooled, area);
            const auto add = [&](const char* name, const Eigen::MatrixXd& g) {
                square[name] += (((g - truth) * light).array().square() / area.array()).sum() / seeds;
            };
            add("pooled", pooled.area_m2);
            add("likelihood", likely);
            add("sinkhorn", sinkhorn(pooled.area_m2, area));
            add("least squares", squares);
            negative += static_cast<double>((squares.array() < 0).count()) / seeds;
        }
        for (const auto& [name, value] : square) std::printf("%4d rays, %-13s squared error of the gathered light %.4g\n", static_cast<int>(rays), name.c_str(), value);
        std::printf("%4d rays, least squares makes %.1f areas negative\n", static_cast<int>(rays), negative);
        EXPECT_LT(square["likelihood"], 0.9 * square["pooled"]);
        // All three agree to a few per cent: the rows decide, not the way to them.
        EXPECT_LT(square["likelihood"], 1.03 * std::min(square["sinkhorn"], square["least squares"]));
    }
}

TEST(Closure, StopsWhenTheRowsAreClose) {
    const Simulated scene(100, 64, 0.2, 1024, 3);
    const Closure closure = close_rows(scene, scene.input(), {.iterations = 1000, .tolerance = 1e-6});
    EXPECT_LT(closure.report.iterations, 100u);
    EXPECT_LT(closure.report.max_row_error_after, 1e-6);
}

TEST(Closure, PatchesWithoutRaysStayFinite) {
    Simulated scene(60, 20, 0.2, 256, 5);
    // Nobody saw patch 7's own rays; 8 sent nothing and nobody saw it would be a patch without any count.
    scene.rays[7] = scene.self_hits[7] = scene.open_hits[7] = 0;
    for (const std::uint32_t iterations : {0u, 16u}) {
        const Closure closure = close_rows(scene, scene.input(), {.iterations = iterations});
        const std::vector<double> rows = scene.rows(closure);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            EXPECT_TRUE(std::isfinite(closure.mu[i]) && std::isfinite(closure.diagonal_m2[i]));
            EXPECT_GE(closure.row_open_m2[i], 0);
            EXPECT_NEAR(rows[i] / scene.area_m2[i], 1.0, 1e-14);
        }
    }
}

TEST(Closure, NothingSeenIsAllOpen) {
    const Simulated scene(3, 2, 1.0, 64, 1);
    const std::vector<std::uint64_t> none(3, 0);
    const Closure rays = close_rows(scene, scene.input());
    const Closure no_rays = close_rows(scene, {scene.area_m2, none, none, none});
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(rays.row_open_m2[i], scene.area_m2[i], 1e-14);
        EXPECT_NEAR(rays.diagonal_m2[i], 0, 1e-14);
        EXPECT_EQ(no_rays.row_open_m2[i], scene.area_m2[i]);
        EXPECT_EQ(no_rays.diagonal_m2[i], 0);
    }
    const Simulated empty(0, 1, 0.0, 1, 1);
    EXPECT_TRUE(close_rows(empty, empty.input()).mu.empty());
}

TEST(Closure, SelfHitsGoToTheDiagonal) {
    const Simulated scene(10, 10, 0.0, 65536, 1);
    const Closure closure = close_rows(scene, scene.input(), {.iterations = 64});
    double area_sum = 0;
    for (const double area : scene.area_m2) area_sum += area;
    for (std::size_t i = 0; i < 10; ++i) {
        const double wanted = scene.area_m2[i] * scene.area_m2[i] / area_sum;
        EXPECT_NEAR(closure.diagonal_m2[i], wanted, 0.05 * wanted);
    }
}

TEST(Closure, ThreadsAndChunksChangeNothing) {
    std::vector<Closure> results;
    for (const unsigned threads : {1u, 2u, 4u}) {
        const ThreadLimit limit(threads);
        const Simulated scene(300, 20, 0.1, 128, 9);
        results.push_back(close_rows(scene, scene.input()));
    }
    EXPECT_EQ(results[0].mu, results[1].mu);
    EXPECT_EQ(results[0].diagonal_m2, results[1].diagonal_m2);
    EXPECT_EQ(results[0].mu, results[2].mu);
    const Simulated whole(300, 300, 0.1, 128, 9);
    const Closure other = close_rows(whole, whole.input());
    for (std::size_t i = 0; i < 300; ++i) EXPECT_NEAR(other.mu[i] / results[0].mu[i], 1.0, 1e-12);
}

TEST(Closure, CountsWithoutRaysAreDamage) {
    const Simulated scene(4, 2, 0.0, 64, 1);
    const std::vector<std::uint64_t> none(4, 0);
    EXPECT_THROW(close_rows(scene, {scene.area_m2, none, none, none}), Error);
    EXPECT_THROW(close_rows(scene, {scene.area_m2, none, none, {}}), Error);
}

}  // namespace
}  // namespace luxel
