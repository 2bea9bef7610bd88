#include "baker/patches/patch_build.h"

#include <algorithm>
#include <bit>

#include "baker/core/parallel.h"
#include "baker/core/sobol.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/patches/patch_set.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

/// Texels of one chart as a small image of its own, and the patches that they fall into.
class ChartPatches {
  public:
    /// `texel_at` is the page's image of texel numbers (none: free).
    ChartPatches(const Chart& chart, const PageTexels& page, const std::vector<std::uint32_t>& texel_at,
                 std::uint32_t page_size, std::uint32_t k)
        : chart_(chart), page_(page), texel_at_(texel_at), page_size_(page_size), k_(k) {}

    struct Found {
        std::uint32_t cell_x, cell_y, set;
        std::vector<std::uint32_t> texels;  ///< numbers on the page, raster order
    };

    std::vector<Found> find() {
        std::vector<Found> found;
        for (std::uint32_t cell_y = 0; cell_y * k_ < chart_.height; ++cell_y)
            for (std::uint32_t cell_x = 0; cell_x * k_ < chart_.width; ++cell_x) split_cell(cell_x, cell_y, found);
        if (!slivers_.empty()) join_slivers(found);
        return found;
    }

  private:
    [[nodiscard]] std::uint32_t texel(std::uint32_t x, std::uint32_t y) const {
        return texel_at_[std::size_t{chart_.y + y} * page_size_ + chart_.x + x];
    }

    /// 4-connected sets of covered texels that nothing parts, in raster order of their first texels. The flag of a joint is with the
    /// texel on its left or above, which has the lower number.
    void split_cell(std::uint32_t cell_x, std::uint32_t cell_y, std::vector<Found>& found) {
        const std::uint32_t x0 = cell_x * k_, y0 = cell_y * k_;
        const std::uint32_t w = std::min(k_, chart_.width - x0), h = std::min(k_, chart_.height - y0);
        seen_.assign(std::size_t{w} * h, 0);
        std::uint32_t set = 0;
        for (std::uint32_t start = 0; start < w * h; ++start) {
            if (seen_[start] || texel(x0 + start % w, y0 + start / w) == none) continue;
            stack_.assign(1, start);
            seen_[start] = 1;
            members_.clear();
            while (!stack_.empty()) {
                const std::uint32_t at = stack_.back(), x = at % w, y = at / w;
                stack_.pop_back();
                members_.push_back(at);
                const auto visit = [&](std::uint32_t next, bool Texel::*joined) {
                    const std::uint32_t here = texel(x0 + x, y0 + y), there = texel(x0 + next % w, y0 + next / w);
                    if (seen_[next] || there == none || !(page_.texels[std::min(here, there)].*joined)) return;
                    seen_[next] = 1;
                    stack_.push_back(next);
                };
                if (x) visit(at - 1, &Texel::joined_right);
                if (x + 1 < w) visit(at + 1, &Texel::joined_right);
                if (y) visit(at - w, &Texel::joined_down);
                if (y + 1 < h) visit(at + w, &Texel::joined_down);
            }
            std::sort(members_.begin(), members_.end());
            Found& patch = found.emplace_back(Found{cell_x, cell_y, set++, {}});
            for (const std::uint32_t at : members_) patch.texels.push_back(texel(x0 + at % w, y0 + at / w));
            // Inside a solid but for slivers at most: no patch. Its number stays taken, so that other patches keep their names.
            if (can_send(patch)) continue;
            for (const std::uint32_t t : patch.texels)
                if (page_.texels[t].visible_m2 > 0) slivers_.push_back(t);
            found.pop_back();
        }
    }

    [[nodiscard]] bool can_send(const Found& patch) const {
        return std::any_of(patch.texels.begin(), patch.texels.end(),
                           [&](std::uint32_t t) { return page_.can_send(page_.texels[t]); });
    }

