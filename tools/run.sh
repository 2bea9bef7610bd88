#!/usr/bin/env bash
# Runs luxel; sets up and builds first what is not there yet. All arguments go to luxel.
#
# usage: tools/run.sh bake samples/cornell_box/cornell_box.gltf -o out/cornell_box.glb
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/tools/setup.sh" run
"$root/tools/build.sh" release luxel
exec "$root/build/release/tools/luxel/luxel" "$@"
