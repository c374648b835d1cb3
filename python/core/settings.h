// simvis._core.Settings: the settings of a simulation, from the keywords that program/options/settings.h lists.
#pragma once

#include <nanobind/nanobind.h>

namespace simvis::python {

void bind_settings(nanobind::module_& module);

}  // namespace simvis::python
