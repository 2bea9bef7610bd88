#include "baker/unwrap/atlas_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "formats/base/block_file.h"

namespace luxel {
namespace {

constexpr std::uint32_t atlas_version = 2;
enum Column : std::size_t { header_column, chart_column, triangle_column, uv_column, block_column, column_count };
constexpr std::size_t header_fields = 6, chart_fields = 9, block_fields = 8;

std::vector<std::uint32_t> chart_table(const std::vector<Chart>& charts) {
    std::vector<std::uint32_t> table;
    table.reserve(charts.size() * chart_fields);
    for (const Chart& c : charts)
        for (const std::uint32_t field : {c.object, c.ordinal, c.page, c.x, c.y, c.width, c.height, c.first, c.count})
            table.push_back(field);
    return table;
}

std::vector<Chart> charts_from(const std::vector<std::uint32_t>& table) {
    std::vector<Chart> charts;
    charts.reserve(table.size() / chart_fields);
    for (std::size_t i = 0; i + chart_fields <= table.size(); i += chart_fields)
        charts.push_back({table[i], table[i + 1], table[i + 2], table[i + 3], table[i + 4], table[i + 5], table[i + 6],
                          table[i + 7], table[i + 8]});
    return charts;
}

std::vector<std::uint32_t> block_table(const std::vector<CopyBlock>& blocks) {
    std::vector<std::uint32_t> table;
    table.reserve(blocks.size() * block_fields);
    for (const CopyBlock& b : blocks)
        for (const std::uint32_t field : {b.first_object, b.object_count, b.layout, b.page, b.x, b.y, b.width, b.height}) table.push_back(field);
    return table;
}

std::vector<CopyBlock> blocks_from(const std::vector<std::uint32_t>& table) {
    std::vector<CopyBlock> blocks;
    blocks.reserve(table.size() / block_fields);
    for (std::size_t i = 0; i + block_fields <= table.size(); i += block_fields)
        blocks.push_back({table[i], table[i + 1], table[i + 2], table[i + 3], table[i + 4], table[i + 5], table[i + 6],
                          table[i + 7]});
    return blocks;
}

class Checker {
  public:
    Checker(std::string file, const Scene& scene, Atlas& atlas)
        : file_(std::move(file)), scene_(scene), atlas_(atlas) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::damaged_store, file_, what, "remove the file and run the same command again");
    }
    /// Checks everything and fills triangle_chart on the way.
    void run() {
        if (!(atlas_.texels_per_metre > 0) || !std::isfinite(atlas_.texels_per_metre))
            fail(fmt::format("{} texels per metre", atlas_.texels_per_metre));
        // unwrap() gives no page without a chart: a larger number would only ask for memory.
        if (atlas_.page_size < smallest_page || atlas_.page_size > largest_page ||
            atlas_.page_count > atlas_.charts.size() || atlas_.padding > atlas_.page_size / 8)
            fail(fmt::format("{} pages of {} texels with padding {} for {} charts", atlas_.page_count, atlas_.page_size,
                             atlas_.padding, atlas_.charts.size()));
        atlas_.triangle_chart.assign(scene_.triangle_count(), none);
        std::uint64_t next = 0;
        for (std::uint32_t c = 0; c < atlas_.charts.size(); ++c) {
            const Chart& chart = atlas_.charts[c];
            check_order(c, chart);
            check_place(c, chart);
            if (chart.first != next || chart.count == 0 || chart.count > atlas_.chart_triangles.size() - next)
                fail(fmt::format("chart {}: triangles {} + {}, expected to start at {}", c, chart.first, chart.count,
                                 next));
            next += chart.count;
            for (std::uint32_t i = chart.first; i < chart.first + chart.count; ++i) check_triangle(c, chart, i);
        }
        if (next != atlas_.chart_triangles.size())
            fail(fmt::format("{} triangles belong to no chart", atlas_.chart_triangles.size() - next));
        check_blocks();
    }

