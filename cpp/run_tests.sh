#!/bin/sh
# Builds and runs the core's C++ tests under sanitizers: cpp/run_tests.sh [BUILD_DIR]
# Uses cmake and ninja from .venv if the system has none.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
build=${1:-$root/build/cpp-tests}
PATH=$PATH:$root/.venv/bin
for tool in cmake c++; do
    if ! command -v "$tool" >/dev/null; then
        echo "The C++ tests need $tool; install it, e.g. \`apt install cmake g++\`, and try again." >&2
        exit 1
    fi
done
generator=
if command -v ninja >/dev/null; then generator="-G Ninja"; fi
# shellcheck disable=SC2086
cmake -S "$root/cpp/tests" -B "$build" $generator --log-level=WARNING >/dev/null
cmake --build "$build"
"$build/core_tests"
