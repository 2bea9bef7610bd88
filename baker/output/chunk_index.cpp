#include "baker/output/chunk_index.h"

#include <nlohmann/json.hpp>

#include "formats/gltf/gltf_out_uri.h"

namespace luxel {
namespace {

using Json = nlohmann::ordered_json;

Json file_json(const ChunkFile& file) { return {{"uri", encode_percent(file.file)}, {"bytes", file.bytes}, {"nodes", file.nodes}}; }

Json entry_json(const ChunkEntry& entry) {
    Json json = file_json(entry);
    json["triangles"] = entry.triangles;
    json["min"] = entry.low;
    json["max"] = entry.high;
    json["lightmaps"] = entry.pages;
    json["neighbours"] = Json::array();
    for (const ChunkNeighbour& neighbour : entry.neighbours)
        json["neighbours"].push_back({{"chunk", neighbour.chunk}, {"rays", neighbour.rays}});
    return json;
}

}  // namespace

Bytes chunk_index_text(const ChunkIndex& index) {
    Json root = {{"schema", 1}, {"generator", index.generator}, {"model", encode_percent(index.model)}};
    if (index.common) root["common"] = file_json(*index.common);
    root["pictures"] = Json::array();
    for (const std::string& picture : index.pictures) root["pictures"].push_back(encode_percent(picture));
    root["chunks"] = Json::array();
    for (const ChunkEntry& entry : index.chunks) root["chunks"].push_back(entry_json(entry));
    // Names of nodes need not be UTF-8; a broken byte must not cost the whole bake.
    const std::string text = root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    return {text.begin(), text.end()};
}

}  // namespace luxel
