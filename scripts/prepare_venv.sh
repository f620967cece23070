#!/bin/sh
# Makes the virtual environment, or says in one sentence what the machine lacks: prepare_venv.sh PYTHON VENV
set -eu
python=$1
venv=$2

lacks() {
    printf 'tightspot: %s\n' "$1" >&2
    exit 1
}

command -v "$python" >/dev/null 2>&1 ||
    lacks "Python 3.11 or newer is needed and '$python' was not found; install it or name one: make PYTHON=python3.12"
version=$("$python" -c 'import platform; print(platform.python_version())')
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    lacks "Python 3.11 or newer is needed and '$python' is $version; name a newer one: make PYTHON=python3.12"
"$python" -c 'import ensurepip, venv' 2>/dev/null ||
    lacks "'$python' cannot make virtual environments; install its venv module, e.g. 'apt install python3-venv'"
"$python" -c 'import os, sys, sysconfig; sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))' ||
    lacks "'$python' lacks its C headers; install them, e.g. 'apt install python3-dev'"
for compiler in "${CXX:-c++}" g++ clang++ none; do
    if command -v "${compiler%% *}" >/dev/null 2>&1; then break; fi
done
[ "$compiler" != none ] || lacks "a C++17 compiler is needed; install one, e.g. 'apt install g++'"

if "$venv/bin/python" -c 'import pip, sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then
    exit 0
fi
echo "making $venv with Python $version"
"$python" -m venv --clear "$venv"
