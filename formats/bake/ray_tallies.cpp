#include "formats/bake/ray_tallies.h"

#include <array>
#include <string>

namespace luxel {
namespace {

constexpr std::array columns{&RayTallies::rays, &RayTallies::self, &RayTallies::open, &RayTallies::back};

[[noreturn]] void damaged(const BlockFileReader& file, const std::string& what) {
    throw Error(ErrorCode::damaged_store, file.name(), what, "remove the file and run the same command again");
}

}  // namespace

void RayTallies::append(const RayTallies& further) {
    for (const auto column : columns)
        (this->*column).insert((this->*column).end(), (further.*column).begin(), (further.*column).end());
}

RayTallies RayTallies::part(std::size_t begin, std::size_t end) const {
    RayTallies found;
    for (const auto column : columns)
        (found.*column)
            .assign((this->*column).begin() + static_cast<std::ptrdiff_t>(begin),
                    (this->*column).begin() + static_cast<std::ptrdiff_t>(end));
    return found;
}

void append_tallies(BlockFileWriter& file, const RayTallies& tallies) {
    for (std::size_t k = 0; k < columns.size(); ++k) append_column<std::uint32_t>(file, k, tallies.*columns[k]);
}

RayTallies load_tallies(const BlockFileReader& file) {
    RayTallies tallies;
    for (std::size_t k = 0; k < columns.size(); ++k) tallies.*columns[k] = read_column<std::uint32_t>(file, k);
    for (const auto column : columns)
        if ((tallies.*column).size() != tallies.rays.size()) damaged(file, "tally columns differ in length");
    for (std::size_t p = 0; p < tallies.rays.size(); ++p)
        if (std::uint64_t{tallies.self[p]} + tallies.open[p] + tallies.back[p] > tallies.rays[p])
            damaged(file, "patch " + std::to_string(p) + " of the file: more rays have ended than were sent");
    return tallies;
}

}  // namespace luxel
