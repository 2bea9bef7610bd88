/// The vector types of the project (Imath's) and the few helpers Imath lacks.
#pragma once
#include <ImathMatrix.h>
#include <ImathVec.h>

#include <array>
#include <cstdint>

namespace luxel {

using Vec2f = Imath::V2f;
using Vec3f = Imath::V3f;
using Vec3d = Imath::V3d;
using Matrix44d = Imath::M44d;  ///< row vectors: p' = p * M, as in Imath (glTF's column-major array has the same order in memory)
using Rgb = Imath::V3f;         ///< linear Rec.709

/// "No such thing" for every 32-bit index.
constexpr std::uint32_t none = 0xffffffffu;

inline float luminance(const Rgb& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline Vec3f to_float(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
inline Vec3d to_double(const Vec3f& v) { return {v.x, v.y, v.z}; }

/// An orthonormal frame around a unit normal without branches on small components.
/// Source: Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1) 2017.
struct Frame {
    Vec3f tangent, bitangent, normal;
    explicit Frame(const Vec3f& n) : normal(n) {
        const float sign = n.z < 0.0f ? -1.0f : 1.0f;
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
        bitangent = {b, sign + n.y * n.y * a, -n.y};
    }
    [[nodiscard]] Vec3f to_world(const Vec3f& local) const {
        return tangent * local.x + bitangent * local.y + normal * local.z;
    }
    [[nodiscard]] Vec3f to_local(const Vec3f& world) const { return {world.dot(tangent), world.dot(bitangent), world.dot(normal)}; }
};

}  // namespace luxel
