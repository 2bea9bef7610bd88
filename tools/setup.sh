#!/usr/bin/env bash
# Prepares a folder for building: system packages, xatlas, CMake configuration. Called by run.sh and test.sh.
#
# usage: tools/setup.sh run|test|reference|consumers
#   run        what `tools/run.sh` needs; configures build/release
#   test       also what the tests need; configures build/dev
#   reference  the Python environment with Mitsuba, in build/deps/reference
#   consumers  viewers and converters of glTF that tests/consumers runs, in build/deps/consumers
#
# Does nothing when it has already succeeded and neither this script nor its lists have changed.
# Packages are installed on Debian-like systems only; elsewhere it lists what is missing and stops.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages_file="$root/tools/packages.txt"
deps="$root/build/deps"

say() { printf 'setup: %s\n' "$*" >&2; }
fail() { printf 'setup: error: %s\n' "$1" >&2; shift; for line in "$@"; do printf '       %s\n' "$line" >&2; done; exit 3; }

usage() { sed -n '2,12s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; }

# Prints the lines "package kind name" of the named sections.
listed() {
    local section
    for section in "$@"; do
        awk -v want="[$section]" '/^#/ || NF == 0 { next } /^\[/ { on = ($0 == want); next } on' "$packages_file"
    done
}

# --- system packages ---------------------------------------------------------------------------------------------

missing_packages() {  # Debian packages of the sections that are not installed, one a line
    local name kind program
    listed "$@" | sort -u | while read -r name kind program; do
        [ "$kind" != any-program ] || ! command -v "$program" >/dev/null || continue
        if [ "$(dpkg-query -W -f='${db:Status-Status}\n' "$name" 2>/dev/null | head -n 1)" != installed ]; then
            printf '%s\n' "$name"
        fi
    done
}

install_packages() {
    local -a missing as_root=()
    mapfile -t missing < <(missing_packages "$@")
    [ "${#missing[@]}" -gt 0 ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            fail "system packages are missing and neither root nor sudo is there to install them. As root, run:" \
                "apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
        fi
        as_root=(sudo)
    fi
    say "installing ${#missing[@]} system packages: ${missing[*]}"
    "${as_root[@]}" apt-get update -q >&2 || fail "apt-get update failed; is the network there?"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" >&2 ||
        fail "these packages could not be installed (the project is made for Debian 12):" "${missing[@]}"
}

# On a system without apt: each thing is looked for by program, CMake package, pkg-config or Python module.
missing_here() {
    local package kind name
    local -a wanted=()
    while read -r package kind name; do
        case $kind in
            program | any-program) command -v "$name" >/dev/null || printf 'program %s (Debian: %s)\n' "$name" "$package" ;;
            python) python3 -c "import $name" 2>/dev/null || printf 'Python module %s (Debian: %s)\n' "$name" "$package" ;;
            pkg-config) pkg-config --exists "$name" 2>/dev/null ||
                printf 'pkg-config module %s (Debian: %s)\n' "$name" "$package" ;;
            cmake) wanted+=("$name:$package") ;;
            *) fail "tools/packages.txt: unknown kind '$kind' of $package" ;;
        esac
    done < <(listed "$@")
    local item
    for item in "${wanted[@]}"; do
        cmake_finds "${item%%:*}" || printf 'CMake package %s (Debian: %s)\n' "${item%%:*}" "${item#*:}"
    done
}

cmake_finds() {  # does find_package(NAME) succeed?
    command -v cmake >/dev/null || return 1
    local check="$deps/check/$1"
    mkdir -p "$check"
    printf 'cmake_minimum_required(VERSION 3.25)\nproject(check C CXX)\nfind_package(%s REQUIRED)\n' "$1" >"$check/CMakeLists.txt"
    cmake -S "$check" -B "$check/build" >"$check/log.txt" 2>&1
}

provide_packages() {
    if command -v apt-get >/dev/null && command -v dpkg-query >/dev/null; then
        install_packages "$@"
        return
    fi
    local -a missing
    mapfile -t missing < <(missing_here "$@")
    if [ "${#missing[@]}" -gt 0 ]; then
        fail "this system has no apt-get, so nothing was installed. Missing:" "${missing[@]}"
    fi
}

# --- xatlas ------------------------------------------------------------------------------------------------------

pip() {  # pip of the system's Python, else of an environment of our own
    if python3 -m pip --version >/dev/null 2>&1; then
        python3 -m pip "$@"
    else
        [ -x "$deps/pip/bin/python" ] || python3 -m venv "$deps/pip"
        "$deps/pip/bin/python" -m pip "$@"
    fi
}

