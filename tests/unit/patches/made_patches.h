/// A scene with everything up to patches, for the tests of this room.
#pragma once
#include "baker/patches/patch_build.h"
#include "baker/patches/texel_raster.h"
#include "baker/unwrap/unwrap.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel::test {

struct MadePatches {
    Scene scene;
    Atlas atlas;
    TexelSet texels;
    PatchSet set;
};

inline MadePatches make_patches(Scene scene, double density = 23, std::uint32_t patch_texels = 4,
                                std::uint32_t page_size = 256) {
    MadePatches made;
    made.scene = std::move(scene);
    UnwrapOptions options;
    options.texels_per_metre = density;
    options.page_size = page_size;
    std::vector<Warning> warnings;
    made.atlas = unwrap(made.scene, options, warnings, {});
    made.texels = raster_texels(made.scene, made.atlas);
    made.set = build_patches(made.scene, made.atlas, made.texels, {patch_texels});
    return made;
}

/// Three objects of different colour and light.
inline Scene coloured_scene() {
    Scene scene;
    add_object(scene, "box", box(2, 1, 3), 1);
    add_object(scene, "sphere", sphere(20, 0.7f), 2);
    add_object(scene, "terrain", terrain(30, 0.05f, 1.5f), 3);
    scene.materials[0].reflectance = {0.2f, 0.5f, 0.8f};
    scene.materials[1].emission = {1e3f, 2.5f, 1e-3f};
    scene.materials[2].reflectance = {0.9f, 0.1f, 0.3f};
    return scene;
}

}  // namespace luxel::test
