/// Rooms become chunks; every patch is in one, none is too large; what moves in one room leaves the chunks of others
/// alone.
#include "baker/chunks/room_chunks.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "baker/core/parallel.h"
#include "tests/support/scenes.h"
#include "tests/unit/chunks/chunk_sets.h"

namespace luxel {
namespace {

using test::chunk_sets;
using test::Prepared;
using test::SceneMaker;

/// Two rooms with a door, a box standing in the left one at (x, z).
std::unique_ptr<Prepared> two_rooms(float x = 1, float z = 1, std::uint32_t first_numbers = 256) {
    const auto rooms = test::two_rooms();
    return test::prepare(SceneMaker()
                             .add("left", rooms[0])
                             .add("right", rooms[1])
                             .add("box", test::moved(test::box(0.6f, 0.6f, 0.6f), {x, 0, z}))
                             .build(),
                         {.texels_per_metre = 16, .page_size = 512, .chunk_patches = first_numbers});
}

constexpr float side_m = 0.25f;  // 4 texels of 16 per metre

Tiling rooms_of(const Prepared& made, std::uint32_t limit) {
    return find_room_chunks(made.scene, made.atlas, made.patches, *made.tracer,
                            {.chunk_patches = limit, .patch_side_m = side_m});
}

/// How many patches of each object are in each chunk.
std::vector<std::map<std::string, std::size_t>> content(const Prepared& made, const Tiling& tiling) {
    std::vector<std::map<std::string, std::size_t>> chunks(tiling.layout.chunk_count());
    for (PatchNumber p = 0; p < made.patches.count(); ++p)
        for (ChunkNumber c = 0; c < tiling.layout.chunk_count(); ++c)
            if (tiling.new_number[p] >= tiling.layout.first_patch[c] &&
                tiling.new_number[p] < tiling.layout.first_patch[c + 1])
                ++chunks[c][made.path_of(p)];
    return chunks;
}

TEST(RoomChunks, TwoRoomsWithADoorAreTwoChunks) {
    const auto made = two_rooms();
    const std::size_t count = made->patches.count();
    const auto chunks = content(*made, rooms_of(*made, static_cast<std::uint32_t>(count * 6 / 10)));
    ASSERT_EQ(chunks.size(), 2u);
    for (const auto& chunk : chunks) {
        const std::size_t left = chunk.contains("left") ? chunk.at("left") : 0,
                          right = chunk.contains("right") ? chunk.at("right") : 0;
        // The faces of the passage, 1.5 of 150 m2, see both rooms.
        EXPECT_LT(std::min(left, right), std::max(left, right) / 20) << left << " " << right;
        EXPECT_EQ(chunk.contains("box"), left > right) << "the box is with the room that it stands in";
    }
    EXPECT_EQ(rooms_of(*made, static_cast<std::uint32_t>(count)).layout.chunk_count(), 1u)
        << "small rooms share a chunk";
}

TEST(RoomChunks, EveryPatchIsInOneChunkWithinTheLimit) {
    const auto made = two_rooms();
    for (const std::uint32_t limit : {1u, 16u, 50u, 200u, 700u, 2000u, 65536u})
        test::expect_valid(made->patches, rooms_of(*made, limit), limit);
}

TEST(RoomChunks, ALargeRoomIsCut) {
    const auto made = test::prepare(SceneMaker().add("hall", test::room({0, 0, 0}, {8, 3, 8})).build(),
                                    {.texels_per_metre = 16, .page_size = 1024});
    const auto count = static_cast<std::uint32_t>(made->patches.count());
    const std::uint32_t limit = count / 4;
    const Tiling tiling = rooms_of(*made, limit);
    test::expect_valid(made->patches, tiling, limit);
    EXPECT_GE(tiling.layout.chunk_count(), 4u);
    EXPECT_LE(tiling.layout.chunk_count(), 8u) << "chunks are more than half full";
}

TEST(RoomChunks, ThreadsAndNumbersDoNotMatter) {
    const auto made = two_rooms(), other = two_rooms(1, 1, 20);
    for (const std::uint32_t limit : {300u, 1000u}) {
        const auto tiling_with = [&](unsigned threads) {
            const ThreadLimit limited(threads);
            return rooms_of(*made, limit);
        };
        const Tiling one = tiling_with(1), four = tiling_with(4);
        EXPECT_EQ(one.new_number, four.new_number);
        EXPECT_EQ(one.layout.first_patch, four.layout.first_patch);
        EXPECT_NE(made->ids(), other->ids());
        EXPECT_EQ(chunk_sets(made->patches, one), chunk_sets(other->patches, rooms_of(*other, limit)));
    }
}

/// Five rooms in a row, a box standing in the first at (x, z).
std::unique_ptr<Prepared> five_rooms(float x, float z) {
    SceneMaker maker;
    int number = 0;
    for (const test::MadeMesh& room : test::rooms_in_a_row(5)) maker.add("room " + std::to_string(number++), room);
    maker.add("box", test::moved(test::box(0.6f, 0.6f, 0.6f), {x, 0, z}));
    return test::prepare(maker.build(), {.texels_per_metre = 16, .page_size = 1024});
}

TEST(RoomChunks, AMovedBoxLeavesOtherRoomsAlone) {
    const auto before = five_rooms(1, 1), after = five_rooms(1.7f, 2.9f);
    const auto room = static_cast<std::uint32_t>(before->patches.count() / 5);
    for (const std::uint32_t limit : {room / 5, room / 3, room * 11 / 10, room * 2}) {
        const Tiling tiling = rooms_of(*before, limit);
        const auto contents = content(*before, tiling);
        const auto sets = test::chunks_of(before->patches, tiling);
        const auto moved = chunk_sets(after->patches, rooms_of(*after, limit));
        std::size_t elsewhere = 0;
        for (std::size_t c = 0; c < sets.size(); ++c) {
            // Faces around the door of the first room see the box.
            if (contents[c].contains("box") || contents[c].contains("room 0") || contents[c].contains("room 1"))
                continue;
            ++elsewhere;
            EXPECT_TRUE(moved.contains({sets[c].begin(), sets[c].end()}))
                << "chunk " << c << " of " << sets[c].size() << ", limit " << limit;
        }
        EXPECT_GE(elsewhere, 1u);
    }
}

TEST(RoomChunks, FacesThatSeeNothingArePutTogether) {
    // The outer faces of 40 boxes far apart: each sees only the open.
    SceneMaker maker;
    for (int k = 0; k < 40; ++k)
        maker.add("box " + std::to_string(k), test::moved(test::box(1, 1, 1), {4.0f * static_cast<float>(k % 8), 0,
                                                                               400.0f * static_cast<float>(k / 8)}));
    const auto made = test::prepare(maker.build(), {.texels_per_metre = 8, .page_size = 512});
    const std::uint32_t limit = 200;
    const Tiling tiling = rooms_of(*made, limit);
    test::expect_valid(made->patches, tiling, limit);
    EXPECT_LE(tiling.layout.chunk_count(), 4 * made->patches.count() / limit + 1);
}

TEST(RoomChunks, HalfFullChunksAreGivenAway) {
    // Rooms in a row, of one cell each, three to a chunk. Joined two by two, twelve of them would need six chunks.
    constexpr std::uint32_t rooms = 12, size = 100;
    SightCells cells;
    SightGraph graph;
    for (std::uint32_t r = 0; r < rooms; ++r) {
        std::vector<PatchNumber> patches(size);
        std::iota(patches.begin(), patches.end(), r * size);
        cells.patches.push_back(patches);
        cells.middle.push_back({static_cast<double>(r), 0, 0});
        graph.patches.push_back(size);
        // Doors between 0-1, 2-3, ... are wider: these are joined first.
        if (r > 0) graph.links.push_back({r - 1, r % 2 ? 20u : 10u});
        if (r + 1 < rooms) graph.links.push_back({r + 1, r % 2 ? 10u : 20u});
        graph.row_begin.push_back(graph.links.size());
    }
    const auto chunks = group_into_rooms(cells, graph, 3 * size);
    EXPECT_LE(chunks.size(), 5u);
    for (const auto& chunk : chunks) {
        EXPECT_LE(chunk.size(), 3 * size);
        EXPECT_EQ(chunk.back() - chunk.front() + 1, chunk.size()) << "rooms beside each other";
    }
}

}  // namespace
}  // namespace luxel
