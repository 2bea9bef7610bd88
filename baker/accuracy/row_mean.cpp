#include "baker/accuracy/row_mean.h"

#include <algorithm>

#include "baker/accuracy/pair_pass.h"

namespace luxel {

std::vector<Channels> row_means(BlockSource& source, std::span<const Channels> radiosity, std::span<const double> mu,
                                std::span<const double> open_m2) {
    constexpr std::size_t weights = 3;  // place of their sum behind the channels
    PatchSums<4> sums =
        sum_over_pairs<4>(source, [&](PatchNumber i, PatchNumber j, double area_m2, auto& to_i, auto& to_j) {
            const double w = area_m2 / (mu[i] + mu[j]);
            for (std::size_t c = 0; c < 3; ++c) to_i[c] += w * radiosity[j][c], to_j[c] += w * radiosity[i][c];
            to_i[weights] += w, to_j[weights] += w;
        });
    std::vector<Channels> means(sums.size(), Channels{});
    for (std::size_t i = 0; i < means.size(); ++i) {
        if (!(mu[i] > 0)) continue;
        const double own = std::max(source.diagonal_m2()[i], 0.0) / mu[i];
        const double sum = sums[i][weights] + own + std::max(open_m2[i], 0.0) / mu[i];
        if (!(sum > 0)) continue;
        for (std::size_t c = 0; c < 3; ++c) means[i][c] = (sums[i][c] + own * radiosity[i][c]) / sum;
    }
    return means;
}

}  // namespace luxel
