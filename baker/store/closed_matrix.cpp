#include "baker/store/closed_matrix.h"

namespace luxel {

void ClosedMatrix::load(std::size_t index, Block& out) {
    CountBlock counts;
    counts_.load(index, counts);
    bytes_read_ += counts_.blocks()[index].read_bytes;
    out.a = counts.a;
    out.b = counts.b;
    out.areas_m2.resize(counts.counts.size());
    const double* mu_a = closure_.mu.data() + layout().first_patch[counts.a];
    const double* mu_b = closure_.mu.data() + layout().first_patch[counts.b];
    for (std::size_t row = 0; row + 1 < counts.row_begin.size(); ++row)
        for (std::uint32_t k = counts.row_begin[row]; k < counts.row_begin[row + 1]; ++k)
            out.areas_m2[k] = exchange_area(counts.counts[k], mu_a[row], mu_b[counts.columns[k]]);
    out.row_begin = std::move(counts.row_begin);
    out.columns = std::move(counts.columns);
}

}  // namespace luxel
