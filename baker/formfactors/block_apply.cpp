#include "baker/formfactors/block_apply.h"

#include <cstdint>
#include <cstring>

namespace luxel {

namespace {

/// Four doubles at once through the compiler's own vector type: one AVX instruction where there is AVX, two SSE2
/// instructions elsewhere, the same bits in both. No multiply-add is formed (floating-point contraction is off).
using Vector = double __attribute__((vector_size(32)));

inline void load(const Lanes& lanes, Vector& out) { std::memcpy(&out, lanes.v, sizeof(Vector)); }
inline void store(const Vector& value, Lanes& lanes) {
    std::memcpy(static_cast<void*>(&lanes), &value, sizeof(Vector));
}

inline void add_product(Lanes& y, float g, const Vector& x) {
    Vector sum;
    load(y, sum);
    sum += x * static_cast<double>(g);
    store(sum, y);
}

}  // namespace

void gather_rows(const Block& block, std::span<const Lanes> x_b, std::span<Lanes> y_a) {
    const std::uint16_t* const columns = block.columns.data();
    const float* const areas = block.areas_m2.data();
    for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row) {
        const std::size_t end = block.row_begin[row + 1];
        std::size_t k = block.row_begin[row];
        if (k == end) continue;
        // Two sums hide the latency of the addition; their order is part of the result.
        Vector even = {0, 0, 0, 0}, odd = {0, 0, 0, 0}, x;
        for (; k + 1 < end; k += 2) {
            load(x_b[columns[k]], x);
            even += x * static_cast<double>(areas[k]);
            load(x_b[columns[k + 1]], x);
            odd += x * static_cast<double>(areas[k + 1]);
        }
        if (k < end) {
            load(x_b[columns[k]], x);
            even += x * static_cast<double>(areas[k]);
        }
        load(y_a[row], x);
        store(x + (even + odd), y_a[row]);
    }
}

void scatter_columns(const Block& block, std::span<const Lanes> x_a, std::span<Lanes> y_b) {
    const std::uint16_t* const columns = block.columns.data();
    const float* const areas = block.areas_m2.data();
    for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row) {
        Vector x;
        load(x_a[row], x);
        for (std::size_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
            add_product(y_b[columns[k]], areas[k], x);
    }
}

namespace {

/// One row both ways. `y_scatter` must not contain the row's own entry among `columns`.
inline void apply_row(const Block& block, std::size_t row, const Lanes& x_row, const Lanes* x_gather, Lanes& y_row,
                      Lanes* y_scatter) {
    const std::uint16_t* const columns = block.columns.data();
    const float* const areas = block.areas_m2.data();
    Vector own, sum = {0, 0, 0, 0}, x;
    load(x_row, own);
    for (std::size_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
        const std::size_t column = columns[k];
        load(x_gather[column], x);
        sum += x * static_cast<double>(areas[k]);
        add_product(y_scatter[column], areas[k], own);
    }
    load(y_row, x);
    store(x + sum, y_row);
}

}  // namespace

void apply_both(const Block& block, std::span<const Lanes> x_a, std::span<const Lanes> x_b, std::span<Lanes> y_a,
                std::span<Lanes> y_b) {
    for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row)
        if (block.row_begin[row] != block.row_begin[row + 1])
            apply_row(block, row, x_a[row], x_b.data(), y_a[row], y_b.data());
}

void apply_diagonal(const Block& block, std::size_t row_first, std::size_t row_last, std::span<const Lanes> x,
                    std::span<Lanes> y) {
    for (std::size_t row = row_first; row < row_last; ++row)
        if (block.row_begin[row] != block.row_begin[row + 1]) apply_row(block, row, x[row], x.data(), y[row], y.data());
}

}  // namespace luxel
