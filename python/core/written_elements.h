// Elements that are written in Python, as types that scenes name.
#pragma once

#include <nanobind/nanobind.h>

namespace simvis::python {

/// Also what the constructors of elements and sensors get.
void bind_written_elements(nanobind::module_& module);

}  // namespace simvis::python
