// The predicted error against the scatter of many draws, in a scene whose form factors are known: the inside of a
// sphere, where F_ij is A_j / A for all i.
#include "baker/accuracy/standard_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "baker/accuracy/row_mean.h"
#include "baker/core/sobol.h"
#include "baker/formfactors/closure.h"
#include "baker/formfactors/memory_blocks.h"

namespace luxel {
namespace {

/// Independent rays in the sphere; patch 0 is a lamp.
class Sphere {
  public:
    Sphere(std::size_t patches, double open_share, std::uint64_t lamp_rays, std::uint64_t rays) : open_(open_share) {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> uniform(0, 1);
        for (std::size_t i = 0; i < patches; ++i) {
            ids.push_back(mix(i));
            alone.push_back(static_cast<std::uint32_t>(i));
            area_m2.push_back(0.5 + uniform(random));
            whole_m2 += area_m2.back();
            rays_.push_back(i ? rays : lamp_rays);
            mu.push_back(static_cast<double>(rays_[i]) / area_m2[i]);
            const double b = i ? 0.01 * uniform(random) : 1;
            radiosity.push_back({b, b, b});
            reflectance.push_back({0.01f, 0.01f, 0.01f});
        }
        for (std::size_t i = 0; i < patches; ++i) open_m2.push_back(open_share * area_m2[i]);
    }

    [[nodiscard]] double exchange_m2(std::size_t i, std::size_t j) const {
        return (1 - open_) * area_m2[i] * area_m2[j] / whole_m2;
    }

    [[nodiscard]] MemoryBlocks matrix() const {
        std::vector<ExchangePair> pairs;
        std::vector<double> diagonal;
        for (PatchNumber i = 0; i < ids.size(); ++i) {
            diagonal.push_back(exchange_m2(i, i));
            for (PatchNumber j = i + 1; j < ids.size(); ++j)
                pairs.push_back({i, j, static_cast<float>(exchange_m2(i, j))});
        }
        return {layout(), area_m2, diagonal, pairs};
    }
    [[nodiscard]] ChunkLayout layout() const {
        ChunkLayout layout;
        layout.first_patch = {0, static_cast<PatchNumber>(ids.size())};
        return layout;
    }

    /// What every patch gathers in one draw of all rays, closed.
    [[nodiscard]] std::vector<double> gathered(std::uint64_t seed) const {
        const Draw draw(*this, seed);
        const Closure closure = close_rows(draw, {area_m2, rays_, draw.self, draw.open}, {64, 1e-12});
        std::vector<double> h(ids.size());
        for (std::size_t i = 0; i < h.size(); ++i) {
            double sum = closure.diagonal_m2[i] * radiosity[i][0];
            for (std::size_t j = 0; j < h.size(); ++j)
                if (j != i && draw.count(i, j) > 0)
                    sum += static_cast<double>(exchange_area(draw.count(i, j), closure.mu[i], closure.mu[j])) *
                           radiosity[j][0];
            h[i] = sum / area_m2[i];
        }
        return h;
    }

    std::vector<PatchId> ids;
    std::vector<std::uint32_t> alone;  ///< neighbourhoods of one
    std::vector<double> area_m2, mu, open_m2;
    std::vector<Channels> radiosity;
    std::vector<Rgb> reflectance;
    double whole_m2 = 0;

  private:
    class Draw final : public CountSource {
      public:
        Draw(const Sphere& sphere, std::uint64_t seed)
            : self(sphere.ids.size()),
              open(sphere.ids.size()),
              layout_(sphere.layout()),
              counts_(sphere.ids.size() * sphere.ids.size()) {
            std::mt19937_64 random(seed);
            std::discrete_distribution<std::size_t> target(sphere.area_m2.begin(), sphere.area_m2.end());
            std::bernoulli_distribution leaves(sphere.open_);
            const std::size_t count = sphere.ids.size();
            for (std::size_t i = 0; i < count; ++i)
                for (std::uint64_t ray = 0; ray < sphere.rays_[i]; ++ray) {
                    const std::size_t j = target(random);
                    if (leaves(random))
                        ++open[i];
                    else if (i == j)
                        ++self[i];
                    else
                        ++counts_[std::min(i, j) * count + std::max(i, j)];
                }
            block_.row_begin.push_back(0);
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t j = i + 1; j < count; ++j)
                    if (this->count(i, j))
                        block_.columns.push_back(static_cast<std::uint16_t>(j)),
                            block_.counts.push_back(this->count(i, j));
                block_.row_begin.push_back(static_cast<std::uint32_t>(block_.columns.size()));
            }
        }
        [[nodiscard]] std::uint32_t count(std::size_t i, std::size_t j) const {
            return counts_[std::min(i, j) * self.size() + std::max(i, j)];
        }
        const ChunkLayout& layout() const override { return layout_; }
        std::size_t block_count() const override { return 1; }
        void load(std::size_t, CountBlock& out) const override { out = block_; }
        std::vector<std::uint64_t> self, open;

