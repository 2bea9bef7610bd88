#include "formats/gltf/gltf_json.h"

#include <cmath>

namespace luxel {

using nlohmann::json;

void bad_gltf(const std::string& where, const std::string& what, const std::string& hint) {
    throw Error(ErrorCode::bad_input, where, what, hint);
}

namespace {

/// Deeper nesting than any real file has; the JSON library writes recursively, so depth costs stack.
constexpr int deepest_json = 128;
/// A JSON value takes about 16 bytes of memory for each byte of text: more than this is a mistake or an attack.
constexpr std::size_t longest_json_bytes = std::size_t{1} << 28;

/// Refuses nesting that recursion elsewhere could not bear, before anything recursive sees it.
void check_nesting(ByteView text, const std::string& name) {
    int depth = 0;
    bool in_text = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::uint8_t c = text[i];
        if (in_text) {
            if (c == '\\') ++i;
            else if (c == '"') in_text = false;
        } else if (c == '"') {
            in_text = true;
        } else if (c == '{' || c == '[') {
            if (++depth > deepest_json)
                bad_gltf(name, "JSON is nested deeper than " + std::to_string(deepest_json) + " levels at byte " +
                                   std::to_string(i));
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
}

/// The member, or nullptr. A null counts as absent only where the parent is no object at all.
const json* find(const json& parent, const char* key) {
    if (!parent.is_object()) return nullptr;
    const auto found = parent.find(key);
    return found == parent.end() ? nullptr : &*found;
}

[[noreturn]] void wrong_type(const std::string& where, const char* key, const char* expected, const json& found) {
    bad_gltf(where, std::string("\"") + key + "\": expected " + expected + ", found " + found.type_name());
}

}  // namespace

json parse_json_object(ByteView text, const std::string& name, const std::string& hint) {
    if (text.size() > longest_json_bytes)
        bad_gltf(name, "JSON has " + std::to_string(text.size()) + " bytes, the limit is " + std::to_string(longest_json_bytes));
    check_nesting(text, name);
    try {
        json root = json::parse(text.begin(), text.end());
        if (!root.is_object()) bad_gltf(name, std::string("JSON: expected an object, found ") + root.type_name(), hint);
        return root;
    } catch (const json::exception& problem) {
        bad_gltf(name, std::string("not valid JSON: ") + problem.what(), hint);
    }
}

const json& json_object(const json& parent, const char* key, const std::string& where) {
    static const json empty = json::object();
    const json* value = find(parent, key);
    if (!value) return empty;
    if (!value->is_object()) wrong_type(where, key, "an object", *value);
    return *value;
}

const json& json_array(const json& parent, const char* key, const std::string& where) {
    static const json empty = json::array();
    const json* value = find(parent, key);
    if (!value) return empty;
    if (!value->is_array()) wrong_type(where, key, "an array", *value);
    return *value;
}

const json* json_extension(const json& parent, const char* key, const std::string& where) {
    const json* value = find(json_object(parent, "extensions", where), key);
    if (value && !value->is_object()) wrong_type(where, key, "an object", *value);
    return value;
}

double json_number(const json& parent, const char* key, double otherwise, const std::string& where) {
    const json* value = find(parent, key);
    if (!value) return otherwise;
    if (!value->is_number()) wrong_type(where, key, "a number", *value);
    return value->get<double>();
}

bool json_bool(const json& parent, const char* key, bool otherwise, const std::string& where) {
    const json* value = find(parent, key);
    if (!value) return otherwise;
    if (!value->is_boolean()) wrong_type(where, key, "true or false", *value);
    return value->get<bool>();
}

std::string json_text(const json& parent, const char* key, const std::string& otherwise, const std::string& where) {
    const json* value = find(parent, key);
    if (!value) return otherwise;
    if (!value->is_string()) wrong_type(where, key, "a text", *value);
    return value->get<std::string>();
}

std::uint64_t json_value_size(const json& value, const std::string& what, const std::string& where) {
    constexpr double largest = 9007199254740992.0;  // 2^53: exact in double, so 3.0 and 3 are the same number
    if (value.is_number()) {
        const double number = value.get<double>();
        if (number >= 0 && number <= largest && std::floor(number) == number) return static_cast<std::uint64_t>(number);
    }
    bad_gltf(where, what + ": expected a whole number from 0 on, found " +
                        (value.is_number() ? value.dump() : std::string(value.type_name())));
}

std::uint64_t json_size(const json& parent, const char* key, std::uint64_t otherwise, const std::string& where) {
    const json* value = find(parent, key);
    return value ? json_value_size(*value, std::string("\"") + key + "\"", where) : otherwise;
}

std::uint64_t json_size_required(const json& parent, const char* key, const std::string& where) {
    if (!find(parent, key)) bad_gltf(where, std::string("\"") + key + "\" is missing");
    return json_size(parent, key, 0, where);
}

std::int64_t json_index(const json& parent, const char* key, std::size_t count, const std::string& where) {
    const json* value = find(parent, key);
    if (!value) return -1;
    const std::uint64_t index = json_value_size(*value, std::string("\"") + key + "\"", where);
    if (index >= count)
        bad_gltf(where, std::string("\"") + key + "\" is " + std::to_string(index) + ", but the file has only " +
                            std::to_string(count) + " (numbers start at 0)");
    return static_cast<std::int64_t>(index);
}

bool json_numbers(const json& parent, const char* key, std::span<double> values, const std::string& where) {
    const json* array = find(parent, key);
    if (!array) return false;
    if (!array->is_array() || array->size() != values.size())
        bad_gltf(where, std::string("\"") + key + "\": expected an array of " + std::to_string(values.size()) +
                            " numbers");
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(*array)[i].is_number()) wrong_type(where, key, "only numbers", (*array)[i]);
        values[i] = (*array)[i].get<double>();
    }
    return true;
}

const json& gltf_item(const json& root, const char* array, std::int64_t index, const std::string& where) {
    const json& items = json_array(root, array, where);
    if (index < 0 || static_cast<std::uint64_t>(index) >= items.size())
        bad_gltf(where, std::string(array) + "[" + std::to_string(index) + "] is wanted, but the file has only " +
                            std::to_string(items.size()));
    const json& item = items[static_cast<std::size_t>(index)];
    if (!item.is_object())
        bad_gltf(where, std::string(array) + "[" + std::to_string(index) + "]: expected an object, found " +
                            item.type_name());
    return item;
}

std::size_t gltf_count(const json& root, const char* array) {
    const json* items = find(root, array);
    return items && items->is_array() ? items->size() : 0;
}

std::string gltf_name(const json& item, const char* kind, std::int64_t index) {
    const json* name = find(item, "name");
    if (name && name->is_string() && !name->get_ref<const std::string&>().empty())
        return std::string(kind) + " \"" + name->get<std::string>() + "\"";
    return std::string(kind) + " " + std::to_string(index);
}

}  // namespace luxel
