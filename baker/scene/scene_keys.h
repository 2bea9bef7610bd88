/// The names of a scene's contents: what later stages depend on. Parts of scene_build. Threads: pure functions.
#pragma once
#include "baker/scene/scene.h"

namespace luxel {

/// Stable 64-bit hashes that patch ids are made of.
std::uint64_t path_hash_of(const std::string& node_path, int gltf_primitive);
std::uint64_t content_hash_of(const PrimitiveRecord& primitive);

/// What rays can meet: origin, vertices, triangles, objects, sidedness, what lets light through (with its textures).
Key geometry_key_of(const Scene& scene);

/// What only the light depends on: which material an object has, materials, texture pixels, lamps, sky.
Key light_key_of(const Scene& scene);

}  // namespace luxel
