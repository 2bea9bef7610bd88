#include "baker/store/closed_matrix.h"

#include "baker/formfactors/exchange_area.h"

namespace luxel {

void ClosedMatrix::load(std::size_t index, Block& out) {
    CountBlock counts;
    counts.row_begin = std::move(out.row_begin);  // their memory serves again
    counts.columns = std::move(out.columns);
    counts_.load(index, counts);
    bytes_read_ += counts_.blocks()[index].read_bytes;
    out.a = counts.a;
    out.b = counts.b;
    out.row_begin = std::move(counts.row_begin);
    out.columns = std::move(counts.columns);
    out.areas_m2.resize(counts.counts.size());
    exchange_areas(out.row_begin, out.columns, counts.counts, closure_.mu.data() + layout().first_patch[out.a],
                   closure_.mu.data() + layout().first_patch[out.b], out.areas_m2);
}

}  // namespace luxel
