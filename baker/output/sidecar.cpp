#include "baker/output/sidecar.h"

#include <nlohmann/json.hpp>

#include "formats/base/file.h"
#include "formats/gltf/gltf_out_uri.h"

namespace luxel {
namespace {

using Json = nlohmann::ordered_json;

Json picture_json(const SidecarPicture& picture) {
    Json json = Json::object();
    if (!picture.name.empty()) json["name"] = picture.name;
    if (!picture.file.empty()) json["uri"] = encode_percent(picture.file);
    if (!picture.format.empty()) json["format"] = picture.format;
    json["encoding"] = picture.encoding;
    if (picture.range > 0) json["range"] = picture.range;
    json["intensity"] = picture.intensity;
    if (picture.error)
        json["error"] = {{"median", picture.error->median}, {"p95", picture.error->p95}, {"largest", picture.error->largest}};
    return json;
}

Json layers_json(const SidecarPage& page) {
    Json parts = Json::array();
    for (const Layer layer : page.layers) {
        const LayerInfo& info = layer_info(layer);
        Json& part = parts.emplace_back(Json{{"name", info.name}, {"channels", info.channels}, {"quantity", info.quantity}});
        if (*info.unit) part["unit"] = info.unit;
    }
    return {{"uri", encode_percent(page.layer_file)}, {"parts", std::move(parts)}};
}

}  // namespace

std::filesystem::path sidecar_path(const std::filesystem::path& model) {
    std::filesystem::path path = model;
    path += ".lightmaps.json";
    return path;
}

Bytes sidecar_text(const Sidecar& sidecar) {
    Json pages = Json::array();
    for (std::size_t index = 0; index < sidecar.pages.size(); ++index) {
        const SidecarPage& page = sidecar.pages[index];
        Json json = {{"index", index},
                     {"width", page.width},
                     {"height", page.height},
                     {"quantity", page.quantity},
                     {"unit", page.unit}};
        for (const auto& [key, picture] : {std::pair{"exr", &page.exr}, std::pair{"picture", &page.picture}})
            if (!picture->file.empty() || !picture->name.empty()) json[key] = picture_json(*picture);
        const bool is_png = page.picture.format == "png8" || page.picture.format == "png16" || page.picture.format.starts_with("rgbm");
        if (is_png && json.contains("picture")) json["png"] = json["picture"];
        if (!page.layer_file.empty()) json["layers"] = layers_json(page);
        pages.push_back(std::move(json));
    }
    Json root = {{"schema", 1}, {"generator", sidecar.generator}};
    if (!sidecar.state.empty()) root["state"] = sidecar.state;
    root["model"] = sidecar.model;
    if (!sidecar.profile.empty()) root["profile"] = sidecar.profile;
    root["texCoord"] = sidecar.uv_set;
    root["texelsPerMetre"] = sidecar.texels_per_metre;
    root["pages"] = std::move(pages);
    // Names of files need not be UTF-8; a broken byte must not cost the whole bake.
    const std::string text = root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    return {text.begin(), text.end()};
}

void write_sidecar(const std::filesystem::path& path, const Sidecar& sidecar) {
    publish_file(path, sidecar_text(sidecar));
}

}  // namespace luxel