provide_xatlas() {
    if [ -f "$deps/xatlas/xatlas.cpp" ] && [ -f "$deps/xatlas/xatlas.h" ]; then
        return
    fi
    if cmake_finds xatlas; then
        return
    fi
    say "getting xatlas (source package, hash pinned)"
    local folder="$deps/xatlas.download"
    rm -rf "$folder"
    mkdir -p "$folder"
    # Source for xatlas alone: pip hands these two options on to its build tools. With "--no-binary :all:" the pip of
    # Debian 12 builds those, and the tools that build them, from source: not over after eight minutes.
    pip --disable-pip-version-check --no-cache-dir download --quiet --require-hashes --no-deps \
        --only-binary :all: --no-binary xatlas -r "$root/tools/requirements-xatlas.txt" -d "$folder" >&2 ||
        fail "xatlas could not be downloaded." \
            "Either is the network gone, or the file is not the pinned one (see the message above)." \
            "Or put xatlas.h and xatlas.cpp into build/deps/xatlas by hand."
    tar -xzf "$folder"/xatlas-*.tar.gz -C "$folder" --strip-components=1 --no-same-owner
    mkdir -p "$folder/ready"
    cp "$folder"/extern/xatlas/source/xatlas/xatlas.{h,cpp} "$folder/ready/"
    rm -rf "$deps/xatlas"
    mv "$folder/ready" "$deps/xatlas"
    rm -rf "$folder"
}

# --- the parts ---------------------------------------------------------------------------------------------------

configure() {  # preset
    local -a launcher=()
    if command -v ccache >/dev/null; then
        launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    fi
    say "configuring build/$1"
    local log="$root/build/configure-$1.log"
    if ! (cd "$root" && cmake --preset "$1" "${launcher[@]}") >"$log" 2>&1; then
        tail -n 40 "$log" >&2
        fail "CMake could not configure build/$1; the whole output is in $log"
    fi
}

provide_reference() {
    local venv="$deps/reference"
    say "making the Python environment with Mitsuba in build/deps/reference"
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/python" -m pip --disable-pip-version-check --no-cache-dir install --quiet \
        -r "$root/tests/reference/requirements.txt" >&2 ||
        fail "the Python packages of tests/reference/requirements.txt could not be installed"
}

provide_consumers() {
    local folder="$deps/consumers"
    say "getting viewers and converters of glTF into build/deps/consumers"
    mkdir -p "$folder"
    cp "$root"/tests/consumers/package.json "$root"/tests/consumers/package-lock.json "$folder/"
    (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2) ||
        fail "the npm packages of tests/consumers/package.json could not be installed"
    rm -rf "$folder/blender"
    python3 -m venv "$folder/blender"
    "$folder/blender/bin/python" -m pip --disable-pip-version-check --no-cache-dir install --quiet \
        -r "$root/tests/consumers/requirements-blender.txt" >&2 ||
        fail "the Python packages of tests/consumers/requirements-blender.txt could not be installed"
}

fingerprint() {  # changes when set-up would do something else
    cat "$packages_file" "$root/tools/setup.sh" "$root/tools/requirements-xatlas.txt" \
        "$root/tests/reference/requirements.txt" "$root/tests/consumers/package-lock.json" \
        "$root/tests/consumers/requirements-blender.txt" "$root/CMakePresets.json" | sha256sum | cut -d ' ' -f 1
}

main() {
    local part=${1:-}
    local product stamp print
    case $part in
        run) product="$root/build/release/build.ninja" ;;
        test) product="$root/build/dev/build.ninja" ;;
        reference) product="$deps/reference/bin/python" ;;
        consumers) product="$deps/consumers/blender/bin/python" ;;
        -h | --help) usage; exit 0 ;;
        *) usage >&2; exit 1 ;;
    esac
    stamp="$root/build/setup-$part.stamp"
    print=$(fingerprint)
    if [ -e "$product" ] && [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$print" ]; then
        return 0
    fi
    mkdir -p "$deps"
    exec 9>"$root/build/setup.lock"
    flock 9
    case $part in
        run) provide_packages run; provide_xatlas; configure release ;;
        test) provide_packages run test; provide_xatlas; configure dev ;;
        reference) provide_packages run reference; provide_reference ;;
        consumers) provide_packages run consumers; provide_consumers ;;
    esac
    printf '%s\n' "$print" >"$stamp"
}

main "$@"
