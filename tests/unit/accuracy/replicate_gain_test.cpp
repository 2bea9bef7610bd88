// Gains from made-up evidence: independent rays have a gain of 1, evenly spread ones much less.
#include "baker/accuracy/replicate_gain.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

constexpr std::uint32_t replicates = 4, patches = 200;
constexpr std::uint8_t level = 6;  // 64 rays a replicate

/// Every patch sees patches 0 to 3 with these shares: 0.5, 0.25, 0.125, 0.125.
constexpr std::array<double, 4> shares{0.5, 0.25, 0.125, 0.125};

std::vector<std::uint32_t> independent_counts(std::mt19937_64& random) {
    std::discrete_distribution<std::size_t> target(shares.begin(), shares.end());
    std::vector<std::uint32_t> counts(shares.size());
    for (int ray = 0; ray < 1 << level; ++ray) ++counts[target(random)];
    return counts;
}

std::vector<std::uint32_t> even_counts(std::mt19937_64&) {
    std::vector<std::uint32_t> counts;
    for (const double share : shares) counts.push_back(static_cast<std::uint32_t>(share * (1 << level)));
    return counts;
}

template <class Counts>
ReplicateGains gains_of(const Counts& counts) {
    const TemporaryFolder folder;
    std::mt19937_64 random(1);
    std::vector<PatchId> ids(patches);
    for (std::uint32_t p = 0; p < patches; ++p) ids[p] = p + 1;
    std::vector<EvidenceRecord> records;
    for (const PatchId id : ids)
        for (std::uint8_t r = 0; r < replicates; ++r) {
            EvidenceRecord record{id, r, 0, level, 0, 0, {}, {}};
            const std::vector<std::uint32_t> found = counts(random);
            for (std::size_t k = 0; k < found.size(); ++k)
                if (found[k]) record.target_id.push_back(ids[k]), record.count.push_back(found[k]);
            records.push_back(record);
        }
    const EvidenceFile file{folder / "evidence", Key{1, 2}};
    BlockFileWriter writer(file.path, FileKind::evidence, evidence_version, file.key);
    writer.append(0, encode_evidence(records));
    writer.publish();
    const std::vector<double> area(patches, 1.0), mu(patches, 256.0), open(patches, 0.0);
    const std::vector<Rgb> reflectance(patches, Rgb{0.5f, 0.5f, 0.5f});
    std::vector<Channels> radiosity(patches, Channels{1, 1, 1});
    radiosity[0] = {5, 5, 5};
    const std::vector<Channels> row_mean(patches, Channels{3, 3, 3});
    const std::vector<std::uint32_t> neighbourhood(patches, 0);
    return replicate_gains(EvidenceFiles({&file, 1}), {ids, area, reflectance, radiosity, row_mean, mu, open, neighbourhood}, replicates);
}

TEST(ReplicateGain, IndependentRaysGainNothing) {
    const ReplicateGains gains = gains_of(independent_counts);
    // 200 patches of 3 degrees of freedom each: the ratio scatters by sqrt(2 / 600); five of that.
    const double five_sigma = 5 * std::sqrt(2.0 / (3 * patches));
    EXPECT_NEAR(gains.rows[0], 1, five_sigma);
    // Counts of a fixed number of rays scatter by 1 - share of Poisson. 128 of 256 rays: half the patches in bin 6, half in 7.
    EXPECT_NEAR(0.5 * (gains.of_count(100) + gains.of_count(150)), 0.5, 2 * five_sigma);
    EXPECT_NEAR(gains.of_count(32), 1 - shares[2], 3 * five_sigma);
    EXPECT_EQ(gains.of_count(1.5), 1);
}

TEST(ReplicateGain, EvenRaysGainAll) {
    const ReplicateGains gains = gains_of(even_counts);
    EXPECT_EQ(gains.rows[0], 0.02);
    EXPECT_EQ(gains.of_count(128), 0.02);
    EXPECT_EQ(gains.of_count(1), 1);
}

}  // namespace
}  // namespace luxel::test
