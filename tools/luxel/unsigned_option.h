/// For options that count something. Threads: pure.
#pragma once
#include <CLI/Validators.hpp>

namespace luxel {

/// Refuses a sign: an unsigned number would silently wrap around.
inline const CLI::Validator unsigned_number(
    [](std::string& text) { return text.starts_with('-') ? "expected 0 or more" : std::string(); }, "", "unsigned");

}  // namespace luxel
