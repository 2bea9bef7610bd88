/// The scene of the atlas target: two boxes, so that a chart can be of the wrong object.
#pragma once
#include "tests/unit/unwrap/made_scene.h"

namespace luxel::fuzz {

inline Scene two_boxes() {
    Scene scene;
    test::add_object(scene, "box", test::box(1, 2, 3), 1);
    test::add_object(scene, "other box", test::box(1, 1, 1), 2);
    return scene;
}

}  // namespace luxel::fuzz
