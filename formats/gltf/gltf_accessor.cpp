#include "formats/gltf/gltf_accessor.h"

#include <algorithm>
#include <limits>
#include <map>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

/// An accessor without a view is all zeros by definition: its size is the only one that no file bytes stand behind.
constexpr std::uint64_t most_zero_bytes = std::uint64_t{1} << 28;

ComponentType component_type(std::uint64_t value, const std::string& where) {
    switch (value) {
        case 5120: case 5121: case 5122: case 5123: case 5125: case 5126: return static_cast<ComponentType>(value);
        default:
            bad_gltf(where, "componentType: expected 5120, 5121, 5122, 5123, 5125 or 5126, found " + std::to_string(value));
    }
}

struct Shape {
    std::uint32_t rows, columns;
};

Shape shape_of(const std::string& type, const std::string& where) {
    static const std::map<std::string, Shape> shapes{{"SCALAR", {1, 1}}, {"VEC2", {2, 1}}, {"VEC3", {3, 1}}, {"VEC4", {4, 1}},
                                                     {"MAT2", {2, 2}},   {"MAT3", {3, 3}}, {"MAT4", {4, 4}}};
    const auto found = shapes.find(type);
    if (found == shapes.end()) bad_gltf(where, "type: expected SCALAR, VEC2 ... MAT4, found \"" + type + "\"");
    return found->second;
}

/// How an element lies in the file: columns of a matrix start at multiples of 4 bytes.
struct FileLayout {
    std::uint32_t columns, column_bytes, column_step;
    [[nodiscard]] std::uint64_t element_bytes() const {
        return std::uint64_t{columns - 1} * column_step + (columns > 1 ? column_step : column_bytes);
    }
};

FileLayout file_layout(const AccessorBytes& accessor, const std::string& where) {
    const Shape shape = shape_of(accessor.type, where);
    const std::uint32_t column_bytes = shape.rows * component_bytes(accessor.component);
    return {shape.columns, column_bytes, shape.columns > 1 ? (column_bytes + 3) / 4 * 4 : column_bytes};
}

/// The part of a view that starts at `offset` and holds `count` elements `stride` apart; throws if it does not.
ByteView checked_part(ByteView view, std::uint64_t offset, std::uint64_t stride, std::uint64_t element_bytes,
                      std::uint64_t count, const std::string& where) {
    if (count == 0) return {};
    const bool fits = offset <= view.size() && element_bytes <= view.size() - offset &&
                      (count - 1) <= (view.size() - offset - element_bytes) / stride;
    if (!fits)
        bad_gltf(where, std::to_string(count) + " elements of " + std::to_string(element_bytes) + " bytes, " +
                            std::to_string(stride) + " bytes apart, from byte " + std::to_string(offset) +
                            " on, do not fit into the buffer view of " + std::to_string(view.size()) + " bytes",
                 "the file is damaged; export it again");
    return view.subspan(offset);
}

void copy_elements(ByteView from, std::uint64_t stride, const FileLayout& layout, std::uint64_t count, Bytes& into) {
    const std::uint64_t packed = std::uint64_t{layout.columns} * layout.column_bytes;
    if (stride == packed) {
        into.insert(into.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(count * packed));
        return;
    }
    into.reserve(into.size() + count * packed);
    for (std::uint64_t i = 0; i < count; ++i)
        for (std::uint32_t c = 0; c < layout.columns; ++c) {
            const auto* first = from.data() + i * stride + std::uint64_t{c} * layout.column_step;
            into.insert(into.end(), first, first + layout.column_bytes);
        }
}

/// Replaces single elements. Source: glTF 2.0, section 3.6.2.3.
void apply_sparse(const ArraySource& file, const json& sparse, AccessorBytes& accessor, const std::string& where) {
    const std::string here = where + ": sparse";
    const std::uint64_t count = json_size_required(sparse, "count", here);
    if (count > accessor.count)
        bad_gltf(here, "replaces " + std::to_string(count) + " elements of " + std::to_string(accessor.count));
    const json& where_to = json_object(sparse, "indices", here);
    const json& what = json_object(sparse, "values", here);
    const auto part = [&](const json& source, std::uint64_t element_bytes) {
        const auto view = static_cast<std::int64_t>(json_size_required(source, "bufferView", here));
        return checked_part(file.view(view, here), json_size(source, "byteOffset", 0, here), element_bytes,
                            element_bytes, count, here);
    };
    AccessorBytes targets;
    targets.component = component_type(json_size_required(where_to, "componentType", here), here);
    targets.count = count;
    const FileLayout target_layout = file_layout(targets, here);
    copy_elements(part(where_to, target_layout.element_bytes()), target_layout.element_bytes(), target_layout, count, targets.data);
    const FileLayout layout = file_layout(accessor, here);
    Bytes values;
    copy_elements(part(what, layout.element_bytes()), layout.element_bytes(), layout, count, values);

    const std::vector<std::uint32_t> indices = to_indices(targets, here);
    const std::uint64_t step = accessor.element_bytes();
    for (std::uint64_t i = 0; i < count; ++i) {
        if (indices[i] >= accessor.count)
            bad_gltf(here, "index " + std::to_string(indices[i]) + " of " + std::to_string(accessor.count) + " elements");
        std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * step), step,
                    accessor.data.begin() + static_cast<std::ptrdiff_t>(indices[i] * step));
    }
}

