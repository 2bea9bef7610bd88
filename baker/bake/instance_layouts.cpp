#include "baker/bake/instance_layouts.h"

#include <map>
#include <tuple>

namespace luxel {
namespace {

/// Corner k of a triangle as a share of the block's sides.
Vec2f in_block(const Atlas& atlas, std::uint32_t triangle, int k, const CopyBlock& block) {
    const Chart& chart = atlas.charts[atlas.triangle_chart[triangle]];
    const Vec2f& local = atlas.corner_uv[std::size_t{3} * triangle + static_cast<std::size_t>(k)];
    return {(local.x + static_cast<float>(chart.x - block.x)) / static_cast<float>(block.width),
            (local.y + static_cast<float>(chart.y - block.y)) / static_cast<float>(block.height)};
}

/// Per instance of the record: its objects, and its block or nullptr.
struct Placed {
    std::vector<std::uint32_t> objects;
    const CopyBlock* block = nullptr;
};

std::vector<Placed> placed_instances(const BakedGeometry& g) {
    std::vector<Placed> placed(g.record.instances.size());
    for (std::uint32_t o = 0; o < g.scene.objects.size(); ++o) placed[g.scene.objects[o].instance].objects.push_back(o);
    for (const CopyBlock& block : g.atlas.copy_blocks) placed[g.scene.objects[block.first_object].instance].block = &block;
    return placed;
}

void fill_primitive(const BakedGeometry& g, const Object& object, const CopyBlock& block, PrimitiveLayout& primitive) {
    for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
        const std::uint32_t source = g.scene.source_triangle[t];
        primitive.triangle_page[source] = g.atlas.charts[g.atlas.triangle_chart[t]].page;
        for (int k = 0; k < 3; ++k) {
            // Mirrored instances had corners 1 and 2 swapped when the scene was built.
            const int file_corner = object.mirrored && k > 0 ? 3 - k : k;
            primitive.corner_uv[std::size_t{3} * source + static_cast<std::size_t>(file_corner)] = in_block(g.atlas, t, k, block);
        }
    }
}

std::shared_ptr<const MeshLayout> mesh_layout(const BakedGeometry& g, const MeshRecord& mesh, const std::vector<std::uint32_t>& objects,
                                              const CopyBlock& block) {
    auto layout = std::make_shared<MeshLayout>(mesh.primitives.size());
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {  // those without any surface (all of it dropped) too
        const std::size_t triangles = mesh.primitives[p].indices.size() / 3;
        (*layout)[p].corner_uv.assign(triangles * 3, Vec2f(0, 0));
        (*layout)[p].triangle_page.assign(triangles, no_page);
    }
    for (const std::uint32_t o : objects) fill_primitive(g, g.scene.objects[o], block, (*layout)[g.scene.objects[o].primitive]);
    return layout;
}

}  // namespace

std::vector<InstanceLayout> instance_layouts(const BakedGeometry& g, SharedNodes shared_nodes) {
    const CopyBlock whole_page{.width = g.atlas.page_size, .height = g.atlas.page_size};
    const auto page_size = static_cast<float>(g.atlas.page_size);
    std::vector<InstanceLayout> layouts(g.record.instances.size());
    // The mesh counts too: meshes of equal contents may have different further attributes.
    std::map<std::tuple<std::uint32_t, std::uint32_t, int>, std::shared_ptr<const MeshLayout>> shared;
    const std::vector<Placed> placed = placed_instances(g);
    for (std::size_t i = 0; i < layouts.size(); ++i) {
        if (placed[i].objects.empty() || !g.scene.objects[placed[i].objects[0]].has_lightmap) continue;
        const int mesh = g.record.instances[i].mesh;
        const bool is_split = shared_nodes == SharedNodes::split && g.record.instances[i].gpu_instance >= 0;
        const CopyBlock& block = placed[i].block && !is_split ? *placed[i].block : whole_page;
        layouts[i].place.scale = Vec2f(static_cast<float>(block.width), static_cast<float>(block.height)) / page_size;
        layouts[i].place.offset = Vec2f(static_cast<float>(block.x), static_cast<float>(block.y)) / page_size;
        const auto make = [&] { return mesh_layout(g, g.record.meshes[static_cast<std::size_t>(mesh)], placed[i].objects, block); };
        if (&block == &whole_page) {
            layouts[i].mesh = make();
            continue;
        }
        std::shared_ptr<const MeshLayout>& known = shared[{block.layout, block.page, mesh}];
        if (!known) known = make();
        layouts[i].mesh = known;
    }
    return layouts;
}

}  // namespace luxel
