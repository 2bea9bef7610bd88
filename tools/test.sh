#!/usr/bin/env bash
# Builds and runs the tests; sets up first what is not there yet.
#
# usage: tools/test.sh [--all] [CTEST OPTIONS]
#   --all   the long tests too
#   else    options of ctest, such as -R NAME
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
selection=(-LE '^long$')
if [ "${1:-}" = --all ]; then
    selection=()
    shift
fi
"$root/tools/setup.sh" test
[ -n "${LUXEL_REFERENCE_PYTHON:-}" ] || "$root/tools/setup.sh" reference   # lightmaps are held against Mitsuba
"$root/tools/build.sh" dev
export PYTHONDONTWRITEBYTECODE=1
exec ctest --test-dir "$root/build/dev" --output-on-failure --parallel "$(nproc)" "${selection[@]}" "$@"