    /// Texels that are seen but cannot send, in sets of such: each joins the patch that is nearest over the chart's surface,
    /// so that light which falls on them is not lost.
    void join_slivers(std::vector<Found>& found) {
        std::vector<std::uint32_t> owner(std::size_t{chart_.width} * chart_.height, none);
        std::vector<std::uint32_t> reached;
        const auto place = [&](std::uint32_t t) {
            return (page_.texels[t].y - chart_.y) * chart_.width + page_.texels[t].x - chart_.x;
        };
        for (std::uint32_t p = 0; p < found.size(); ++p)
            for (const std::uint32_t t : found[p].texels) owner[place(t)] = p, reached.push_back(place(t));
        // Breadth first from all patches at once: the first to come is the nearest.
        for (std::size_t k = 0; k < reached.size(); ++k) {
            const std::uint32_t at = reached[k], x = at % chart_.width, y = at / chart_.width;
            const auto visit = [&](std::uint32_t there) {
                if (owner[there] != none || texel(there % chart_.width, there / chart_.width) == none) return;
                owner[there] = owner[at];
                reached.push_back(there);
            };
            if (x) visit(at - 1);
            if (x + 1 < chart_.width) visit(at + 1);
            if (y) visit(at - chart_.width);
            if (y + 1 < chart_.height) visit(at + chart_.width);
        }
        for (const std::uint32_t t : slivers_)
            if (const std::uint32_t p = owner[place(t)]; p != none) found[p].texels.push_back(t);
        for (Found& patch : found) std::sort(patch.texels.begin(), patch.texels.end());
    }

    const Chart& chart_;
    const PageTexels& page_;
    const std::vector<std::uint32_t>& texel_at_;
    std::uint32_t page_size_, k_;
    std::vector<std::uint8_t> seen_;
    std::vector<std::uint32_t> stack_, members_;
    std::vector<std::uint32_t> slivers_;  ///< texels of sets without a patch that are visible in part
};

/// Means over the visible area of the texels of one patch.
Patch mean_patch(const Scene& scene, const Atlas& atlas, const PageTexels& page,
                 const std::vector<std::uint32_t>& texels) {
    double area = 0, largest = 0;
    Vec3d center(0), normal(0), largest_normal(0), reflectance(0), emission(0);
    for (const std::uint32_t t : texels) {
        const Texel& texel = page.texels[t];
        const double texel_area = texel.visible_m2;
        area += texel_area;
        reflectance += to_double(texel.reflectance) * texel_area;
        emission += to_double(texel.emission) * texel_area;
        for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
            const Fragment& fragment = page.fragments[f];
            const double weight = fragment.visible_m2();
            if (weight <= 0) continue;
            const Vec2f middle = fragment_polygon(scene, atlas, fragment).centroid();
            center += to_double(surface_position(scene, fragment.triangle, middle)) * weight;
            const Vec3d facing = scene.area_vector(fragment.triangle).normalized();
            normal += facing * weight;
            if (weight > largest) largest = weight, largest_normal = facing;
        }
    }
    Patch patch;
    patch.area_m2 = static_cast<float>(area);
    patch.center = to_float(center / area);
    // A patch that goes all the way around has no mean direction: take its largest part's.
    patch.normal = to_float(normal.length() > 1e-6 * area ? normal.normalized() : largest_normal);
    patch.reflectance = to_float(reflectance / area);
    patch.emission = to_float(emission / area);
    return patch;
}

/// Per page: number of the texel at each square, none where free.
std::vector<std::vector<std::uint32_t>> texel_images(const TexelSet& texels) {
    std::vector<std::vector<std::uint32_t>> images(texels.pages.size());
    parallel_for(images.size(), 1, [&](std::size_t page) {
        images[page].assign(std::size_t{texels.page_size} * texels.page_size, none);
        const auto& list = texels.pages[page].texels;
        for (std::uint32_t t = 0; t < list.size(); ++t)
            images[page][std::size_t{list[t].y} * texels.page_size + list[t].x] = t;
    });
    return images;
}

/// The fragments of a texel that rays of its patch may start on, and where on them.
std::vector<Fragment> starting_fragments(const Scene& scene, const Atlas& atlas, const PageTexels& page, const Texel& texel) {
    std::vector<Fragment> all, own;
    for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
        if (page.fragments[f].visible == none_visible) continue;
        all.push_back(page.fragments[f]);
        if (texel.own_side == all_visible) continue;
        own.push_back(page.fragments[f]);
        own.back().visible = cells_on_own_side(scene, atlas, texel, own.back());
        if (own.back().visible == none_visible) own.pop_back();
    }
    return own.empty() ? all : own;
}

