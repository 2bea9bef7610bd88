/// Warnings on standard error: a line each, as long as there are few of a kind.
#pragma once
#include <span>

#include "formats/base/error.h"

namespace luxel {

/// Prints the first three of each code in the order in which they came, and how many more there are. The report has them all.
void print_warnings(std::span<const Warning> warnings);

}  // namespace luxel
