#pragma once

#include <nanobind/nanobind.h>

void bind_stagewise(nanobind::module_& m);
