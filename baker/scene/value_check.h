/// Numbers of materials and lamps that cannot be: colours outside 0 to 1, negative light, light without end.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "formats/base/error.h"

namespace luxel {

/// What becomes of a file with such a number.
enum class BadValues {
    clamp,  ///< the nearest number that can be, 0 for one that is not finite, and a warning
    refuse  ///< Error{bad_input}
};

/// The brightest light that is read, per channel: nits, cd or lux. The sun has 1.6e9 nits. Times pi and divided by the least
/// that a reflectance below 1 can absorb in 32 bits (2^-24) it is 5e37, which still is a 32-bit number.
constexpr double most_light = 1e30;

/// Checks the numbers of one material or lamp. Keeps a reference to `warnings`.
class ValueCheck {
  public:
    /// where: 'material "oak"', for warnings. file: comes before it in errors.
    ValueCheck(BadValues bad_values, std::string file, std::string where, std::vector<Warning>& warnings);

    /// Makes all of `values` lie in [0, highest]. Where one did not: a warning `code` that says property, values, range, and
    /// what is used instead, or the error.
    void limit(std::span<double> values, double highest, const char* code, const std::string& property) const;
    /// As limit(), where there is nothing to be near to: the caller replaces what is said to be out of range.
    void fault(const char* code, const std::string& what, const std::string& instead) const;

  private:
    BadValues bad_values_;
    std::string file_, where_;
    std::vector<Warning>& warnings_;
};

}  // namespace luxel
