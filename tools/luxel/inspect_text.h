/// What `luxel inspect` and `luxel bake --verify` found, as text for people and as JSON (docs/inspect.md is its schema).
#pragma once
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "baker/bake/verify.h"

namespace luxel {

/// Everything that was found out about a folder.
struct InspectReport {
    FolderListing listing;
    std::optional<MatrixInspection> matrix;
    std::optional<Verification> verify;
};

std::string inspect_text(const InspectReport& report);
std::string inspect_json(const InspectReport& report);

/// The member `verify` of both JSON files.
nlohmann::ordered_json verify_json(const Verification& verify);
/// One line per finding as `luxel: error: where: what` with its hint, to standard error.
void print_findings(const Verification& verify);

}  // namespace luxel
