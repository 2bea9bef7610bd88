/// Where a count becomes an exchange area in m2. The reader of the store and closure both come here, so that they see
/// the same float.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace luxel {

/// mu: rays/m2 of the two patches (closure.h). Symmetric in i and j. count > 0, mu_i + mu_j > 0; the result is a
/// positive normal float.
inline float exchange_area(std::uint32_t count, double mu_i, double mu_j) {
    const double area_m2 = static_cast<double>(count) / (mu_i + mu_j);
    return static_cast<float>(std::max(area_m2, static_cast<double>(std::numeric_limits<float>::min())));
}

/// The same of all pairs of a block in compressed rows, four at a time: row r holds pairs [row_begin[r], row_begin[r +
/// 1]), its mu is mu_rows[r], that of a pair's other patch mu_columns[columns[k]]. `columns`, `counts` and `areas_m2`
/// have one entry per pair. Threads: pure.
void exchange_areas(std::span<const std::uint32_t> row_begin, std::span<const std::uint16_t> columns,
                    std::span<const std::uint32_t> counts, const double* mu_rows, const double* mu_columns,
                    std::span<float> areas_m2);

}  // namespace luxel