/// Writes patch `number` and its fragments at their places, which are known beforehand.
void write_patch(const Scene& scene, const Atlas& atlas, const PageTexels& page, const ChartPatches::Found& found, PatchNumber number,
                 std::uint32_t fragment_at, std::vector<PatchNumber>& image, PatchSet& set) {
    for (const std::uint32_t t : found.texels) {
        const Texel& texel = page.texels[t];
        image[std::size_t{texel.y} * set.page_size + texel.x] = number;
        for (const Fragment& fragment : starting_fragments(scene, atlas, page, texel)) set.fragments[fragment_at++] = fragment;
    }
}

}  // namespace

PatchId patch_id(const Object& object, const Chart& chart, float texels_per_metre, std::uint32_t patch_texels,
                 std::uint32_t cell_x, std::uint32_t cell_y, std::uint32_t set, bool is_back, std::uint32_t level) {
    std::uint64_t id = mix(object.path_hash, object.content_hash);
    id = mix(id, chart.ordinal);
    id = mix(id, (std::uint64_t{std::bit_cast<std::uint32_t>(texels_per_metre)} << 32) | patch_texels);
    id = mix(id, (std::uint64_t{cell_x} << 32) | cell_y);
    id = mix(id, (std::uint64_t{set} << 32) | level);
    return is_back ? back_id(id) : id;
}

PatchSet build_patches(const Scene& scene, const Atlas& atlas, const TexelSet& texels, const PatchOptions& options) {
    if (options.patch_texels < 1 || options.patch_texels > 256)
        throw Error(ErrorCode::usage, "patches", "cells of " + std::to_string(options.patch_texels) + " texels",
                    "give 1 to 256 texels");
    const auto texel_at = texel_images(texels);
    std::vector<std::vector<ChartPatches::Found>> found(atlas.charts.size());
    parallel_for(found.size(), 16, [&](std::size_t c) {
        const Chart& chart = atlas.charts[c];
        found[c] = ChartPatches(chart, texels.pages[chart.page], texel_at[chart.page], texels.page_size, options.patch_texels)
                       .find();
    });
    PatchSet set;
    set.page_size = texels.page_size;
    set.parted = PartedTexels(texels);
    set.contacts = ContactTexels(texels);
    set.page_patch.resize(texels.pages.size());
    for (auto& image : set.page_patch) image.assign(std::size_t{texels.page_size} * texels.page_size, no_patch);
    std::vector<PatchNumber> first_patch(found.size());
    set.fragment_begin.push_back(0);
    for (std::size_t c = 0; c < found.size(); ++c) {
        first_patch[c] = static_cast<PatchNumber>(set.fragment_begin.size() - 1);
        const PageTexels& page = texels.pages[atlas.charts[c].page];
        for (const auto& patch : found[c]) {
            std::uint32_t fragments = 0;
            for (const std::uint32_t t : patch.texels)
                fragments += static_cast<std::uint32_t>(starting_fragments(scene, atlas, page, page.texels[t]).size());
            set.fragment_begin.push_back(set.fragment_begin.back() + fragments);
        }
    }
    set.patches.resize(set.fragment_begin.size() - 1);
    set.fragments.resize(set.fragment_begin.back());
    parallel_for(found.size(), 16, [&](std::size_t c) {
        const Chart& chart = atlas.charts[c];
        const PageTexels& page = texels.pages[chart.page];
        for (std::size_t i = 0; i < found[c].size(); ++i) {
            const auto& source = found[c][i];
            const auto number = static_cast<PatchNumber>(first_patch[c] + i);
            Patch& patch = set.patches[number] = mean_patch(scene, atlas, page, source.texels);
            patch.chart = static_cast<std::uint32_t>(c);
            patch.id = patch_id(scene.objects[chart.object], chart, scene.objects[chart.object].density(atlas.texels_per_metre), options.patch_texels,
                                source.cell_x, source.cell_y, source.set, false, 0);
            write_patch(scene, atlas, page, source, number, set.fragment_begin[number], set.page_patch[chart.page], set);
        }
    });
    check_ids(set);
    return set;
}

}  // namespace luxel
