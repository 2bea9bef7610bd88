// Two rooms, a lamp in the first, a door between them: the second has light through the door, and none when it is closed.
#include <gtest/gtest.h>

#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/stage_clock.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

constexpr double wall_x = 4.2;  // the second room begins here, metres

std::size_t node_index(const nlohmann::json& document, const std::string& name) {
    for (std::size_t n = 0; n < document["nodes"].size(); ++n)
        if (document["nodes"][n]["name"] == name) return n;
    throw std::runtime_error("no node " + name);
}

/// Chunks of this bake hold patches of both rooms: neither they nor the solver may let light through a wall.
/// Both walls with the door become whole ones: turned or moved copies of the first room's west wall.
void close_door(nlohmann::json& document) {
    const auto whole = document["nodes"][node_index(document, "room_0_0_wall_west")]["mesh"];
    auto& east = document["nodes"][node_index(document, "room_0_0_wall_east")];
    east["mesh"] = whole;
    east["translation"] = {4.0, 0.0, 5.0};
    east["rotation"] = {0.0, 1.0, 0.0, 0.0};
    auto& west = document["nodes"][node_index(document, "room_1_0_wall_west")];
    west["mesh"] = whole;
    west["translation"] = {4.199999809265137, 0.0, 0.0};  // the 32-bit float that the other walls have
    auto& children = document["nodes"][node_index(document, "room_0_0")]["children"];
    const std::size_t reveal = node_index(document, "room_0_0_door_east");
    children.erase(std::find(children.begin(), children.end(), reveal));
}

struct Rooms {
    double lit = 0, unlit = 0;          ///< lm that arrive on the surfaces of each room, green channel
    double lit_m2 = 0, unlit_m2 = 0;
    double largest_unlit_texel = 0;
};

/// Sums what the bake stored over the patches and texels of each room.
Rooms light_of_rooms(const BakeOptions& options, const BakeReport& report) {
    const BakeFolder folder(options.work, options.output);
    BakeReport ignored;
    StageClock clock(options, ignored);
    const auto geometry = prepare_geometry(options, folder, clock, ignored);
    const SolveResult solution = stored_solution(options.work, report.patches);
    const std::vector<float> irradiance = stored_irradiance(options.work);
    Rooms rooms;
    for (std::size_t p = 0; p < geometry->patches.count(); ++p) {
        const Patch& patch = geometry->patches.patches[p];
        const bool unlit = geometry->scene.origin.x + static_cast<double>(patch.center.x) > wall_x - 1e-3;
        (unlit ? rooms.unlit : rooms.lit) += static_cast<double>(patch.area_m2) * solution.radiosity[p][1];
        (unlit ? rooms.unlit_m2 : rooms.lit_m2) += static_cast<double>(patch.area_m2);
    }
    std::size_t at = 1;
    for (std::uint32_t page = 0; page < geometry->atlas.page_count; ++page)
        for (const Texel& texel : geometry->texels.pages[page].texels) {
            const PatchNumber patch =
                geometry->patches.page_patch[page][std::size_t{texel.y} * geometry->patches.page_size + texel.x];
            // Texels inside solids may be of no patch, and hold no light.
            const double x = patch == no_patch ? 0 : geometry->scene.origin.x + static_cast<double>(geometry->patches.patches[patch].center.x);
            if (x > wall_x - 1e-3)
                rooms.largest_unlit_texel = std::max(rooms.largest_unlit_texel, static_cast<double>(irradiance[at]));
            at += 3;
        }
    return rooms;
}

TEST(TwoRooms, LightArrivesThroughTheDoor) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample("two_rooms"), folder / "out.glb");
    options.work = folder / "work";
    const Rooms rooms = light_of_rooms(options, bake(options));
    EXPECT_GT(rooms.unlit, 0);
    EXPECT_GT(rooms.largest_unlit_texel, 0);
    EXPECT_LT(rooms.unlit / rooms.unlit_m2, 0.1 * rooms.lit / rooms.lit_m2);
}

TEST(TwoRooms, AClosedDoorLetsNothingThrough) {
    const TemporaryFolder folder;
    for (const std::uint32_t gather_rays : {0u, 16u}) {
        BakeOptions options = small_options(edited_sample("two_rooms", folder / "scene", close_door), folder / "out.glb");
        options.work = folder / "work";
        options.work += std::to_string(gather_rays);
        options.gather_rays = gather_rays;
        const Rooms rooms = light_of_rooms(options, bake(options));
        EXPECT_GT(rooms.lit, 0);
        EXPECT_GT(rooms.unlit_m2, 80);
        EXPECT_EQ(rooms.unlit, 0);
        EXPECT_EQ(rooms.largest_unlit_texel, 0);
    }
}

}  // namespace
}  // namespace luxel::test
