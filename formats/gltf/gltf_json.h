/// Checked reading of JSON members: a wrong type or an index out of range is one clear Error{bad_input}.
///
/// `where` names the object that is read ("hall.glb: mesh 3"). An absent member gives the stated default.
/// Threads: pure functions.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "formats/base/bytes.h"
#include "formats/base/error.h"

namespace luxel {

/// Error{bad_input} with the parts of a message.
[[noreturn]] void bad_gltf(const std::string& where, const std::string& what, const std::string& hint = {});

/// A whole text, which must be an object; its length and depth are bounded before it is parsed. `hint`: what to do if it is none.
nlohmann::json parse_json_object(ByteView text, const std::string& name, const std::string& hint);

/// Member or a shared empty object/array; throws when it has another type.
const nlohmann::json& json_object(const nlohmann::json& parent, const char* key, const std::string& where);
const nlohmann::json& json_array(const nlohmann::json& parent, const char* key, const std::string& where);
/// extensions[key] of an object, or nullptr.
const nlohmann::json* json_extension(const nlohmann::json& parent, const char* key, const std::string& where);

double json_number(const nlohmann::json& parent, const char* key, double otherwise, const std::string& where);
bool json_bool(const nlohmann::json& parent, const char* key, bool otherwise, const std::string& where);
std::string json_text(const nlohmann::json& parent, const char* key, const std::string& otherwise,
                      const std::string& where);
/// Integer >= 0 and at most 2^53; `otherwise` when absent. Whole numbers written as 3.0 are accepted.
std::uint64_t json_size(const nlohmann::json& parent, const char* key, std::uint64_t otherwise,
                        const std::string& where);
std::uint64_t json_size_required(const nlohmann::json& parent, const char* key, const std::string& where);
/// Index below `count`, or -1 when absent.
std::int64_t json_index(const nlohmann::json& parent, const char* key, std::size_t count, const std::string& where);
/// Fills `values` from an array of exactly that length; leaves them when absent; returns if it was there.
bool json_numbers(const nlohmann::json& parent, const char* key, std::span<double> values, const std::string& where);
/// A value that is an integer as json_size says.
std::uint64_t json_value_size(const nlohmann::json& value, const std::string& what, const std::string& where);

/// Element `index` of a top-level array that must be an object.
const nlohmann::json& gltf_item(const nlohmann::json& root, const char* array, std::int64_t index,
                                const std::string& where);
/// How many items a top-level array has; 0 when absent.
std::size_t gltf_count(const nlohmann::json& root, const char* array);
/// `kind "name"`, or `kind 3` for an item without a name.
std::string gltf_name(const nlohmann::json& item, const char* kind, std::int64_t index);

}  // namespace luxel
