#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <simvis/pose.h>
#include "python/core/arguments.h"
#include "python/core/running_simulation.h"
#include "python/core/settings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

glm::dmat4 to_matrix(const nb::ndarray<const double, nb::shape<4, 4>, nb::device::cpu>& rows) {
  glm::dmat4 matrix;
  for (glm::length_t row = 0; row < 4; ++row) {
    for (glm::length_t column = 0; column < 4; ++column) {
      matrix[column][row] = rows(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
    }
  }
  return matrix;
}

nb::str text(std::string_view view) { return nb::str(view.data(), view.size()); }

nb::dict describe(const AttributeSpec& spec, double value) {
  nb::dict row;
  row["name"] = text(spec.name);
  row["value"] = value;
  row["unit"] = text(spec.unit);
  row["text"] = text(spec.text);
  row["min"] = spec.min;
  row["max"] = spec.max;
  return row;
}

nb::list elements(const RunningSimulation& running) {
  const Parameters& parameters = running.idle().parameters();
  nb::list all;
  for (const ElementDescriptor& element : parameters.elements()) {
    if (element.removed) continue;
    nb::list rows;
    for (std::size_t i = 0; i < element.parameters.size(); ++i) {
      rows.append(describe(element.parameters[i], parameters.values()[element.first_value + i]));
    }
    nb::dict described;
    described["name"] = element.name;
    described["type"] = element.type;
    described["insert_at"] = element.insertion_point;
    described["parameters"] = rows;
    all.append(described);
  }
  return all;
}

nb::list sensors(const RunningSimulation& running) {
  nb::list all;
  for (const SensorInfo& sensor : running.idle().sensors()) {
    nb::dict described;
    described["name"] = sensor.name;
    described["type"] = sensor.type;
    described["method"] = sensor.method;
    described["frames"] = sensor.frames;
    described["enabled"] = sensor.enabled;
    described["rate_hz"] = sensor.rate_hz;
    described["effects"] = nb::cast(sensor.effects);
    all.append(described);
  }
  return all;
}

nb::dict attributes(const RunningSimulation& running, const std::string& sensor) {
  nb::dict values;
  for (const CommandAttribute& each : running.idle().diagnostics().command(sensor).attributes) {
    values[each.name.c_str()] = each.value;
  }
  return values;
}

nb::dict device(const RunningSimulation& running) {
  const DeviceInfo& info = running.idle().diagnostics().device();
  nb::dict described;
  described["name"] = info.name;
  described["type"] = info.type;
  described["driver"] = info.driver;
  described["api_version"] = info.api_version;
  return described;
}

nb::object pose_or_none(bool there, const glm::dmat4& pose) { return there ? to_array(pose) : nb::none(); }

// Names of the columns, and the rows.
nb::tuple reading(const RunningSimulation& running, const std::string& sensor) {
  const Reading& reading = running.idle().reading(sensor);
  nb::list names;
  for (const MeasuredArray& column : reading.arrays) names.append(column.name);
  return nb::make_tuple(names, to_array(reading.values(), reading.rows(), reading.arrays.size()));
}

nb::list items(const RunningSimulation& running) {
  nb::list all;
  for (const SceneItem& item : running.idle().items()) {
    nb::dict row;
    row["part"] = item.part;
    row["mesh"] = item.mesh;
    row["triangles"] = item.triangles;
    row["instance"] = item.instance;
    row["semantic"] = item.semantic;
    row["label"] = item.label;
    row["shape"] = item.shape;
    all.append(row);
  }
  return all;
}

nb::list objects(const RunningSimulation& running) {
  nb::list all;
  for (const SceneObject& object : running.idle().objects()) {
    nb::dict row;
    row["instance"] = object.instance;
    row["parent"] = object.parent;
    row["name"] = object.name;
    row["path"] = object.path;
    row["kind"] = std::string(to_string(object.kind));
    row["semantic"] = object.semantic;
    row["label"] = object.label;
    nb::list items;
    for (const ObjectSurface& surface : object.surfaces) items.append(surface.item);
    row["items"] = items;
    all.append(row);
  }
  return all;
}

std::vector<std::string> element_names(const RunningSimulation& running) {
  std::vector<std::string> names;
  for (const ElementDescriptor& element : running.idle().parameters().elements()) {
    if (!element.removed) names.push_back(element.name);
  }
  return names;
}

}  // namespace