  private:
    /// Charts are grouped by object, and those of an object are numbered: the number is part of patch ids.
    void check_order(std::uint32_t c, const Chart& chart) const {
        const Chart* const before = c > 0 ? &atlas_.charts[c - 1] : nullptr;
        const bool same_object = before && before->object == chart.object;
        if ((before && before->object > chart.object) || chart.ordinal != (same_object ? before->ordinal + 1 : 0))
            fail(fmt::format("chart {}: number {} of object {} is out of order", c, chart.ordinal, chart.object));
    }
    void check_place(std::uint32_t c, const Chart& chart) const {
        const std::uint64_t size = atlas_.page_size;
        if (chart.object >= scene_.objects.size()) fail(fmt::format("chart {}: object {}", c, chart.object));
        if (chart.page >= atlas_.page_count || chart.width == 0 || chart.height == 0 ||
            std::uint64_t{chart.x} + chart.width > size || std::uint64_t{chart.y} + chart.height > size)
            fail(fmt::format("chart {}: {} x {} texels at ({}, {}) of page {} do not fit", c, chart.width, chart.height,
                             chart.x, chart.y, chart.page));
    }
    void check_triangle(std::uint32_t c, const Chart& chart, std::uint32_t i) {
        const std::uint32_t t = atlas_.chart_triangles[i];
        if (t >= scene_.triangle_count() || scene_.triangle_object[t] != chart.object ||
            atlas_.triangle_chart[t] != none || (i > chart.first && t <= atlas_.chart_triangles[i - 1]))
            fail(fmt::format("chart {}: triangle {} is not one of object {}, is out of order, or appears twice", c, t,
                             chart.object));
        atlas_.triangle_chart[t] = c;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2f& uv = atlas_.corner_uv[std::size_t{3} * t + k];
            // Written so that not-a-number fails.
            if (!(uv.x >= 0 && uv.x <= static_cast<float>(chart.width) && uv.y >= 0 &&
                  uv.y <= static_cast<float>(chart.height)))
                fail(fmt::format("triangle {}: corner ({}, {}) is outside its chart of {} x {} texels", t, uv.x, uv.y,
                                 chart.width, chart.height));
        }
    }
    /// Charts are in order by now: one walk meets those of every block.
    void check_blocks() const {
        std::size_t chart = 0;
        std::uint32_t next_object = 0;
        std::map<std::uint32_t, std::pair<const CopyBlock*, std::size_t>> first_of;  // by layout: a block, and its first chart
        for (std::size_t b = 0; b < atlas_.copy_blocks.size(); ++b) {
            const CopyBlock& block = atlas_.copy_blocks[b];
            if (block.first_object < next_object || block.object_count == 0 || block.object_count > scene_.objects.size() ||
                block.first_object > scene_.objects.size() - block.object_count)
                fail(fmt::format("block {}: objects {} + {} are out of order or not there", b, block.first_object, block.object_count));
            next_object = block.first_object + block.object_count;
            if (scene_.objects[block.first_object].instance != scene_.objects[next_object - 1].instance)
                fail(fmt::format("block {}: objects {} + {} are not of one instance", b, block.first_object, block.object_count));
            while (chart < atlas_.charts.size() && atlas_.charts[chart].object < block.first_object) ++chart;
            const std::size_t first_chart = chart;
            for (; chart < atlas_.charts.size() && atlas_.charts[chart].object < next_object; ++chart) check_inside(b, block, chart);
            const auto [model, is_first] = first_of.try_emplace(block.layout, &block, first_chart);
            if (!is_first) check_layout(b, block, {first_chart, chart}, *model->second.first, model->second.second);
        }
    }
    void check_inside(std::size_t b, const CopyBlock& block, std::size_t c) const {
        const Chart& chart = atlas_.charts[c];
        const auto reaches = [](std::uint32_t at, std::uint32_t size) { return std::uint64_t{at} + size; };
        if (chart.page != block.page || chart.x < block.x || chart.y < block.y ||
            reaches(chart.x, chart.width) > reaches(block.x, block.width) || reaches(chart.y, chart.height) > reaches(block.y, block.height) ||
            reaches(block.x, block.width) > atlas_.page_size || reaches(block.y, block.height) > atlas_.page_size)
            fail(fmt::format("block {}: chart {} is not inside of it, or it is not inside of its page", b, c));
    }
    /// `charts`: first and end of the block's.
    void check_layout(std::size_t b, const CopyBlock& block, std::pair<std::size_t, std::size_t> charts, const CopyBlock& model, std::size_t model_chart) const {
        bool is_same = block.width == model.width && block.height == model.height && block.object_count == model.object_count &&
                       charts.second - charts.first <= atlas_.charts.size() - model_chart;
        for (std::size_t c = charts.first; is_same && c < charts.second; ++c, ++model_chart) {
            const Chart &own = atlas_.charts[c], &other = atlas_.charts[model_chart];
            is_same = own.object - block.first_object == other.object - model.first_object && own.ordinal == other.ordinal && own.count == other.count &&
                      own.width == other.width && own.height == other.height && own.x - block.x == other.x - model.x && own.y - block.y == other.y - model.y;
        }
        if (!is_same) fail(fmt::format("block {}: its charts are not those of layout {}", b, block.layout));
    }
    std::string file_;
    const Scene& scene_;
    Atlas& atlas_;
};

}  // namespace

