"""include_arrows.py finds planted faults and lets allowed includes pass."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools", "scripts"))
import include_arrows  # noqa: E402


class IncludeArrows(unittest.TestCase):
    def check(self, files):
        with tempfile.TemporaryDirectory() as root:
            for path, text in files.items():
                os.makedirs(os.path.dirname(os.path.join(root, path)), exist_ok=True)
                with open(os.path.join(root, path), "w", encoding="utf-8") as file:
                    file.write(text)
            return include_arrows.check_tree(root)

    def test_allowed(self):
        self.assertEqual([], self.check({
            "formats/base/error.h": "#include <string>\n", "baker/core/vec.h": '#include "formats/base/error.h"\n',
            "baker/scene/scene.h": '#include "baker/core/vec.h"\n#include "formats/gltf/scene_record.h"\n',
            "baker/trace/tracer.cpp": "#include <embree3/rtcore.h>\n", "formats/base/hash.cpp": "#include <xxhash.h>\n",
            "tools/luxel/main.cpp": '#include <CLI/CLI.hpp>\n#include "baker/bake/bake.h"\n'}))

    def test_upward_arrow(self):
        found = self.check({"baker/core/vec.h": '#include <cmath>\n#include "baker/scene/scene.h"\n'})
        self.assertEqual(["baker/core/vec.h:2: baker/core must not know baker/scene"], found)

    def test_store_and_solver_do_not_know_each_other(self):
        self.assertEqual(1, len(self.check({"baker/store/a.h": '#include "baker/solver/solver.h"\n'})))
        self.assertEqual(1, len(self.check({"baker/solver/a.h": '#include "baker/store/pooling.h"\n'})))

    def test_library_outside_its_place(self):
        for header in ("<xatlas.h>", '"xatlas.h"', "<embree4/rtcore.h>", "<OpenImageIO/imageio.h>", "<OpenEXR/ImfHeader.h>",
                       "<png.h>", "<turbojpeg.h>", "<zstd.h>", "<draco/core/x.h>"):
            with self.subTest(header):
                self.assertEqual(1, len(self.check({"baker/light/a.cpp": f"#include {header}\n"})))

    def test_gltf_reader_is_for_the_ends(self):
        self.assertEqual(1, len(self.check({"baker/patches/a.cpp": '#include "formats/gltf/gltf_in.h"\n'})))
        self.assertEqual([], self.check({"baker/patches/a.cpp": '#include "formats/gltf/scene_record.h"\n'}))
        self.assertEqual(1, len(self.check({"baker/core/a.cpp": '#include "formats/gltf/scene_record.h"\n'})))

    def test_path_not_from_the_root(self):
        self.assertEqual(1, len(self.check({"baker/light/a.cpp": '#include "light/b.h"\n'})))


if __name__ == "__main__":
    unittest.main()
