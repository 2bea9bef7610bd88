/// Text from files as it may be shown on a terminal: names can hold anything.
#pragma once
#include <string>

namespace luxel {

/// Control characters become \x0a and the like, so that no name breaks a line or steers a terminal; what is longer than a thousand
/// bytes loses its middle. Other bytes stay.
std::string printable(const std::string& text);

}  // namespace luxel
