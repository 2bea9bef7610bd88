#include "formats/gltf/gltf_out_arrays.h"

#include <algorithm>
#include <cmath>

namespace luxel {

using nlohmann::json;

namespace {

constexpr std::uint64_t alignment = 4;
constexpr int target_vertices = 34962, target_indices = 34963;

std::uint64_t aligned(std::uint64_t size) { return (size + alignment - 1) / alignment * alignment; }

std::uint32_t column_count(const AccessorBytes& elements) {
    if (elements.type == "MAT2") return 2;
    if (elements.type == "MAT3") return 3;
    return elements.type == "MAT4" ? 4 : 1;
}

/// As they lie in the file: columns of matrices, and elements of vertex arrays, start at multiples of 4 bytes.
Bytes lay_out(const AccessorBytes& elements, ArrayUse use, std::uint64_t& stride) {
    const std::uint32_t columns = column_count(elements);
    const std::uint64_t column_bytes = elements.element_bytes() / columns;
    const std::uint64_t column_step = columns > 1 ? aligned(column_bytes) : column_bytes;
    stride = columns * column_step;
    if (use == ArrayUse::vertices) stride = aligned(stride);
    if (stride == elements.element_bytes()) return elements.data;
    Bytes bytes(elements.count * stride, 0);
    for (std::uint64_t element = 0; element < elements.count; ++element)
        for (std::uint64_t column = 0; column < columns; ++column)
            std::memcpy(bytes.data() + element * stride + column * column_step,
                        elements.data.data() + (element * columns + column) * column_bytes, column_bytes);
    return bytes;
}

template <class T>
void add_bounds(const AccessorBytes& elements, json& accessor) {
    json low = json::array(), high = json::array();
    for (std::uint64_t component = 0; component < elements.components; ++component) {
        T least{}, most{};
        bool found = false;
        for (std::uint64_t element = 0; element < elements.count; ++element) {
            T value;
            std::memcpy(&value, elements.data.data() + (element * elements.components + component) * sizeof(T),
                        sizeof(T));
            if constexpr (std::is_floating_point_v<T>)
                if (!std::isfinite(value)) continue;
            least = found ? std::min(least, value) : value;
            most = found ? std::max(most, value) : value;
            found = true;
        }
        low.push_back(least);
        high.push_back(most);
    }
    accessor["min"] = std::move(low);
    accessor["max"] = std::move(high);
}

std::pair<std::uint64_t, std::uint64_t> pair_of(const Key& key) { return {key.high, key.low}; }

}  // namespace

void set_bounds(const AccessorBytes& elements, json& accessor) {
    switch (elements.component) {
        case ComponentType::i8:
            return add_bounds<std::int8_t>(elements, accessor);
        case ComponentType::u8:
            return add_bounds<std::uint8_t>(elements, accessor);
        case ComponentType::i16:
            return add_bounds<std::int16_t>(elements, accessor);
        case ComponentType::u16:
            return add_bounds<std::uint16_t>(elements, accessor);
        case ComponentType::u32:
            return add_bounds<std::uint32_t>(elements, accessor);
        case ComponentType::f32:
            return add_bounds<float>(elements, accessor);
    }
}

std::uint64_t ArrayStore::add(const AccessorBytes& elements, ArrayUse use, const json* like, bool bounds) {
    json accessor = like ? *like : json::object();
    const bool has_bounds = accessor.contains("min") || accessor.contains("max");
    for (const char* replaced : {"bufferView", "byteOffset", "sparse", "min", "max", "normalized"})
        accessor.erase(replaced);
    accessor["componentType"] = static_cast<int>(elements.component);
    accessor["type"] = elements.type;
    accessor["count"] = elements.count;
    if (elements.normalized) accessor["normalized"] = true;

    std::uint64_t stride = 0;
    Bytes bytes = lay_out(elements, use, stride);
    const auto view_key = pair_of(KeyBuilder("view")
                                      .integer(static_cast<int>(use))
                                      .integer(static_cast<std::int64_t>(stride))
                                      .bytes(bytes)
                                      .finish());
    auto view = views_.find(view_key);
    if (view == views_.end()) {
        json item = json::object();
        if (use == ArrayUse::vertices) item = {{"target", target_vertices}, {"byteStride", stride}};
        if (use == ArrayUse::indices) item = {{"target", target_indices}};
        view = views_.emplace(view_key, model_.append_view({-1, {}, std::move(bytes)}, std::move(item))).first;
    }
    accessor["bufferView"] = view->second;
    const auto accessor_key = pair_of(KeyBuilder("accessor")
                                          .text(accessor.dump(-1, ' ', false, json::error_handler_t::replace))
                                          .integer(bounds || has_bounds)
                                          .finish());
    const auto known = accessors_.find(accessor_key);
    if (known != accessors_.end()) return known->second;
    if (bounds || has_bounds) set_bounds(elements, accessor);
    const std::uint64_t index = model_.append("accessors", std::move(accessor));
    accessors_.emplace(accessor_key, index);
    return index;
}

std::uint64_t ArrayStore::add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count,
                                      const json* like) {
    // 65535 itself restarts a primitive, so it cannot name a vertex.
    const bool is_short = vertex_count <= 65535;
    AccessorBytes elements;
    elements.component = is_short ? ComponentType::u16 : ComponentType::u32;
    elements.count = indices.size();
    ByteWriter writer;
    for (const std::uint32_t index : indices) {
        if (is_short)
            writer.put(static_cast<std::uint16_t>(index));
        else
            writer.put(index);
    }
    elements.data = writer.take();
    return add(elements, ArrayUse::indices, like, false);
}

AccessorBytes gather_elements(const AccessorBytes& elements, std::span<const std::uint32_t> chosen) {
    AccessorBytes gathered = elements;
    gathered.count = chosen.size();
    const std::uint64_t step = elements.element_bytes();
    gathered.data.assign(chosen.size() * step, 0);
    for (std::size_t k = 0; k < chosen.size(); ++k)
        std::memcpy(gathered.data.data() + k * step, elements.data.data() + chosen[k] * step, step);
    return gathered;
}

}  // namespace luxel
