#include "baker/formfactors/exchange_area.h"

#include <cstring>

namespace luxel {
namespace {

// Through the compiler's own vector types: one AVX instruction where there is AVX, two SSE2 instructions elsewhere.
constexpr std::size_t width = 4;
using Doubles = double __attribute__((vector_size(32)));
using Floats = float __attribute__((vector_size(16)));
using Integers = std::int32_t __attribute__((vector_size(16)));

/// Exact: signed conversion, which is one instruction, of the number minus 2^31.
inline Doubles to_doubles(const std::uint32_t* counts) {
    Integers shifted;
    std::memcpy(&shifted, counts, sizeof shifted);
    return __builtin_convertvector(shifted ^ std::numeric_limits<std::int32_t>::min(), Doubles) + 0x1p31;
}

}  // namespace

void exchange_areas(std::span<const std::uint32_t> row_begin, std::span<const std::uint16_t> columns,
                    std::span<const std::uint32_t> counts, const double* mu_rows, const double* mu_columns,
                    std::span<float> areas_m2) {
    const Doubles least = Doubles{} + static_cast<double>(std::numeric_limits<float>::min());
    for (std::size_t row = 0; row + 1 < row_begin.size(); ++row) {
        const std::size_t end = row_begin[row + 1];
        std::size_t k = row_begin[row];
        // The last group of a row may go on into the next, which comes later and writes there again.
        for (; k < end && k + width <= columns.size(); k += width) {
            const std::uint16_t* const c = &columns[k];
            const Doubles mu =
                Doubles{mu_columns[c[0]], mu_columns[c[1]], mu_columns[c[2]], mu_columns[c[3]]} + mu_rows[row];
            const Doubles area = to_doubles(&counts[k]) / mu;
            const Floats stored = __builtin_convertvector(area < least ? least : area, Floats);
            std::memcpy(&areas_m2[k], &stored, sizeof stored);
        }
        for (; k < end; ++k) areas_m2[k] = exchange_area(counts[k], mu_rows[row], mu_columns[columns[k]]);
    }
}

}  // namespace luxel
