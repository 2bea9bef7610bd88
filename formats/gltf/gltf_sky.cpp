#include "formats/gltf/gltf_sky.h"

#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_materials.h"

namespace luxel {

using nlohmann::json;

void read_sky(const GltfDocument& document, const ReadOptions& options, SceneRecord& record) {
    constexpr const char* extension = "EXT_lights_image_based";
    const std::size_t scene_count = gltf_count(document.json, "scenes");
    std::int64_t scene = options.scene >= 0 ? options.scene : json_index(document.json, "scene", scene_count, document.name);
    if (scene < 0 && scene_count > 0) scene = 0;
    if (scene < 0) return;
    const json& item = gltf_item(document.json, "scenes", scene, document.name);
    const std::string where = document.name + ": " + gltf_name(item, "scene", scene) + ": " + extension;
    const json* reference = json_extension(item, extension, where);
    if (!reference) return;
    const json* list = json_extension(document.json, extension, document.name);
    const json none = json::object();
    const json& lights = json_array(list ? *list : none, "lights", where);
    const std::int64_t index = json_index(*reference, "light", lights.size(), where);
    if (index < 0) return;
    const json& light = lights[static_cast<std::size_t>(index)];
    if (!light.is_object()) bad_gltf(where, "light " + std::to_string(index) + ": expected an object");
    SkyRecord& sky = record.sky;
    sky.where = document.name + ": " + gltf_name(light, "image-based light", index);
    json_numbers(light, "rotation", sky.rotation, sky.where);
    sky.intensity = json_number(light, "intensity", 1, sky.where);
    const json& mips = json_array(light, "specularImages", sky.where);
    if (mips.empty() || !mips[0].is_array() || mips[0].size() != sky.faces.size())
        bad_gltf(sky.where, "specularImages: expected 6 pictures in its first mip");
    for (std::size_t face = 0; face < sky.faces.size(); ++face) {
        const std::uint64_t image = json_value_size(mips[0][face], "specularImages", sky.where);
        if (image >= gltf_count(document.json, "images"))
            bad_gltf(sky.where, "image " + std::to_string(image) + " is wanted, but the file has only " +
                                    std::to_string(gltf_count(document.json, "images")));
        sky.faces[face] = read_image(document, static_cast<std::int64_t>(image), options.external_images, record.warnings);
    }
    sky.is_there = true;
}

}  // namespace luxel
