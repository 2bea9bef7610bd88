#include "baker/patches/patch_set.h"

#include <algorithm>

#include "baker/core/sobol.h"
#include "formats/base/error.h"

namespace luxel {

std::uint64_t PatchSet::resident_bytes() const {
    std::uint64_t bytes = patches.capacity() * sizeof(Patch) + fragment_begin.capacity() * sizeof(std::uint32_t) +
                          fragments.capacity() * sizeof(Fragment);
    for (const auto& page : page_patch) bytes += page.capacity() * sizeof(PatchNumber);
    bytes += parted.resident_bytes() + contacts.resident_bytes();
    return bytes;
}

void renumber(PatchSet& set, std::span<const PatchNumber> new_number) {
    const std::size_t count = set.count();
    std::vector<PatchNumber> old_number(count, no_patch);
    bool permutation = new_number.size() == count;
    for (PatchNumber p = 0; permutation && p < count; ++p) {
        permutation = new_number[p] < count && old_number[new_number[p]] == no_patch;
        if (permutation) old_number[new_number[p]] = p;
    }
    if (!permutation) throw Error(ErrorCode::internal, "renumber", "the new numbers are not a permutation");
    PatchSet result;
    result.page_size = set.page_size;
    result.patches.reserve(count);
    result.fragments.reserve(set.fragments.size());
    result.fragment_begin.reserve(count + 1);
    result.fragment_begin.push_back(0);
    for (const PatchNumber old : old_number) {
        Patch patch = set.patches[old];
        if (patch.other_side != no_patch) patch.other_side = new_number[patch.other_side];
        result.patches.push_back(patch);
        const auto fragments = set.fragments_of(old);
        result.fragments.insert(result.fragments.end(), fragments.begin(), fragments.end());
        result.fragment_begin.push_back(static_cast<std::uint32_t>(result.fragments.size()));
    }
    result.parted = std::move(set.parted);
    result.contacts = std::move(set.contacts);
    result.page_patch = std::move(set.page_patch);
    for (auto& page : result.page_patch)
        for (PatchNumber& number : page)
            if (number != no_patch) number = new_number[number];
    set = std::move(result);
}

PatchId back_id(PatchId front) { return mix(front, 1); }

PatchSet add_back_sides(PatchSet set, const std::vector<bool>& open) {
    const auto fronts = static_cast<PatchNumber>(set.count());
    if (open.size() != fronts) throw Error(ErrorCode::internal, "back sides", "one entry per patch expected");
    for (PatchNumber p = 0; p < fronts; ++p) {
        if (set.patches[p].is_back) throw Error(ErrorCode::internal, "back sides", "the set has backs already");
        if (!open[p]) continue;
        Patch back = set.patches[p];
        back.id = back_id(back.id);
        back.normal = -back.normal;
        back.is_back = true;
        back.other_side = p;
        set.patches[p].other_side = static_cast<PatchNumber>(set.patches.size());
        set.patches.push_back(back);
        for (std::uint32_t f = set.fragment_begin[p]; f < set.fragment_begin[p + 1]; ++f) {
            const Fragment fragment = set.fragments[f];
            set.fragments.push_back(fragment);
        }
        set.fragment_begin.push_back(static_cast<std::uint32_t>(set.fragments.size()));
    }
    check_ids(set);
    return set;
}

void check_ids(const PatchSet& set) {
    std::vector<PatchId> ids;
    ids.reserve(set.count());
    for (const Patch& patch : set.patches) ids.push_back(patch.id);
    std::sort(ids.begin(), ids.end());
    const auto twice = std::adjacent_find(ids.begin(), ids.end());
    if (twice != ids.end())
        throw Error(ErrorCode::internal, "patches", "id " + std::to_string(*twice) + " appears twice",
                    "two objects of the scene have the same path and content");
}

}  // namespace luxel
