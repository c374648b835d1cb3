// Sensors that are written in Python, as types that scenes name.
#pragma once

#include <nanobind/nanobind.h>

namespace simvis::python {

void bind_written_sensors(nanobind::module_& module);

}  // namespace simvis::python
