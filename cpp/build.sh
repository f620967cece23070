#!/bin/sh
# Builds tightspot._core into src/tightspot for development: cpp/build.sh [PYTHON]
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
python=${1:-$root/.venv/bin/python}
PATH=$(dirname -- "$python"):$PATH
generator=
if command -v ninja >/dev/null; then generator="-G Ninja"; fi
# shellcheck disable=SC2086
cmake -S "$root" -B "$root/build/core" $generator -DPython_EXECUTABLE="$python" -DTIGHTSPOT_IN_PLACE=ON --log-level=WARNING
cmake --build "$root/build/core"
