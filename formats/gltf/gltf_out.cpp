#include "formats/gltf/gltf_out.h"

#include <map>

#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_out_copies.h"
#include "formats/gltf/gltf_out_draco.h"
#include "formats/gltf/gltf_out_files.h"
#include "formats/gltf/gltf_out_mesh.h"
#include "formats/gltf/gltf_out_meshopt.h"
#include "formats/gltf/gltf_out_nodes.h"
#include "formats/gltf/gltf_out_parts.h"
#include "formats/gltf/gltf_out_prune.h"
#include "formats/gltf/gltf_out_unlit.h"

namespace luxel {

using nlohmann::json;

namespace {

/// How many nodes of the whole file (all scenes) show each mesh.
std::map<std::int64_t, std::size_t> count_users(const GltfDocument& document) {
    std::map<std::int64_t, std::size_t> users;
    const std::size_t mesh_count = gltf_count(document.json, "meshes");
    for (std::size_t node = 0; node < gltf_count(document.json, "nodes"); ++node) {
        const json& item = gltf_item(document.json, "nodes", static_cast<std::int64_t>(node), document.name);
        if (const std::int64_t mesh = json_index(item, "mesh", mesh_count, document.name); mesh >= 0) ++users[mesh];
    }
    return users;
}

void check_layouts(const SceneRecord& record, const GltfLightmaps& lightmaps) {
    const auto refuse = [](const std::string& where, const std::string& what) {
        return Error(ErrorCode::internal, where, what);
    };
    if (lightmaps.instances.size() != record.instances.size())
        throw refuse("write_gltf", "expected " + std::to_string(record.instances.size()) + " instance layouts, found " +
                                       std::to_string(lightmaps.instances.size()));
    for (std::size_t index = 0; index < record.instances.size(); ++index) {
        const InstanceRecord& instance = record.instances[index];
        const InstanceLayout& layout = lightmaps.instances[index];
        if (!layout.mesh) continue;
        const std::size_t expected = record.meshes[static_cast<std::size_t>(instance.mesh)].primitives.size();
        if (layout.mesh->size() != expected)
            throw refuse(instance.node_path, "expected " + std::to_string(expected) + " primitive layouts, found " +
                                                 std::to_string(layout.mesh->size()));
    }
}

/// Extensions of primitives that count vertices or triangles do so no longer.
void warn_of_extensions(OutputModel& model, const json& mesh, std::int64_t index) {
    for (const json& primitive : mesh["primitives"]) {
        const auto extensions = primitive.find("extensions");
        if (extensions == primitive.end()) continue;
        for (const auto& [name, content] : extensions->items())
            if (name != "KHR_draco_mesh_compression" && name != "KHR_materials_variants")
                model.warnings.push_back(
                    {"primitive-extension", model.document.name + ": " + gltf_name(mesh, "mesh", index),
                     name + " is kept as it was; what it says about single vertices may no longer fit"});
    }
}

/// The instances of one node: one, or its copies by EXT_mesh_gpu_instancing.
using NodeInstances = std::map<int, std::vector<std::size_t>>;

/// Instances by mesh, so that each is read once however many nodes show it, and by node. Nodes without any layout are left out.
std::map<std::int64_t, NodeInstances> instances_by_mesh(const SceneRecord& record, const GltfLightmaps& lightmaps) {
    std::map<int, bool> has_layout;
    for (std::size_t index = 0; index < record.instances.size(); ++index)
        if (lightmaps.instances[index].mesh) has_layout[record.instances[index].node] = true;
    std::map<std::int64_t, NodeInstances> by_mesh;
    for (std::size_t index = 0; index < record.instances.size(); ++index) {
        const InstanceRecord& instance = record.instances[index];
        if (has_layout.contains(instance.node)) by_mesh[instance.mesh][instance.node].push_back(index);
    }
    return by_mesh;
}

/// The new meshes of one mesh of the input. The first takes the mesh's own number, unless somebody still shows the mesh as it was.
class NewMeshes {
  public:
    NewMeshes(OutputModel& model, MeshRewriter& rewriter, const GltfLightmaps& lightmaps, std::int64_t mesh, const MeshRecord& record, bool number_is_free)
        : model_(model), rewriter_(rewriter), lightmaps_(lightmaps), mesh_(mesh), number_is_free_(number_is_free),
          sources_(rewriter.read_mesh(mesh, record)) {}

    std::vector<ShownMesh> make(const MeshLayout& layout, const LayoutPlace& place) {
        const auto known = laid_out_.find(&layout);
        const LaidOutMesh& laid_out = known != laid_out_.end() ? known->second : laid_out_.emplace(&layout, rewriter_.lay_out(mesh_, sources_, layout)).first->second;
        const bool on_nodes = lightmaps_.meaning.placement == LightmapPlacement::nodes;
        if (!on_nodes || laid_out.parts.empty()) return {{add(rewriter_.at_place(laid_out, place))}};
        std::vector<ShownMesh>& shown = on_pages_[&layout];
        if (shown.empty())
            for (const std::uint32_t page : laid_out.pages()) shown.push_back({add(rewriter_.on_page(laid_out, page)), page});
        return shown;
    }