template <class T>
void append_floats(const AccessorBytes& elements, std::vector<float>& out) {
    const std::uint64_t count = elements.count * elements.components;
    out.resize(count);
    // Source: glTF 2.0, section 3.6.2.2: signed types map their lowest value to -1 as well.
    const float scale = elements.normalized && std::is_integral_v<T>
                            ? 1.0f / static_cast<float>(std::numeric_limits<T>::max()) : 1.0f;
    for (std::uint64_t i = 0; i < count; ++i) {
        T value;
        std::memcpy(&value, elements.data.data() + i * sizeof(T), sizeof(T));
        const float scaled = static_cast<float>(value) * scale;
        out[i] = elements.normalized && std::is_integral_v<T> ? std::max(scaled, -1.0f) : scaled;
    }
}

template <class T>
void append_indices(const AccessorBytes& elements, std::vector<std::uint32_t>& out) {
    out.resize(elements.count);
    for (std::uint64_t i = 0; i < elements.count; ++i) {
        T value;
        std::memcpy(&value, elements.data.data() + i * sizeof(T), sizeof(T));
        out[i] = value;
    }
}

std::string accessor_name(std::int64_t accessor, const std::string& where) {
    return where + ": accessor " + std::to_string(accessor);
}

}  // namespace

std::uint32_t component_bytes(ComponentType type) {
    switch (type) {
        case ComponentType::i8: case ComponentType::u8: return 1;
        case ComponentType::i16: case ComponentType::u16: return 2;
        case ComponentType::u32: case ComponentType::f32: return 4;
    }
    return 4;
}

AccessorBytes describe_accessor(const json& root, std::int64_t accessor, const std::string& where) {
    const std::string here = accessor_name(accessor, where);
    const json& item = gltf_item(root, "accessors", accessor, where);
    AccessorBytes found;
    found.component = component_type(json_size_required(item, "componentType", here), here);
    found.type = json_text(item, "type", "", here);
    const Shape shape = shape_of(found.type, here);
    found.components = shape.rows * shape.columns;
    found.normalized = json_bool(item, "normalized", false, here);
    found.count = json_size_required(item, "count", here);
    return found;
}

AccessorBytes describe_accessor(const GltfDocument& document, std::int64_t accessor, const std::string& where) {
    return describe_accessor(document.json, accessor, where);
}

AccessorBytes read_elements(const GltfDocument& document, std::int64_t accessor, const std::string& where) {
    return read_elements({document.json, [&](std::int64_t view, const std::string& here) { return document.view(view, here); },
                          [&](std::int64_t view) { return document.view_stride(view); }},
                         accessor, where);
}

AccessorBytes read_elements(const ArraySource& source, std::int64_t accessor, const std::string& where) {
    const std::string here = accessor_name(accessor, where);
    AccessorBytes found = describe_accessor(source.root, accessor, where);
    const json& item = gltf_item(source.root, "accessors", accessor, where);
    if (item.contains("bufferView")) {
        const auto view = static_cast<std::int64_t>(json_size_required(item, "bufferView", here));
        const ByteView bytes = source.view(view, here);
        const FileLayout layout = file_layout(found, here);
        const std::uint64_t given = source.view_stride(view);
        const std::uint64_t stride = given ? given : layout.element_bytes();
        const ByteView part = checked_part(bytes, json_size(item, "byteOffset", 0, here), stride, layout.element_bytes(),
                                           found.count, here);
        copy_elements(part, stride, layout, found.count, found.data);
    } else {
        if (found.count > most_zero_bytes / found.element_bytes())
            bad_gltf(here, std::to_string(found.count) + " elements without a buffer view: more than this program makes up");
        found.data.assign(found.count * found.element_bytes(), 0);
    }
    if (item.contains("sparse")) apply_sparse(source, json_object(item, "sparse", here), found, here);
    return found;
}

std::vector<float> to_floats(const AccessorBytes& elements) {
    std::vector<float> out;
    switch (elements.component) {
        case ComponentType::i8: append_floats<std::int8_t>(elements, out); break;
        case ComponentType::u8: append_floats<std::uint8_t>(elements, out); break;
        case ComponentType::i16: append_floats<std::int16_t>(elements, out); break;
        case ComponentType::u16: append_floats<std::uint16_t>(elements, out); break;
        case ComponentType::u32: append_floats<std::uint32_t>(elements, out); break;
        case ComponentType::f32: append_floats<float>(elements, out); break;
    }
    return out;
}

std::vector<std::uint32_t> to_indices(const AccessorBytes& elements, const std::string& where) {
    if (elements.components != 1) bad_gltf(where, "indices: expected SCALAR, found " + elements.type);
    std::vector<std::uint32_t> out;
    switch (elements.component) {
        case ComponentType::u8: append_indices<std::uint8_t>(elements, out); break;
        case ComponentType::u16: append_indices<std::uint16_t>(elements, out); break;
        case ComponentType::u32: append_indices<std::uint32_t>(elements, out); break;
        default: bad_gltf(where, "indices: expected an unsigned type, found componentType " +
                                     std::to_string(static_cast<int>(elements.component)));
    }
    return out;
}

}  // namespace luxel
