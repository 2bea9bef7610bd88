#include "baker/bake/parts.h"

#include <sstream>

#include "baker/output/named_choice.h"

namespace luxel {

const char* part_name(Part part) { return all_parts[static_cast<std::size_t>(part)].name; }

PartSet every_part() {
    PartSet all;
    for (const PartInfo& info : all_parts) all.add(info.part);
    return all;
}

std::string part_names(const PartSet& parts) {
    std::string names;
    for (const PartInfo& info : all_parts)
        if (parts.has(info.part)) names += std::string(names.empty() ? "" : ",") + info.name;
    return names.empty() ? "none" : names;
}

PartSet parse_parts(const std::string& list, const std::string& where) {
    PartSet parts;
    std::istringstream names(list);
    for (std::string name; std::getline(names, name, ',');) parts.add(row_named(all_parts, name, where).part);
    return parts;
}

}  // namespace luxel
