#include "baker/light/interpolate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "baker/core/parallel.h"
#include "baker/light/cell_values.h"

namespace luxel {
namespace {

constexpr std::size_t taps = 2 * window_reach + 1;

double hat(double distance) { return std::max(0.0, 1 - distance); }

double cubic_bspline(double d) {
    if (d < 1) return (4 - 6 * d * d + 3 * d * d * d) / 6;
    return d < 2 ? (2 - d) * (2 - d) * (2 - d) / 6 : 0;
}

double catmull_rom(double d) {
    if (d < 1) return 1 + d * d * (1.5 * d - 2.5);
    return d < 2 ? 2 + d * (-4 + d * (2.5 - 0.5 * d)) : 0;
}

/// Weights along one axis of the cells -window_reach .. window_reach from a texel's own.
using Weights = std::array<double, taps>;

/// Per place of a texel in its cell.
std::vector<Weights> weight_table(double (*kernel)(double), std::uint32_t cell_texels) {
    std::vector<Weights> table(cell_texels);
    for (std::uint32_t place = 0; place < cell_texels; ++place) {
        const double from_middle = (place + 0.5) / cell_texels - 0.5;
        for (std::size_t tap = 0; tap < taps; ++tap)
            table[place][tap] = kernel(std::abs(from_middle - (static_cast<double>(tap) - window_reach)));
    }
    return table;
}

Rgb to_light(const Vec3d& sum) {
    constexpr double most = std::numeric_limits<float>::max();
    return {static_cast<float>(std::clamp(sum.x, 0.0, most)), static_cast<float>(std::clamp(sum.y, 0.0, most)),
            static_cast<float>(std::clamp(sum.z, 0.0, most))};
}

Rgb weigh(const CellValues& cells, const Weights& along_x, const Weights& along_y) {
    Vec3d sum(0, 0, 0);
    for (std::size_t y = 0; y < taps; ++y) {
        if (along_y[y] == 0) continue;
        Vec3d row(0, 0, 0);
        for (std::size_t x = 0; x < taps; ++x)
            if (along_x[x] != 0)
                row += cells.at(static_cast<int>(x) - window_reach, static_cast<int>(y) - window_reach) * along_x[x];
        sum += row * along_y[y];
    }
    return to_light(sum);
}

/// Mean of the patches that share a corner of the middle cell, on the side (dx, dy): each -1 or 1.
Vec3d corner_mean(const CellWindow& window, std::span<const Rgb> values, int dx, int dy) {
    Vec3d sum(0, 0, 0);
    int count = 0;
    for (const PatchNumber patch : {window.own(), window.at(dx, 0), window.at(0, dy), window.at(dx, dy)})
        if (patch != no_patch) sum += to_double(values[patch]), ++count;
    return sum / count;
}

/// Everything that the texels of one patch share.
class PatchSpread {
  public:
    PatchSpread(std::span<const Rgb> values, const std::vector<CellLinks>& links, Interpolation interpolation,
                std::uint32_t cell_texels)
        : values_(values), links_(links), interpolation_(interpolation), cell_texels_(cell_texels) {
        if (interpolation == Interpolation::linear) table_ = weight_table(hat, cell_texels);
        if (interpolation == Interpolation::cubic_bspline) table_ = weight_table(cubic_bspline, cell_texels);
        if (interpolation == Interpolation::catmull_rom) table_ = weight_table(catmull_rom, cell_texels);
    }

    /// For the next calls of value().
    struct Around {
        PatchNumber patch = no_patch;
        CellValues cells;              ///< of kernels
        std::array<Vec3d, 4> corners;  ///< Interpolation::corners: (-1, -1), (1, -1), (-1, 1), (1, 1)
    };
    [[nodiscard]] Around around(PatchNumber patch) const {
        const bool is_cubic =
            interpolation_ == Interpolation::cubic_bspline || interpolation_ == Interpolation::catmull_rom;
        const int reach = is_cubic ? 2 : 1;
        const CellWindow window(links_, patch, reach);
        Around result{patch, {}, {}};
        if (interpolation_ != Interpolation::corners)
            result.cells = CellValues(window, values_, reach);
        else
            for (int k = 0; k < 4; ++k)
                result.corners[static_cast<std::size_t>(k)] =
                    corner_mean(window, values_, k % 2 ? 1 : -1, k / 2 ? 1 : -1);
        return result;
    }

    /// At texel (x, y) of the patch's cell.
    [[nodiscard]] Rgb value(const Around& around, std::uint32_t x, std::uint32_t y) const {
        if (interpolation_ != Interpolation::corners) return weigh(around.cells, table_[x], table_[y]);
        const double u = (x + 0.5) / cell_texels_, v = (y + 0.5) / cell_texels_;
        const auto& c = around.corners;
        return to_light((c[0] * (1 - u) + c[1] * u) * (1 - v) + (c[2] * (1 - u) + c[3] * u) * v);
    }

  private:
    std::span<const Rgb> values_;
    const std::vector<CellLinks>& links_;
    Interpolation interpolation_;
    std::uint32_t cell_texels_;
    std::vector<Weights> table_;
};

}  // namespace

const char* interpolation_name(Interpolation interpolation) {
    switch (interpolation) {
        case Interpolation::constant:
            return "constant";
        case Interpolation::linear:
            return "linear";
        case Interpolation::cubic_bspline:
            return "cubic-bspline";
        case Interpolation::catmull_rom:
            return "catmull-rom";
        case Interpolation::corners:
            return "corners";
    }
    return "";
}

std::optional<Interpolation> interpolation_of(std::string_view name) {
    for (const Interpolation interpolation : all_interpolations)
        if (name == interpolation_name(interpolation)) return interpolation;
    return {};
}

std::vector<Rgb> interpolate_page(const Atlas& atlas, const TexelSet& texels, const PatchSet& patches,
                                  std::span<const Rgb> patch_irradiance, std::uint32_t page, std::uint32_t patch_texels,
                                  Interpolation interpolation) {
    const PageTexels& content = texels.pages[page];
    const auto patch_at = [&](const Texel& texel) {
        return patches.page_patch[page][std::size_t{texel.y} * patches.page_size + texel.x];
    };
    std::vector<Rgb> result(content.texels.size(), Rgb(0, 0, 0));
    if (interpolation == Interpolation::constant) {
        parallel_for(result.size(), 4096, [&](std::size_t k) {
            if (content.can_send(content.texels[k])) result[k] = patch_irradiance[patch_at(content.texels[k])];
        });
        return result;
    }
    const std::vector<CellLinks> links = link_cells(atlas, content, patches, page, patch_texels);
    const PatchSpread spread(patch_irradiance, links, interpolation, patch_texels);
    parallel_ranges(result.size(), 4096, [&](std::size_t, std::size_t begin, std::size_t end) {
        PatchSpread::Around around;
        for (std::size_t k = begin; k < end; ++k) {
            const Texel& texel = content.texels[k];
            if (!content.can_send(texel)) continue;
            // Texels of a patch come in runs.
            if (const PatchNumber patch = patch_at(texel); patch != around.patch) around = spread.around(patch);
            const Chart& chart = atlas.charts[texel.chart];
            result[k] = spread.value(around, (texel.x - chart.x) % patch_texels, (texel.y - chart.y) % patch_texels);
        }
    });
    return result;
}

}  // namespace luxel
