#!/usr/bin/env bash
# Builds one configured folder; silent when there is nothing to do. Called by run.sh and test.sh.
#
# usage: tools/build.sh PRESET [TARGET ...]
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
preset=${1:?usage: tools/build.sh PRESET [TARGET ...]}
shift
folder="$root/build/$preset"

# Two calls at once must not build in one folder.
exec 9>"$folder/build.lock"
flock 9

# The compiler cache stays inside the build folder unless the user has chosen another place.
export CCACHE_DIR=${CCACHE_DIR:-$root/build/ccache}

ninja -C "$folder" "$@" | { grep -v -e '^ninja: no work to do' -e '^ninja: Entering directory' || true; } >&2
