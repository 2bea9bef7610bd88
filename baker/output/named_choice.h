/// Choices that users make by name, from a table of what each is. Threads: pure.
#pragma once
#include <string>

#include "formats/base/error.h"

namespace luxel {

/// The row of a table whose `name` is this. Throws Error{usage} naming `where`, with all names.
template <class Table>
const auto& row_named(const Table& table, const std::string& name, const std::string& where) {
    std::string names;
    for (const auto& row : table) {
        if (name == row.name) return row;
        names += std::string(names.empty() ? "" : ", ") + row.name;
    }
    throw Error(ErrorCode::usage, where, "expected one of " + names + ", found \"" + name + "\"");
}

}  // namespace luxel