      private:
        ChunkLayout layout_;
        std::vector<std::uint32_t> counts_;
        CountBlock block_;
    };
    double open_;
    std::vector<std::uint64_t> rays_;
};

void expect_predicts(const Sphere& sphere) {
    constexpr int draws = 400;
    const std::size_t count = sphere.ids.size();
    std::vector<double> sum(count), square(count);
    for (int draw = 0; draw < draws; ++draw) {
        const std::vector<double> h = sphere.gathered(static_cast<std::uint64_t>(draw) + 1);
        for (std::size_t i = 0; i < count; ++i) sum[i] += h[i], square[i] += h[i] * h[i];
    }
    MemoryBlocks matrix = sphere.matrix();
    const std::vector<Channels> means = row_means(matrix, sphere.radiosity, sphere.mu, sphere.open_m2);
    ReplicateGains independent{std::vector<double>(count, 1.0), {}};
    independent.counts.fill(1);
    const StandardError error = standard_error(matrix,
                                               {sphere.ids, sphere.area_m2, sphere.reflectance, sphere.radiosity, means,
                                                sphere.mu, sphere.open_m2, sphere.alone},
                                               independent, 1);
    double ratio = 0;
    for (std::size_t i = 1; i < count; ++i) {
        const double mean = sum[i] / draws, variance = (square[i] / draws - mean * mean) * draws / (draws - 1);
        ratio += variance / (error.irradiance[i][0] * error.irradiance[i][0]) / static_cast<double>(count - 1);
    }
    // Each variance is known to 7 %, and the mean of all to 2 %.
    EXPECT_NEAR(ratio, 1, 0.1);
}

TEST(StandardError, IsTheScatterWhenAllSendAlike) { expect_predicts({30, 0, 1000, 1000}); }
TEST(StandardError, IsTheScatterWhenTheLampSendsManyTimesAsMany) { expect_predicts({30, 0, 64000, 1000}); }
TEST(StandardError, IsTheScatterInTheOpen) {
    expect_predicts({30, 0.6, 1000, 1000});
    expect_predicts({30, 0.6, 64000, 1000});
}

/// The light that all gather together is as uncertain as before.
TEST(StandardError, NeighboursShareTheirVariance) {
    const Sphere sphere(20, 0.3, 500, 100);
    MemoryBlocks matrix = sphere.matrix();
    const std::size_t count = sphere.ids.size();
    const std::vector<Channels> means = row_means(matrix, sphere.radiosity, sphere.mu, sphere.open_m2);
    ReplicateGains independent{std::vector<double>(count, 1.0), {}};
    independent.counts.fill(1);
    std::vector<std::uint32_t> halves(count);
    for (std::size_t i = 0; i < count; ++i) halves[i] = i < count / 2 ? 0 : 7;
    const auto variance_lm2 = [&](const std::vector<std::uint32_t>& neighbourhood) {
        const StandardError error = standard_error(matrix,
                                                   {sphere.ids, sphere.area_m2, sphere.reflectance, sphere.radiosity,
                                                    means, sphere.mu, sphere.open_m2, neighbourhood},
                                                   independent, 1);
        std::vector<double> variance;
        for (std::size_t i = 0; i < count; ++i)
            variance.push_back(std::pow(sphere.area_m2[i] * error.irradiance[i][0], 2));
        return variance;
    };
    const std::vector<double> alone = variance_lm2(sphere.alone), shared = variance_lm2(halves);
    for (const std::size_t begin : {std::size_t{0}, count / 2}) {
        double sum_alone = 0, sum_shared = 0;
        for (std::size_t i = begin; i < begin + count / 2; ++i) {
            sum_alone += alone[i], sum_shared += shared[i];
            EXPECT_NEAR(shared[i] / sphere.area_m2[i], shared[begin] / sphere.area_m2[begin], 0.01 * shared[begin])
                << i;
        }
        EXPECT_NEAR(sum_shared, sum_alone, 0.01 * sum_alone) << "bounces are a hundredth of it";
    }
}

TEST(RowMean, IsWhatIsGatheredWhenDensitiesAreEqual) {
    Sphere sphere(20, 0.25, 500, 500);
    for (double& mu : sphere.mu) mu = 700;
    MemoryBlocks matrix = sphere.matrix();
    const auto means = row_means(matrix, sphere.radiosity, sphere.mu, sphere.open_m2);
    for (std::size_t i = 0; i < means.size(); ++i) {
        double gathered = 0, own = 0;
        for (std::size_t j = 0; j < means.size(); ++j) {
            gathered += sphere.exchange_m2(i, j) * sphere.radiosity[j][0];
            if (j == i) own = sphere.exchange_m2(i, i) * sphere.radiosity[i][0];
        }
        // The row's own part and the open share count twice: no partner gives way beside mu_i.
        const double rest = sphere.exchange_m2(i, i) + sphere.open_m2[i];
        EXPECT_NEAR(means[i][0], (gathered + own) / (sphere.area_m2[i] + rest), 1e-6);
    }
}

}  // namespace
}  // namespace luxel
