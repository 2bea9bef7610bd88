#include "tests/fuzz/geometry_seeds.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <array>
#include <cstring>
#include <stdexcept>

namespace luxel::fuzz {
namespace {

constexpr std::uint32_t side = 6;  // vertices along an edge

std::array<float, 3> point(std::uint32_t v) {
    const auto x = static_cast<float>(v % side), z = static_cast<float>(v / side);
    return {x, 0.25f * x * z, z};
}
std::array<float, 2> place(std::uint32_t v) { return {static_cast<float>(v % side) / side, static_cast<float>(v / side) / side}; }

std::vector<std::uint32_t> grid_triangles() {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t z = 0; z + 1 < side; ++z)
        for (std::uint32_t x = 0; x + 1 < side; ++x) {
            const std::uint32_t v = z * side + x;
            for (const std::uint32_t corner : {v, v + side, v + 1, v + 1, v + side, v + side + 1}) triangles.push_back(corner);
        }
    return triangles;
}

Bytes draco_stream(int method, int speed) {
    const std::vector<std::uint32_t> triangles = grid_triangles();
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(static_cast<int>(triangles.size() / 3));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    for (std::uint32_t t = 0; t < triangles.size() / 3; ++t) {
        std::array<std::array<float, 3>, 3> points{};
        std::array<std::array<float, 2>, 3> places{};
        for (std::size_t k = 0; k < 3; ++k) {
            points[k] = point(triangles[3 * t + k]);
            places[k] = place(triangles[3 * t + k]);
        }
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(t), points[0].data(), points[1].data(), points[2].data());
        builder.SetAttributeValuesForFace(uv, draco::FaceIndex(t), places[0].data(), places[1].data(), places[2].data());
    }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetSpeedOptions(speed, speed);
    if (speed < 10) {
        encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
        encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 10);
    }
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("Draco does not encode a grid");
    constexpr std::uint8_t vec3_f32 = 2 * 8 + 5, vec2_f32 = 1 * 8 + 5;  // as draco_fuzz reads them
    Bytes seed{vec3_f32, vec2_f32, static_cast<std::uint8_t>(mesh->num_points())};
    seed.insert(seed.end(), buffer.data(), buffer.data() + buffer.size());
    return seed;
}

/// mode and filter as meshopt_fuzz numbers them.
Bytes meshopt_seed(std::uint8_t mode, std::uint8_t filter, std::uint8_t stride, std::size_t count, const Bytes& stream) {
    Bytes seed{static_cast<std::uint8_t>(mode + 4 * filter), stride, static_cast<std::uint8_t>(count % 256), static_cast<std::uint8_t>(count / 256)};
    seed.insert(seed.end(), stream.begin(), stream.end());
    return seed;
}

Bytes encode_vertices(const void* vertices, std::size_t count, std::size_t stride) {
    Bytes stream(meshopt_encodeVertexBufferBound(count, stride));
    stream.resize(meshopt_encodeVertexBuffer(stream.data(), stream.size(), vertices, count, stride));
    return stream;
}

/// What the filters decode: quantised normals, turns and numbers.
std::vector<std::pair<std::string, Bytes>> filtered_seeds() {
    constexpr std::size_t count = side * side;
    std::vector<float> four(4 * count);
    for (std::uint32_t v = 0; v < count; ++v) {
        const std::array<float, 4> unit{0.5f, 0.5f, v % 2 ? 0.5f : -0.5f, 0.5f};
        std::memcpy(&four[4 * v], unit.data(), sizeof(unit));
    }
    Bytes octahedral(4 * count), quaternions(8 * count), numbers(16 * count);
    meshopt_encodeFilterOct(octahedral.data(), count, 4, 8, four.data());
    meshopt_encodeFilterQuat(quaternions.data(), count, 8, 12, four.data());
    meshopt_encodeFilterExp(numbers.data(), count, 16, 12, four.data());
    return {{"octahedral", meshopt_seed(0, 1, 4, count, encode_vertices(octahedral.data(), count, 4))},
            {"quaternions", meshopt_seed(0, 2, 8, count, encode_vertices(quaternions.data(), count, 8))},
            {"exponential", meshopt_seed(0, 3, 16, count, encode_vertices(numbers.data(), count, 16))}};
}

}  // namespace

std::vector<std::pair<std::string, Bytes>> draco_seeds() {
    return {{"edgebreaker", draco_stream(draco::MESH_EDGEBREAKER_ENCODING, 5)},
            {"edgebreaker_slow", draco_stream(draco::MESH_EDGEBREAKER_ENCODING, 0)},
            {"sequential", draco_stream(draco::MESH_SEQUENTIAL_ENCODING, 5)},
            {"plain", draco_stream(draco::MESH_SEQUENTIAL_ENCODING, 10)}};
}

std::vector<std::pair<std::string, Bytes>> meshopt_seeds() {
    constexpr std::size_t count = side * side;
    std::vector<float> points;
    for (std::uint32_t v = 0; v < count; ++v)
        for (const float x : point(v)) points.push_back(x);
    const std::vector<std::uint32_t> triangles = grid_triangles();
    Bytes indices(meshopt_encodeIndexBufferBound(triangles.size(), count)), sequence(meshopt_encodeIndexSequenceBound(triangles.size(), count));
    indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), triangles.data(), triangles.size()));
    sequence.resize(meshopt_encodeIndexSequence(sequence.data(), sequence.size(), triangles.data(), triangles.size()));
    auto seeds = filtered_seeds();
    seeds.emplace_back("vertices", meshopt_seed(0, 0, 12, count, encode_vertices(points.data(), count, 12)));
    seeds.emplace_back("triangles", meshopt_seed(1, 0, 4, triangles.size(), indices));
    seeds.emplace_back("triangles_short", meshopt_seed(1, 0, 2, triangles.size(), indices));
    seeds.emplace_back("sequence", meshopt_seed(2, 0, 4, triangles.size(), sequence));
    return seeds;
}

}  // namespace luxel::fuzz
