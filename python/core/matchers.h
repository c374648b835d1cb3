// The matchers of <simvis/testing.h>, which simvis.testing calls.
#pragma once

#include <nanobind/nanobind.h>

namespace simvis::python {

void bind_matchers(nanobind::module_& module);

}  // namespace simvis::python
