#include "baker/unwrap/place_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "baker/unwrap/pack.h"

namespace luxel {
namespace {

struct ChartRun {
    std::size_t first = 0, count = 0;
};

/// Charts follow each other by object.
ChartRun charts_of(const Atlas& atlas, const ObjectRun& objects) {
    const auto by_object = [](const Chart& chart, std::uint32_t object) { return chart.object < object; };
    const auto begin = std::lower_bound(atlas.charts.begin(), atlas.charts.end(), objects.first, by_object);
    const auto end = std::lower_bound(begin, atlas.charts.end(), objects.first + objects.count, by_object);
    return {static_cast<std::size_t>(begin - atlas.charts.begin()), static_cast<std::size_t>(end - begin)};
}

/// The charts of a group's first instance beside each other.
struct Arrangement {
    PackedRectangle whole;                ///< width 0: they do not fit
    std::vector<PackedRectangle> charts;
};

Arrangement arrange(const Atlas& atlas, const ObjectRun& objects) {
    const ChartRun run = charts_of(atlas, objects);
    Arrangement arrangement;
    for (std::size_t c = run.first; c < run.first + run.count; ++c) arrangement.charts.push_back({atlas.charts[c].width, atlas.charts[c].height});
    arrangement.whole = pack_tightly(arrangement.charts, atlas.page_size - 2 * atlas.padding, atlas.padding);
    return arrangement;
}

/// Every block and every free chart, in the order of charts.
struct Item {
    std::size_t first_chart = 0, count = 1;
    const Arrangement* arrangement = nullptr;  ///< of a block; nullptr: a free chart
    ObjectRun objects;
    std::uint32_t layout = 0;  ///< number of the arrangement
};

std::vector<Item> list_items(const Atlas& atlas, std::vector<Item> blocks) {
    std::sort(blocks.begin(), blocks.end(), [](const Item& a, const Item& b) { return a.first_chart < b.first_chart; });
    std::vector<Item> items;
    std::size_t next = 0;
    for (const Item& block : blocks) {
        for (; next < block.first_chart; ++next) items.push_back({next, 1, nullptr, {}, 0});
        items.push_back(block);
        next += block.count;
    }
    for (; next < atlas.charts.size(); ++next) items.push_back({next, 1, nullptr, {}, 0});
    return items;
}

void warn_of_size(const Scene& scene, const CopyGroup& group, const Atlas& atlas, std::vector<Warning>& warnings) {
    const Object& object = scene.objects[group.instances[0].first];
    warnings.push_back({"copies-without-block", object.name,
                        fmt::format("its charts do not fit on one page of {} texels together: all {} instances get geometry of their own", atlas.page_size,
                                    group.instances.size())});
}

/// On pages behind those that there are.
void place_items(const std::vector<Item>& items, Atlas& atlas) {
    std::vector<PackedRectangle> rectangles;
    for (const Item& item : items)
        rectangles.push_back(item.arrangement ? PackedRectangle{item.arrangement->whole.width, item.arrangement->whole.height}
                                              : PackedRectangle{atlas.charts[item.first_chart].width, atlas.charts[item.first_chart].height});
    const std::uint32_t first_page = atlas.page_count;
    atlas.page_count += pack_pages(rectangles, atlas.page_size, atlas.padding);
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Item& item = items[i];
        const PackedRectangle& place = rectangles[i];
        for (std::size_t c = 0; c < item.count; ++c) {
            Chart& chart = atlas.charts[item.first_chart + c];
            chart.page = first_page + place.page;
            chart.x = place.x + (item.arrangement ? item.arrangement->charts[c].x : 0);
            chart.y = place.y + (item.arrangement ? item.arrangement->charts[c].y : 0);
        }
        if (item.arrangement)
            atlas.copy_blocks.push_back({item.objects.first, item.objects.count, item.layout, first_page + place.page, place.x, place.y, place.width, place.height});
    }
}

}  // namespace

void place_charts(const Scene& scene, const std::vector<CopyGroup>& groups, Atlas& atlas, std::vector<Warning>& warnings) {
    std::vector<Arrangement> arrangements;
    arrangements.reserve(groups.size());
    std::vector<Item> blocks;
    for (const CopyGroup& group : groups) {
        const Arrangement& arrangement = arrangements.emplace_back(arrange(atlas, group.instances[0]));
        if (arrangement.whole.width == 0) {
            warn_of_size(scene, group, atlas, warnings);
            continue;
        }
        for (const ObjectRun& objects : group.instances) {
            const ChartRun run = charts_of(atlas, objects);
            if (run.count != arrangement.charts.size())
                throw Error(ErrorCode::internal, scene.objects[objects.first].name,
                            fmt::format("{} charts in a layout of {}", run.count, arrangement.charts.size()));
            blocks.push_back({run.first, run.count, &arrangement, objects, static_cast<std::uint32_t>(arrangements.size() - 1)});
        }
    }
    const std::vector<Item> items = list_items(atlas, std::move(blocks));
    const auto has_lightmap = [&](const Item& item) { return scene.objects[atlas.charts[item.first_chart].object].has_lightmap; };
    for (const bool shown : {true, false}) {
        std::vector<Item> part;
        std::ranges::copy_if(items, std::back_inserter(part), [&](const Item& item) { return has_lightmap(item) == shown; });
        place_items(part, atlas);
    }
}

}  // namespace luxel
