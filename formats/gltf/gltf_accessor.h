/// Accessors: typed arrays of the file, read with all bounds checked before a byte is touched.
///
/// Shapes   count elements of `components` numbers each, tightly packed, little-endian, element after element; matrices
///          column by column without the padding that the file may have.
/// Handles  buffer views with and without stride, meshopt-compressed views, sparse accessors, accessors without a view
///          (zeros). All component types.
/// Errors   Error{bad_input} naming `where` and the accessor.
/// Threads  const and reentrant.
/// Source   glTF 2.0 specification, section 3.6.2.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/gltf/gltf_document.h"

namespace luxel {

/// Values are glTF's.
enum class ComponentType : int { i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };

/// 1, 2 or 4.
std::uint32_t component_bytes(ComponentType type);

struct AccessorBytes {
    ComponentType component = ComponentType::f32;
    std::uint32_t components = 1;  ///< 1..4 for SCALAR..VEC4, 4, 9, 16 for MAT2..MAT4
    std::string type = "SCALAR";   ///< the file's word
    bool normalized = false;
    std::uint64_t count = 0;
    Bytes data;  ///< count * element_bytes()

    [[nodiscard]] std::uint64_t element_bytes() const { return std::uint64_t{components} * component_bytes(component); }
};

/// What an accessor promises, without its data: `data` stays empty.
AccessorBytes describe_accessor(const GltfDocument& document, std::int64_t accessor, const std::string& where);
AccessorBytes describe_accessor(const nlohmann::json& root, std::int64_t accessor, const std::string& where);

/// The elements of an accessor, in the file's own component type.
AccessorBytes read_elements(const GltfDocument& document, std::int64_t accessor, const std::string& where);

/// Accessors of something that is not a document as it was read: the JSON, and how to get at its views.
struct ArraySource {
    const nlohmann::json& root;
    std::function<ByteView(std::int64_t view, const std::string& where)> view;
    std::function<std::uint64_t(std::int64_t view)> view_stride;  ///< 0 if the view gives none
};
AccessorBytes read_elements(const ArraySource& source, std::int64_t accessor, const std::string& where);

/// All numbers as floats, `components` per element. Normalized integers become -1..1 or 0..1.
std::vector<float> to_floats(const AccessorBytes& elements);

/// One unsigned integer per element; throws unless it is SCALAR of u8, u16 or u32.
std::vector<std::uint32_t> to_indices(const AccessorBytes& elements, const std::string& where);

}  // namespace luxel
