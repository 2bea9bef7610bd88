#include "baker/output/layers.h"

#include <algorithm>
#include <string_view>

#include "baker/light/texel_light.h"

namespace luxel {

std::string known_layer_names() {
    std::string names;
    for (const LayerInfo& info : all_layers) names += std::string(names.empty() ? "" : ", ") + info.name;
    return names;
}

const LayerInfo& layer_info(Layer layer) { return all_layers[static_cast<std::size_t>(layer)]; }

std::vector<Layer> parse_layers(const std::string& list, const std::string& where) {
    std::array<bool, all_layers.size()> wanted{};
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string name = list.substr(begin, end - begin);
        const auto* found = std::find_if(all_layers.begin(), all_layers.end(),
                                         [&](const LayerInfo& info) { return info.name == name; });
        if (found == all_layers.end())
            throw Error(ErrorCode::usage, where, "expected some of " + known_layer_names() + "; found \"" + name + "\"",
                        "separate names by commas only, such as albedo,normal");
        wanted[static_cast<std::size_t>(found - all_layers.begin())] = true;
        begin = end + 1;
    }
    std::vector<Layer> layers;
    for (const LayerInfo& info : all_layers)
        if (wanted[static_cast<std::size_t>(info.layer)]) layers.push_back(info.layer);
    return layers;
}

std::string layer_names(std::span<const Layer> layers) {
    std::string names;
    for (const Layer layer : layers) names += std::string(names.empty() ? "" : ",") + layer_info(layer).name;
    return names.empty() ? "none" : names;
}

std::uint64_t layer_bytes_per_texel(std::span<const Layer> layers) {
    constexpr std::uint64_t sample_bytes = 4, mask_bytes = 1;
    std::uint64_t file = 0, largest = 0;
    bool is_of_light = false;
    for (const Layer layer : layers) {
        const LayerInfo& info = layer_info(layer);
        const std::uint64_t bytes = std::string_view(info.channels).size() * sample_bytes;
        file += bytes;
        // As vectors first and then as samples; light is filled by a mask of its own.
        largest = std::max(largest, bytes * (bytes > sample_bytes ? 2 : 1) + (info.is_of_light ? mask_bytes : 0));
        is_of_light = is_of_light || info.is_of_light;
    }
    return layers.empty() ? 0 : mask_bytes + (is_of_light ? sizeof(TexelLight) : 0) + largest + 2 * file;
}

}  // namespace luxel
