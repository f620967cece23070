#pragma once

#include <nanobind/nanobind.h>

void bind_stagewise(nanobind::module_& m);
void bind_stagewise_v3(nanobind::module_& m);  // for x86-64-v3 processors; only there if built for x86-64