void save_atlas(const std::filesystem::path& path, const Key& key, const Atlas& atlas) {
    BlockFileWriter file(path, FileKind::atlas, atlas_version, key);
    const std::array<std::uint32_t, header_fields> header{std::bit_cast<std::uint32_t>(atlas.texels_per_metre),
                                                          atlas.page_size,
                                                          atlas.page_count,
                                                          atlas.padding,
                                                          static_cast<std::uint32_t>(atlas.charts.size()),
                                                          static_cast<std::uint32_t>(atlas.chart_triangles.size())};
    std::vector<float> corner_uv;
    corner_uv.reserve(atlas.corner_uv.size() * 2);
    for (const Vec2f& uv : atlas.corner_uv) corner_uv.insert(corner_uv.end(), {uv.x, uv.y});
    const std::vector<std::uint32_t> charts = chart_table(atlas.charts);
    append_column<std::uint32_t>(file, header_column, header);
    append_column<std::uint32_t>(file, chart_column, charts);
    append_column<std::uint32_t>(file, triangle_column, atlas.chart_triangles);
    append_column<float>(file, uv_column, corner_uv);
    append_column<std::uint32_t>(file, block_column, block_table(atlas.copy_blocks));
    file.publish();
}

Atlas load_atlas(const std::filesystem::path& path, const Key& key, const Scene& scene) {
    const BlockFileReader file(path, FileKind::atlas, atlas_version, &key);
    Atlas atlas;
    Checker checker(file.name(), scene, atlas);
    require_numbered_blocks(file, column_count);
    const auto header = read_column<std::uint32_t>(file, header_column);
    if (header.size() != header_fields) checker.fail("the header has the wrong size");
    atlas.texels_per_metre = std::bit_cast<float>(header[0]);
    atlas.page_size = header[1];
    atlas.page_count = header[2];
    atlas.padding = header[3];
    const auto charts = read_column<std::uint32_t>(file, chart_column);
    atlas.chart_triangles = read_column<std::uint32_t>(file, triangle_column);
    const auto corner_uv = read_column<float>(file, uv_column);
    const auto blocks = read_column<std::uint32_t>(file, block_column);
    if (blocks.size() % block_fields) checker.fail("the table of blocks has the wrong size");
    if (charts.size() != header[4] * chart_fields || atlas.chart_triangles.size() != header[5] ||
        header[5] != scene.triangle_count() || corner_uv.size() != std::size_t{6} * header[5])
        checker.fail(
            fmt::format("columns of {} charts and {} triangles do not have these sizes, or the scene has {} triangles",
                        header[4], header[5], scene.triangle_count()));
    atlas.charts = charts_from(charts);
    atlas.copy_blocks = blocks_from(blocks);
    atlas.corner_uv.reserve(corner_uv.size() / 2);
    for (std::size_t i = 0; i + 2 <= corner_uv.size(); i += 2)
        atlas.corner_uv.emplace_back(corner_uv[i], corner_uv[i + 1]);
    checker.run();
    return atlas;
}

}  // namespace luxel
