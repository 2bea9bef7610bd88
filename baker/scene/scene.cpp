#include "baker/scene/scene.h"

namespace luxel {

namespace {

template <class T>
std::uint64_t bytes_of_vector(const std::vector<T>& values) {
    return values.capacity() * sizeof(T);
}

}  // namespace

std::uint64_t Scene::resident_bytes() const {
    std::uint64_t bytes = bytes_of_vector(positions) + bytes_of_vector(shape_positions) + bytes_of_vector(normals) + bytes_of_vector(uv[0]) +
                          bytes_of_vector(uv[1]) + bytes_of_vector(colors) + bytes_of_vector(triangles) + bytes_of_vector(source_triangle) +
                          bytes_of_vector(triangle_object) + bytes_of_vector(objects) + bytes_of_vector(materials) +
                          bytes_of_vector(textures) + bytes_of_vector(lamps) + bytes_of_vector(sky.nits) + object_has_uv1.capacity() / 8;
    for (const Texture& texture : textures) bytes += bytes_of_vector(texture.pixels);
    for (const Object& object : objects) bytes += object.name.capacity();
    return bytes;
}

}  // namespace luxel
