// The extension module simvis._core. The package around it is in python/simvis/.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <string_view>
#include <vector>

#include <simvis/device.h>
#include <simvis/location.h>
#include <simvis/plugin.h>
#include <simvis/sensor.h>
#include <simvis/version.h>
#include "python/core/arguments.h"
#include "python/core/errors.h"
#include "python/core/free_work.h"
#include "python/core/matchers.h"
#include "python/core/measurements.h"
#include "python/core/pickling.h"
#include "python/core/running_simulation.h"
#include "python/core/running_vector.h"
#include "python/core/written_elements.h"
#include "python/core/written_sensors.h"

namespace nb = nanobind;

NB_MODULE(_core_of_main, module) {
  nb::set_leak_warnings(false);  // classes that are registered as types live as long as the registry, with all they use
  simvis::python::translate_errors();
  simvis::python::bind_free_work(module);
  simvis::python::bind_measurements(module);
  simvis::python::bind_matchers(module);
  simvis::python::bind_pickling(module);
  simvis::python::bind_vector(module);
  simvis::python::bind_simulation(module);
  simvis::python::bind_written_elements(module);
  simvis::python::bind_written_sensors(module);
  module.def("version", [] { return std::string(simvis::version()); });
  module.def(
      "suggestion",
      [](const std::string& seen, const std::vector<std::string>& known) {
        return simvis::suggestion(seen, std::vector<std::string_view>(known.begin(), known.end()));
      },
      nb::arg("seen"), nb::arg("known"), "What a message says of the known name that is nearest; empty: none is near.");
  module.def(
      "output_table",
      [] {
        nb::list rows;
        for (const simvis::SensorType* const type : simvis::sensor_types()) {
          for (const simvis::OutputSpec& output : simvis::all_outputs(*type)) {
            if (output.derived) continue;  // measurements do not have it
            nb::dict row;
            row["type"] = std::string(type->name);
            row["name"] = output.name;
            row["kind"] = std::string(to_string(output.kind));
            row["number"] = std::string(to_string(output.value_type));
            rows.append(row);
          }
        }
        return rows;
      },
      "The outputs of each sensor type, as far as measurements have them.",
      nb::sig("def output_table() -> list[dict[str, str]]"));
  module.def(
      "load_plugin", [](nb::handle file) { simvis::load_plugin(simvis::python::path_of("file", file)); },
      nb::arg("file"), nb::call_guard<simvis::python::ModuleCall>(),
      "Loads a shared library with more elements and sensors, for the rest of the program.",
      nb::sig("def load_plugin(file: str) -> None"));
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

// Python calls this for each interpreter. The registry of types and the state of nanobind belong to one, which the
// initialisation of the module in another would replace.
extern "C" NB_EXPORT PyObject* PyInit__core();
extern "C" PyObject* PyInit__core() {
  if (PyInterpreterState_GetID(PyInterpreterState_Get()) == 0) return PyInit__core_of_main();
  PyErr_SetString(
      PyExc_ImportError,
      "simvis works in the main interpreter only, expected no subinterpreter; simvis.map() starts processes "
      "that load it");
  return nullptr;
}
