/// The one exception of the project: where, what, what to do. Thrown where the fault is found, caught once in
/// tools/luxel/main.cpp, which turns the code into an exit code. A message has four parts:
///   where  file, mesh, block, byte offset      what  expected against found      hint  what the user can do
#pragma once
#include <stdexcept>
#include <string>

namespace luxel {

/// Values are the exit codes of the program; never renumber.
enum class ErrorCode : int {
    usage = 1,             ///< an option is unknown or out of range
    bad_input = 2,         ///< a file that came from outside is missing, damaged or unsupported
    not_in_build = 3,      ///< known, but this program was built without it
    cannot_write = 4,      ///< disk full, no permission, a folder where a file is wanted
    damaged_store = 5,     ///< a file of the bake folder fails its checks
    stopped_early = 6,     ///< stopped before the target was reached
    budget_too_small = 7,  ///< --memory is below the floor; the message states the floor
    internal = 70          ///< a fault of luxel itself
};

class Error : public std::runtime_error {
  public:
    Error(ErrorCode error_code, std::string error_where, std::string error_what, std::string error_hint = {})
        : std::runtime_error(error_where + ": " + error_what + (error_hint.empty() ? "" : "\n       " + error_hint)),
          code(error_code),
          where(std::move(error_where)),
          what_text(std::move(error_what)),
          hint(std::move(error_hint)) {}

    ErrorCode code;
    std::string where, what_text, hint;
};

/// Something the user should know that does not stop the work. `code` is a short stable word ("no-texture").
struct Warning {
    std::string code, where, text;
};

}  // namespace luxel