  private:
    std::uint64_t add(json mesh) {
        if (!number_is_free_) return model_.append("meshes", std::move(mesh));
        number_is_free_ = false;
        model_.root["meshes"][static_cast<std::size_t>(mesh_)] = std::move(mesh);
        return static_cast<std::uint64_t>(mesh_);
    }

    OutputModel& model_;
    MeshRewriter& rewriter_;
    const GltfLightmaps& lightmaps_;
    std::int64_t mesh_;
    bool number_is_free_;
    std::vector<SourcePrimitive> sources_;
    std::map<const MeshLayout*, LaidOutMesh> laid_out_;
    std::map<const MeshLayout*, std::vector<ShownMesh>> on_pages_;
};

/// Gives every node with a layout its mesh; returns what the replaced meshes referred to.
ArrayReferences rewrite_meshes(OutputModel& model, const SceneRecord& record, const GltfLightmaps& lightmaps,
                               LightmapMaterials& materials) {
    std::map<std::int64_t, std::size_t> users = count_users(model.document);
    ArrayReferences replaced;
    MeshRewriter rewriter(model, materials, lightmaps.pages.size());
    NodeWriter writer(model, lightmaps, materials.textures());
    for (const auto& [mesh, nodes] : instances_by_mesh(record, lightmaps)) {
        const json& item = gltf_item(model.document.json, "meshes", mesh, model.document.name);
        bool number_is_free = users[mesh] == nodes.size();
        for (const auto& [node, instances] : nodes)
            for (const std::size_t index : instances) number_is_free = number_is_free && lightmaps.instances[index].mesh != nullptr;
        NewMeshes meshes(model, rewriter, lightmaps, mesh, record.meshes[static_cast<std::size_t>(mesh)], number_is_free);
        warn_of_extensions(model, item, mesh);
        if (number_is_free) collect_references(item, replaced);
        const MeshMaker make_meshes = [&](const MeshLayout& layout, const LayoutPlace& place) { return meshes.make(layout, place); };
        for (const auto& [node, instances] : nodes) {
            if (record.instances[instances[0]].gpu_instance >= 0) {
                place_copies(model, rewriter.arrays(), writer, node, copies_of(record, lightmaps, instances), make_meshes);
                continue;
            }
            const InstanceLayout& layout = lightmaps.instances[instances[0]];
            writer.show(static_cast<std::uint64_t>(node), make_meshes(*layout.mesh, layout.place), layout.place);
        }
    }
    writer.finish();
    return replaced;
}

void add_note(json& root, const std::string& version) {
    json& extras = root["asset"]["extras"];
    if (extras.is_null()) extras = json::object();
    if (extras.is_object()) extras["luxel"] = {{"version", version}};
}

/// All files or none: what has been written of the model goes if its parts cannot be.
void add_parts(const std::filesystem::path& path, OutputModel& model, const ModelFiles& files, const GltfPacking& packing,
               const std::vector<std::uint64_t>& page_images, GltfWritten& written) {
    try {
        written.parts = write_parts(path, model, files, packing, page_images);
    } catch (...) {
        std::error_code ignored;
        for (const auto& file : written.files) std::filesystem::remove(file, ignored);
        throw;
    }
    const std::vector<std::filesystem::path> more = written.parts.files();
    written.files.insert(written.files.end(), more.begin(), more.end());
    written.warnings.insert(written.warnings.end(), written.parts.warnings.begin(), written.parts.warnings.end());
}

}  // namespace

GltfWritten write_gltf(const std::filesystem::path& path, const GltfDocument& document, const SceneRecord& record,
                       const GltfLightmaps& lightmaps, const GltfPacking& packing) {
    check_layouts(record, lightmaps);
    OutputModel model(document);
    ModelFiles files(path, model);
    if (!lightmaps.is_unlit) files.take_pictures_along(record);
    std::vector<std::uint64_t> images;
    for (std::size_t page = 0; page < lightmaps.pages.size(); ++page)
        images.push_back(files.add_page(page, lightmaps.pages[page], lightmaps.meaning));
    LightmapMaterials materials(model, lightmaps, images);
    ArrayReferences replaced = rewrite_meshes(model, record, lightmaps, materials);
    if (lightmaps.is_unlit) {
        drop_input_materials(model, replaced);
        files.take_pictures_along(record);
    }
    if (packing.draco) compress_draco(model, *packing.draco, packing.page_size, replaced);
    prune_arrays(model, replaced);
    add_note(model.root, lightmaps.version);
    if (packing.meshopt) pack_meshopt(model);
    GltfWritten written;
    for (const std::uint64_t image : images) written.page_files.push_back(files.file_of(image));
    written.files = files.write();
    written.warnings = std::move(model.warnings);
    if (packing.split) add_parts(path, model, files, packing, images, written);
    return written;
}

}  // namespace luxel
