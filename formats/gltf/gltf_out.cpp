#include "formats/gltf/gltf_out.h"

#include <map>

#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_out_files.h"
#include "formats/gltf/gltf_out_mesh.h"
#include "formats/gltf/gltf_out_prune.h"

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
        if (layout.empty()) continue;
        if (instance.gpu_instance >= 0) throw refuse(instance.node_path, "a copy that shares its node has a layout");
        const std::size_t expected = record.meshes[static_cast<std::size_t>(instance.mesh)].primitives.size();
        if (layout.size() != expected)
            throw refuse(instance.node_path, "expected " + std::to_string(expected) + " primitive layouts, found " +
                                                 std::to_string(layout.size()));
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

/// Gives every node with a layout its mesh; returns what the replaced meshes referred to.
ArrayReferences rewrite_meshes(OutputModel& model, const SceneRecord& record, const GltfLightmaps& lightmaps,
                               LightmapMaterials& materials) {
    // By mesh, so that each is read once however many nodes show it.
    std::map<std::int64_t, std::vector<std::size_t>> instances_of;
    for (std::size_t index = 0; index < record.instances.size(); ++index)
        if (!lightmaps.instances[index].empty()) instances_of[record.instances[index].mesh].push_back(index);
    std::map<std::int64_t, std::size_t> users = count_users(model.document);

    ArrayReferences replaced;
    MeshRewriter rewriter(model, materials, lightmaps.pages.size());
    for (const auto& [mesh, instances] : instances_of) {
        const json& item = gltf_item(model.document.json, "meshes", mesh, model.document.name);
        const std::vector<SourcePrimitive> sources =
            rewriter.read_mesh(mesh, record.meshes[static_cast<std::size_t>(mesh)]);
        warn_of_extensions(model, item, mesh);
        // The first copy takes the mesh's own number, unless somebody still shows the mesh as it was.
        bool number_is_free = users[mesh] == instances.size();
        if (number_is_free) collect_references(item, replaced);
        for (const std::size_t index : instances) {
            json copy = rewriter.rewrite(mesh, sources, lightmaps.instances[index]);
            const auto node = static_cast<std::size_t>(record.instances[index].node);
            if (number_is_free)
                model.root["meshes"][static_cast<std::size_t>(mesh)] = std::move(copy);
            else
                model.root["nodes"][node]["mesh"] = model.append("meshes", std::move(copy));
            number_is_free = false;
        }
    }
    return replaced;
}

void add_note(json& root, const std::string& version) {
    json& extras = root["asset"]["extras"];
    if (extras.is_null()) extras = json::object();
    if (extras.is_object()) extras["luxel"] = {{"version", version}};
}

}  // namespace

GltfWritten write_gltf(const std::filesystem::path& path, const GltfDocument& document, const SceneRecord& record,
                       const GltfLightmaps& lightmaps) {
    check_layouts(record, lightmaps);
    OutputModel model(document);
    ModelFiles files(path, model);
    files.take_pictures_along(record);
    std::vector<std::uint64_t> images;
    for (std::size_t page = 0; page < lightmaps.pages.size(); ++page)
        images.push_back(files.add_picture(lightmaps.pages[page].name, ".lightmap" + std::to_string(page) + ".png",
                                           "image/png", lightmaps.pages[page].png));
    LightmapMaterials materials(model, lightmaps, images);
    prune_arrays(model, rewrite_meshes(model, record, lightmaps, materials));
    add_note(model.root, lightmaps.version);
    GltfWritten written;
    written.files = files.write();
    written.warnings = std::move(model.warnings);
    return written;
}

}  // namespace luxel
