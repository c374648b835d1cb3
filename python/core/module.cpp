// The extension module simvis._core. The package around it is in python/simvis/.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <simvis/device.h>
#include <simvis/plugin.h>
#include <simvis/sensor.h>
#include <simvis/version.h>
#include "python/core/errors.h"
#include "python/core/measurements.h"
#include "python/core/pickling.h"
#include "python/core/running_simulation.h"
#include "python/core/written_elements.h"
#include "python/core/written_sensors.h"

namespace nb = nanobind;

NB_MODULE(_core, module) {
  nb::set_leak_warnings(false);  // classes that are registered as types live as long as the registry, with all they use
  simvis::python::translate_errors();
  simvis::python::bind_measurements(module);
  simvis::python::bind_pickling(module);
  simvis::python::bind_simulation(module);
  simvis::python::bind_written_elements(module);
  simvis::python::bind_written_sensors(module);
  module.def("version", [] { return std::string(simvis::version()); });
  module.def(
      "load_plugin", [](const std::string& file) { simvis::load_plugin(file); }, nb::arg("file"),
      "Loads a shared library with more elements and sensors, for the rest of the program.");
  module.def(
      "list_devices",
      [] {
        nb::list all;
        for (const simvis::DeviceInfo& device : simvis::list_devices()) {
          nb::dict row;
          row["name"] = device.name;
          row["type"] = device.type;
          row["driver"] = device.driver;
          row["unusable"] = device.unusable;
          all.append(row);
        }
        return all;
      },
      "The Vulkan devices of this machine: name, type, driver, and why SimVis cannot run on one (unusable).",
      nb::sig("def list_devices() -> list[dict[str, str]]"));
}
