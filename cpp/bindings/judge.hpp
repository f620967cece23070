#pragma once

#include <nanobind/nanobind.h>

void bind_judge(nanobind::module_& m);
