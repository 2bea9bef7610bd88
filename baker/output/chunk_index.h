/// `<stem>.chunks.json`: what an engine needs to know to load a baked scene in parts. Its members: docs/outputs.md.
///
/// Errors   Error{cannot_write}. Published by rename: whole or absent.
/// Threads  pure.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel {

struct ChunkNeighbour {
    std::uint32_t chunk = 0;  ///< number in the list
    std::uint64_t rays = 0;   ///< > 0: of a thin round that go between the two, both ways together
};

struct ChunkFile {
    std::string file;  ///< beside the index
    std::uint64_t bytes = 0;
    std::vector<std::string> nodes;  ///< paths of the nodes that belong to it
};

struct ChunkEntry : ChunkFile {
    std::array<double, 3> low{}, high{};  ///< of its surface in the scene, m
    std::uint64_t triangles = 0;
    std::vector<std::uint32_t> pages;        ///< lightmap pages that it uses, ascending
    std::vector<ChunkNeighbour> neighbours;  ///< most rays first
};

struct ChunkIndex {
    std::string generator, model;  ///< model: file name of the whole
    std::optional<ChunkFile> common{};
    std::vector<std::string> pictures;  ///< files that several of the parts refer to
    std::vector<ChunkEntry> chunks;
};

Bytes chunk_index_text(const ChunkIndex& index);

}  // namespace luxel
