#include "tests/fuzz/gltf_mutator.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

namespace luxel::fuzz {
namespace {

using nlohmann::json;
using Random = std::minstd_rand;

constexpr std::uint32_t glb_magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

/// The two parts of a file; `body` is what a GLB has after its JSON chunk's header.
struct Parts {
    bool binary = false;
    std::string text;
    Bytes body;
};

std::uint32_t word(ByteView bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

Parts parts_of(ByteView input) {
    const auto text = [&](ByteView bytes) { return std::string(bytes.begin(), bytes.end()); };
    if (input.size() < 20 || word(input, 0) != glb_magic) return {false, text(input), {}};
    const std::size_t size = std::min<std::size_t>(word(input, 12), input.size() - 20);
    ByteView rest = input.subspan(20 + size);
    if (rest.size() >= 8) rest = rest.subspan(8);
    return {true, text(input.subspan(20, size)), Bytes(rest.begin(), rest.end())};
}

Bytes joined(Parts parts) {
    if (!parts.binary) return {parts.text.begin(), parts.text.end()};
    parts.text.append((4 - parts.text.size() % 4) % 4, ' ');
    while (parts.body.size() % 4) parts.body.push_back(0);
    ByteWriter out;
    const auto put = [&](std::size_t value) { out.put(static_cast<std::uint32_t>(value)); };
    put(glb_magic), put(2), put(28 + parts.text.size() + parts.body.size());
    put(parts.text.size()), put(json_chunk);
    out.put_array(std::span<const char>(parts.text.data(), parts.text.size()));
    put(parts.body.size()), put(binary_chunk);
    out.put_array(std::span<const std::uint8_t>(parts.body));
    return out.take();
}

void collect(json& node, std::vector<json*>& all) {
    all.push_back(&node);
    if (node.is_structured())
        for (json& child : node) collect(child, all);
}

json odd_value(Random& random) {
    const std::array<json, 18> values{json(nullptr),
                                      json(true),
                                      json(""),
                                      json::array(),
                                      json::object(),
                                      json(0),
                                      json(1),
                                      json(2),
                                      json(-1),
                                      json(3),
                                      json(255),
                                      json(65536),
                                      json(2147483648.0),
                                      json(4294967295u),
                                      json(9007199254740992.0),
                                      json(1e300),
                                      json(0.5),
                                      json(-1e-30)};
    return values[random() % values.size()];
}

/// One change somewhere in the tree.
void change(json& root, Random& random) {
    std::vector<json*> all;
    collect(root, all);
    json& node = *all[random() % all.size()];
    const json other = *all[random() % all.size()];
    switch (random() % 7) {
        case 0:
            node = odd_value(random);
            return;
        case 1:
            if (other.size() < 50) node = other;
            return;
        case 2:
            if (node.is_number_integer())
                node = node.get<std::int64_t>() + static_cast<std::int64_t>(random() % 5) - 2;
            else if (node.is_number())
                node = node.get<double>() * (static_cast<double>(random() % 9) - 4);
            return;
        case 3:
            if (node.is_array() && !node.empty()) node.push_back(node[random() % node.size()]);
            return;
        case 4:
            if (node.is_array() && !node.empty())
                node.erase(random() % node.size());
            else if (node.is_object() && !node.empty())
                node.erase(std::next(node.begin(), static_cast<std::ptrdiff_t>(random() % node.size())));
            return;
        case 5:
            if (node.is_object() && !node.empty()) {
                const auto at = std::next(node.begin(), static_cast<std::ptrdiff_t>(random() % node.size()));
                const auto key = std::next(node.begin(), static_cast<std::ptrdiff_t>(random() % node.size())).key();
                const json value = at.value();
                node[key] = value;
            }
            return;
        default:
            if (node.is_object() && other.is_object()) node.update(other);
    }
}

}  // namespace

Bytes mutate_gltf(ByteView input, std::size_t room, std::uint32_t seed, ByteMutator mutate) {
    Random random(seed);
    Parts parts = parts_of(input);
    if (parts.binary && random() % 3 == 0) {
        const std::size_t size = parts.body.size(), most = size + 64;
        parts.body.resize(most);
        parts.body.resize(mutate(parts.body.data(), size, most));
    } else {
        json root = json::parse(parts.text, nullptr, false);
        if (!root.is_object()) return {};
        for (std::uint32_t k = 1 + static_cast<std::uint32_t>(random() % 3); k > 0; --k) change(root, random);
        parts.text = root.dump(-1, ' ', false, json::error_handler_t::replace);
    }
    Bytes out = joined(std::move(parts));
    if (out.size() > room) return {};
    return out;
}

}  // namespace luxel::fuzz

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t room);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t room, unsigned seed) {
    if (seed % 4 == 0) return LLVMFuzzerMutate(data, size, room);
    const luxel::Bytes changed = luxel::fuzz::mutate_gltf({data, size}, room, seed, LLVMFuzzerMutate);
    if (changed.empty()) return LLVMFuzzerMutate(data, size, room);
    std::copy(changed.begin(), changed.end(), data);
    return changed.size();
}
