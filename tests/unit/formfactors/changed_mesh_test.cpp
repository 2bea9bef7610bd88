/// What an incremental bake stands on: after one mesh has changed, and with it all numbers, pages and chunks, the
/// evidence of every patch whose rays cannot meet that mesh is the same, byte for byte.
#include <gtest/gtest.h>

#include <set>

#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

using test::MadeMesh;
using test::Prepared;
using test::SceneMaker;

constexpr LevelRange levels{0, 7};

/// Two closed rooms; the statue stands in the second one, and comes first in the file and in the order of space.
Scene scene_with(const MadeMesh& statue, const MadeMesh* in_the_other_room = nullptr) {
    SceneMaker maker;
    maker.add("statue", test::moved(statue, {0.9f, 0.8f, 2.0f}), {}, Vec3d(0, 0, 0));
    test::add_furnished_room(maker, "second", Vec3d(0, 0, 0));
    test::add_furnished_room(maker, "first", Vec3d(5, 0, 0));
    if (in_the_other_room)
        maker.add("first/copy", test::moved(*in_the_other_room, {0.9f, 0.8f, 2.0f}), {}, Vec3d(5.123, 0.1, 0.077));
    return maker.build();
}

struct BakedOnce {
    std::unique_ptr<Prepared> made;
    std::map<PatchId, std::vector<EvidenceRecord>> evidence;
    std::map<PatchId, PatchNumber> number;
    std::set<PatchId> statue;

    BakedOnce(const Scene& scene, const test::PrepareOptions& options) : made(test::prepare(scene, options)) {
        evidence = test::evidence_of(*made, *test::estimator_of(*made), levels);
        for (PatchNumber p = 0; p < made->patches.count(); ++p) {
            number[made->patches.patches[p].id] = p;
            if (made->path_of(p) == "statue") statue.insert(made->patches.patches[p].id);
        }
    }
    /// Did a ray of the patch end on the statue?
    [[nodiscard]] bool meets_statue(PatchId id) const {
        for (const EvidenceRecord& record : evidence.at(id))
            for (const PatchId target : record.target_id)
                if (statue.contains(target)) return true;
        return false;
    }
    [[nodiscard]] Bytes bytes(PatchId id) const {
        return encode_evidence(std::span<const EvidenceRecord>(evidence.at(id)));
    }
};

struct Comparison {
    std::size_t same_numbers = 0, compared_first = 0, compared_second = 0, different = 0;
};

Comparison compare(const BakedOnce& before, const BakedOnce& after) {
    Comparison found;
    for (const auto& [id, number] : before.number) {
        if (before.statue.contains(id)) continue;
        const auto other = after.number.find(id);
        if (other == after.number.end()) {
            ADD_FAILURE() << "a patch of " << before.made->path_of(number) << " has lost its name";
            continue;
        }
        found.same_numbers += other->second == number;
        const bool first = before.made->path_of(number).starts_with("first");
        // In the room of the statue: patches of which no ray met it, before or after.
        if (!first && (before.meets_statue(id) || after.meets_statue(id))) continue;
        ++(first ? found.compared_first : found.compared_second);
        if (before.bytes(id) != after.bytes(id)) {
            ++found.different;
            ADD_FAILURE() << "evidence of a patch of " << before.made->path_of(number) << " has changed";
        }
    }
    return found;
}

TEST(ChangedMesh, EvidenceOfEverythingElseStaysByteEqual) {
    // Packed chart by chart, which moves more of them than blocks would.
    const BakedOnce before(scene_with(test::icosphere(1, 0.4f)), {.chunk_patches = 64, .instances = InstanceMode::split});
    const BakedOnce after(scene_with(test::moved(test::box(0.5f, 0.7f, 0.6f), {-0.2f, -0.3f, -0.1f})),
                          {.chunk_patches = 50, .instances = InstanceMode::split});
    const Comparison found = compare(before, after);
    const std::size_t others = before.number.size() - before.statue.size();
    // The change went through everything that is not stable.
    EXPECT_LT(found.same_numbers, others / 10);
    EXPECT_NE(before.made->layout.first_patch, after.made->layout.first_patch);
    std::size_t moved_charts = 0;
    for (std::size_t c = 1; c <= 20; ++c) {
        const Chart& a = before.made->atlas.charts[before.made->atlas.charts.size() - c];
        const Chart& b = after.made->atlas.charts[after.made->atlas.charts.size() - c];
        EXPECT_EQ(a.ordinal, b.ordinal);
        moved_charts += a.x != b.x || a.y != b.y || a.page != b.page;
    }
    EXPECT_GT(moved_charts, 5u);
    EXPECT_GT(found.compared_first, others / 3);
    EXPECT_GT(found.compared_second, 10u);
    EXPECT_EQ(found.different, 0u);
}

/// Copies of a mesh share charts, which must not depend on the copy that changes.
TEST(ChangedMesh, CopiesOfTheChangedMeshStayTheSame) {
    const MadeMesh ball = test::icosphere(1, 0.4f);
    const BakedOnce before(scene_with(ball, &ball), {.chunk_patches = 64});
    const BakedOnce after(scene_with(test::box(0.5f, 0.7f, 0.6f), &ball), {.chunk_patches = 64});
    const Comparison found = compare(before, after);
    EXPECT_GT(found.compared_first, 100u);
    EXPECT_EQ(found.different, 0u);
}

TEST(ChangedMesh, RemovedMesh) {
    const BakedOnce before(scene_with(test::icosphere(1, 0.4f)), {.chunk_patches = 64});
    SceneMaker maker;
    test::add_furnished_room(maker, "second", Vec3d(0, 0, 0));
    test::add_furnished_room(maker, "first", Vec3d(5, 0, 0));
    const BakedOnce after(maker.build(), {.chunk_patches = 64});
    const Comparison found = compare(before, after);
    EXPECT_GT(found.compared_first, 100u);
    EXPECT_GT(found.compared_second, 10u);
    EXPECT_EQ(found.different, 0u);
}

/// Only colours: nothing that rays can meet has changed.
TEST(ChangedMesh, OtherMaterialsChangeNothing) {
    SceneMaker plain, coloured;
    test::add_furnished_room(plain, "first", Vec3d(0, 0, 0));
    test::add_furnished_room(coloured, "first", Vec3d(0, 0, 0));
    for (MaterialRecord& material : coloured.record().materials) material.base_color = {0.1, 0.2, 0.3, 1};
    const BakedOnce before(plain.build(), {}), after(coloured.build(), {});
    EXPECT_EQ(before.evidence, after.evidence);
}

}  // namespace
}  // namespace luxel