void bind_simulation(nb::module_& module) {
  bind_settings(module);

  BoundClass<RunningSimulation>(module, "Core", "A running simulation, below simvis.Simulation.")
      .def_static("load", &RunningSimulation::load, "scene"_a, "settings"_a, nb::rv_policy::take_ownership)
      .def_static("from_string", &RunningSimulation::from_string, "xml"_a, "settings"_a, "folder"_a, "name"_a,
                  nb::rv_policy::take_ownership)
      .def("close", &RunningSimulation::close)
      .def_prop_ro("closed", &RunningSimulation::is_closed)
      .def("step", &RunningSimulation::step, "dt_s"_a = nb::none())
      .def("step_async", &RunningSimulation::step_async)
      .def("finish", &RunningSimulation::finish)
      .def("skip_frame", &RunningSimulation::skip_frame)
      .def_prop_ro("time_s", &RunningSimulation::time_s)
      .def(
          "next_frame",
          [](const RunningSimulation& self) {
            const FrameTime next = self.idle().next_frame();
            return nb::make_tuple(next.index, next.time_ns);
          },
          nb::sig("def next_frame(self) -> tuple[int, int]"))
      .def("set", [](RunningSimulation& self, const std::string& element, const std::string& parameter,
                     double value) { self.idle().set(element, parameter, value); })
      .def("get", [](const RunningSimulation& self, const std::string& element,
                     const std::string& parameter) { return self.idle().get(element, parameter); })
      .def("set_pose",
           [](RunningSimulation& self, const std::string& element,
              const nb::ndarray<const double, nb::shape<4, 4>, nb::device::cpu>& matrix) {
             self.idle().set_pose(element, to_matrix(matrix));
           })
      .def("execute",
           [](RunningSimulation& self, const std::string& xml, nb::handle folder, const std::string& name) {
             const std::string start = path_of("folder", folder);
             self.work([&](Simulation& simulation) { simulation.execute(xml, start, name); });
           })
      .def("enable",
           [](RunningSimulation& self, const std::string& sensor, bool on) { self.idle().enable(sensor, on); })
      .def("elements", &elements, nb::sig("def elements(self) -> list[dict[str, typing.Any]]"))
      .def("element_names", &element_names)
      .def("sensors", &sensors, nb::sig("def sensors(self) -> list[dict[str, typing.Any]]"))
      .def("sensor_names", &RunningSimulation::sensor_names)
      .def("attributes", &attributes, nb::sig("def attributes(self, sensor: str) -> dict[str, str]"))
      .def("images", &RunningSimulation::images)
      .def("measured",
           [](const RunningSimulation& self) {
             const std::span<const std::string> names = self.idle().measured();
             return std::vector<std::string>(names.begin(), names.end());
           })
      .def("scan", &RunningSimulation::scan)
      .def("image", &RunningSimulation::image)
      .def("measurement", &RunningSimulation::measurement)
      .def("value", [](const RunningSimulation& self, const std::string& sensor,
                       const std::string& name) { return self.idle().value(sensor, name); })
      .def(
          "sensor_pose",
          [](const RunningSimulation& self, const std::string& sensor) {
            glm::dmat4 pose;
            return pose_or_none(self.idle().sensor_pose(sensor, pose), pose);
          },
          nb::sig("def sensor_pose(self, sensor: str) -> numpy.typing.NDArray[numpy.float64] | None"))
      .def("track_part", [](RunningSimulation& self, const std::string& part) { self.idle().track_part(part); })
      .def(
          "part_pose",
          [](const RunningSimulation& self, const std::string& part) {
            glm::dmat4 pose;
            return pose_or_none(self.idle().part_pose(part, pose), pose);
          },
          nb::sig("def part_pose(self, part: str) -> numpy.typing.NDArray[numpy.float64] | None"))
      .def("warnings", [](const RunningSimulation& self) { return self.idle().warnings(); })
      .def("changes", [](const RunningSimulation& self) { return self.idle().parameters().changes(); })
      .def("record",
           [](RunningSimulation& self, nb::handle file, const std::vector<std::string>& topics, bool drop) {
             self.idle().record({.file = path_of("file", file), .topics = topics, .drop = drop});
           })
      .def(
          "finish_recording",
          [](RunningSimulation& self) {
            const RecordReport report = self.work([](Simulation& simulation) { return simulation.finish_recording(); });
            return nb::make_tuple(report.messages, report.dropped, report.bytes);
          },
          nb::sig("def finish_recording(self) -> tuple[int, int, int]"))
      .def("record_page", &RunningSimulation::record_page, "file"_a)
      .def("finish_page", &RunningSimulation::finish_page)
      .def("warn", [](RunningSimulation& self, const std::string& text) { self.idle().warn(text); })
      .def(
          "serve",
          [](RunningSimulation& self, const std::string& name, const nb::list& folders) {
            ServeDesc desc{.name = name};
            for (const nb::handle folder : folders) desc.folders.emplace_back(path_of("a folder", folder));
            self.idle().serve(desc);
          },
          nb::sig("def serve(self, name: str, folders: collections.abc.Sequence[str]) -> None"))
      .def("open_window", &RunningSimulation::open_window, "port"_a)
      .def("close_window", &RunningSimulation::close_window)
      .def("update_window", &RunningSimulation::update_window, "seconds"_a)
      .def("reading", &reading,
           nb::sig("def reading(self, sensor: str) -> tuple[list[str], numpy.typing.NDArray[numpy.float64]]"))
      .def("items", &items, nb::sig("def items(self) -> list[dict[str, typing.Any]]"))
      .def("objects", &objects, nb::sig("def objects(self) -> list[dict[str, typing.Any]]"))
      .def("device", &device, nb::sig("def device(self) -> dict[str, str]"))
      .def("explain", &RunningSimulation::explain)
      .def("tree", &RunningSimulation::tree)
      .def("price", &RunningSimulation::price, "sensors"_a, "frames"_a,
           nb::sig(
               "def price(self, sensors: collections.abc.Sequence[str], frames: int) -> list[dict[str, typing.Any]]"));
}

}  // namespace simvis::python
