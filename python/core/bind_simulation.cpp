#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include <simvis/error.h>
#include <simvis/pose.h>
#include "python/core/arguments.h"
#include "python/core/running_simulation.h"
#include "python/core/running_vector.h"
#include "python/core/settings.h"
#include "simvis/built_scene.h"
#include "simvis/nested_points.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

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

nb::object device(const RunningSimulation& running) {
  const DeviceInfo* const info = running.idle().diagnostics().device();
  if (info == nullptr) return nb::none();
  nb::dict described;
  described["name"] = info->name;
  described["type"] = info->type;
  described["driver"] = info->driver;
  described["api_version"] = info->api_version;
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

// Of each point its pose, or None, the frame in which its part or link stands, and the place of the one that moves it,
// or None.
nb::list nested(RunningSimulation& running, const std::vector<std::string>& names) {
  const Scene& scene = updated_scene(running.idle()).scene;
  for (const std::string& name : names) {
    if (!scene.has_insertion_point(name)) throw InputError(scene.objects().unknown("part or link", name));
  }
  nb::list all;
  for (const NestedPoint& point : nested_points(scene, names)) {
    all.append(
        nb::make_tuple(pose_or_none(point.world_from_point.has_value(), point.world_from_point.value_or(glm::dmat4(1))),
                       to_array(point.world_from_group), point.above));
  }
  return all;
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

[[noreturn]] void refuse_unnamed_step(nb::handle value) {
  const std::string seen = nb::cast<std::string>(nb::repr(value));
  throw InputError("step() has " + seen + " without a name, expected step(dt_s=" + seen + ") for a frame " + seen +
                   " s later, or for frame in run(" + seen + ") for so many frames");
}

void bind_frames(BoundClass<RunningSimulation>& core) {
  core.def(
          "__init__",
          [](RunningSimulation* self, const RunningVector& environments, std::size_t index) {
            SimulationDesc desc = environments.desc();
            desc.seed += index;
            new (self) RunningSimulation(environments.idle().environment(index), desc);
          },
          "environments"_a, "index"_a)
      .def(
          "__init__",
          [](RunningSimulation* self, nb::handle settings, nb::handle scene, const std::string& xml, nb::handle folder,
             const std::string& name) {
            if (!nb::isinstance<SimulationDesc>(settings)) {
              throw InputError("expected Simulation.load(FILE) or Simulation.from_string(XML)");
            }
            const auto& desc = nb::cast<const SimulationDesc&>(settings);
            scene.is_none() ? RunningSimulation::from_string(self, xml, desc, folder, name)
                            : RunningSimulation::load(self, scene, desc);
          },
          "settings"_a, "scene"_a = nb::none(), "xml"_a = "", "folder"_a = ".", "name"_a = "<string>",
          nb::sig("def __init__(self, settings: Settings, scene: str | None = None, xml: str = '', folder: str | "
                  "os.PathLike[str] = '.', name: str = '<string>') -> None"))
      .def("close", &RunningSimulation::close,
           "Ends the simulation. Arrays, scans and images that were taken of it stay. Every other call then raises.")
      .def_prop_ro("_closed", &RunningSimulation::is_closed)
      .def(
          "step",
          [](RunningSimulation& self, const nb::args& unnamed, nb::handle dt_s) {
            if (unnamed.size() > 0) refuse_unnamed_step(unnamed[0]);
            self.step(dt_s);
          },
          "unnamed"_a, "dt_s"_a = nb::none(), nb::sig("def step(self, *, dt_s: float | None = None) -> None"),
          "Makes one frame. With `dt_s` it is taken so many seconds after the one before.")
      .def("step_async", &RunningSimulation::step_async,
           "Begins a frame and returns while the device works on it; results are those of the frame before.")
      .def("finish", &RunningSimulation::finish, "Waits for the frame that step_async() began.")
      .def("skip_frame", &RunningSimulation::skip_frame, "Skips a frame: nothing is rendered or measured.")
      .def(
          "save_state",
          [](RunningSimulation& self) {
            const std::string state = self.save_state();
            return nb::bytes(state.data(), state.size());
          },
          nb::sig("def save_state(self) -> bytes"),
          "The state between two frames, with the history of sensors: restore_state() goes on from it to the bit.")
      .def(
          "restore_state",
          [](RunningSimulation& self, const nb::bytes& state) {
            self.restore_state({static_cast<const char*>(state.data()), state.size()});
          },
          "state"_a, nb::sig("def restore_state(self, state: bytes) -> None"),
          "Goes on from a state of save_state(), of this simulation or of one with the same scene and settings.")
      .def_prop_ro("time_s", &RunningSimulation::time_s,
                   "Simulated time of the last frame, seconds; NaN before the first.")
      .def(
          "_next_frame",
          [](const RunningSimulation& self) {
            const FrameTime next = self.idle().next_frame();
            return nb::make_tuple(next.index, next.time_ns);
          },
          nb::sig("def _next_frame(self) -> tuple[int, int]"))
      .def("explain", &RunningSimulation::explain, "What the last frame rendered and cast, why, and at what cost.")
      .def("_tree", &RunningSimulation::tree)
      .def("_price", &RunningSimulation::price, "sensors"_a, "frames"_a,
           nb::sig("def _price(self, sensors: collections.abc.Sequence[str], frames: int) -> list[dict[str, "
                   "typing.Any]]"));
}

void bind_values(BoundClass<RunningSimulation>& core) {
  core.def(
          "set",
          [](RunningSimulation& self, const std::string& element, const std::string& parameter, nb::handle value) {
            self.idle().set(element, parameter, number_of(element + "." + parameter, value));
          },
          "element"_a, "parameter"_a, "value"_a.none(),
          nb::sig("def set(self, element: str, parameter: str, value: float) -> None"),
          "Sets a parameter, in the unit of its element's table. It takes effect at the next step.")
      .def(
          "get",
          [](const RunningSimulation& self, const std::string& element, const std::string& parameter) {
            return self.idle().get(element, parameter);
          },
          "element"_a, "parameter"_a, "The value of a parameter, in the unit of its element's table.")
      .def("_set_pose", [](RunningSimulation& self, const std::string& element,
                           const Matrix& matrix) { self.idle().set_pose(element, to_matrix(matrix)); })
      .def(
          "execute",
          [](RunningSimulation& self, const std::string& xml, nb::handle folder, const std::string& name) {
            const std::string start = path_of("folder", folder);
            self.work([&](Simulation& simulation) { simulation.execute(xml, start, name); });
          },
          "xml"_a, "folder"_a = ".", "name"_a = "<string>",
          nb::sig("def execute(self, xml: str, folder: str | os.PathLike[str] = '.', name: str = '<string>') -> None"),
          "Executes more commands in the running scene: all of them or, if it raises, none.")
      .def("_enable",
           [](RunningSimulation& self, const std::string& sensor, bool on) { self.idle().enable(sensor, on); })
      .def("_nested_points", &nested,
           nb::sig("def _nested_points(self, names: collections.abc.Sequence[str]) -> list[tuple[typing.Any, "
                   "typing.Any, int | None]]"))
      .def(
          "track_part", [](RunningSimulation& self, const std::string& part) { self.idle().track_part(part); },
          "part"_a, "Makes part_pose() known for a part from the next step on.")
      .def(
          "part_pose",
          [](const RunningSimulation& self, const std::string& part) {
            glm::dmat4 pose;
            return pose_or_none(self.idle().part_pose(part, pose), pose);
          },
          "part"_a, nb::sig("def part_pose(self, part: str) -> numpy.typing.NDArray[numpy.float64] | None"),
          "(4, 4) float64 world_from_part as of the last step; call track_part() before. None: it is switched off.");
}

void bind_lists(BoundClass<RunningSimulation>& core) {
  core.def("_elements", &elements, nb::sig("def _elements(self) -> list[dict[str, typing.Any]]"))
      .def("_element_names", &element_names)
      .def("_sensors", &sensors, nb::sig("def _sensors(self) -> list[dict[str, typing.Any]]"))
      .def("_sensor_names", &RunningSimulation::sensor_names)
      .def_prop_ro("items", &items, nb::for_getter(nb::sig("def items(self, /) -> list[dict[str, typing.Any]]")),
                   "What beams can meet, by the numbers of `labels`: part, mesh, triangles, and the ids of ground "
                   "truth.")
      .def_prop_ro("objects", &objects, nb::for_getter(nb::sig("def objects(self, /) -> list[dict[str, typing.Any]]")),
                   "Parts, models, links, and the shapes that labels make objects: instance, parent, name, path, kind, "
                   "class, items.")
      .def_prop_ro(
          "measured",
          [](const RunningSimulation& self) {
            const std::span<const std::string> names = self.idle().measured();
            return std::vector<std::string>(names.begin(), names.end());
          },
          "Names of the sensors that measured in the last step.")
      .def_prop_ro(
          "warnings", [](const RunningSimulation& self) { return self.idle().warnings(); },
          "What loading and the steps so far warn of.")
      .def_prop_ro(
          "changes", [](const RunningSimulation& self) { return self.idle().parameters().changes(); },
          "The commands that were executed, in order; together they make the same scene.")
      .def_prop_ro("device", &device, nb::for_getter(nb::sig("def device(self, /) -> dict[str, str] | None")),
                   "The device that renders: name, type, driver, api_version; None while nothing has needed one.");
}

void bind_outlets(BoundClass<RunningSimulation>& core) {
  core.def(
          "record",
          [](RunningSimulation& self, nb::handle file, const std::vector<std::string>& topics, bool drop) {
            self.idle().record({.file = path_of("file", file), .topics = topics, .drop = drop});
          },
          "file"_a, "topics"_a = nb::tuple(), "drop"_a = false,
          nb::sig("def record(self, file: str | os.PathLike[str], topics: collections.abc.Sequence[str] = (), drop: "
                  "bool = False) -> None"),
          "Records the next steps as ROS 2 messages in an MCAP file, until finish_recording().")
      .def(
          "finish_recording",
          [](RunningSimulation& self) {
            const RecordReport report = self.work([](Simulation& simulation) { return simulation.finish_recording(); });
            nb::dict numbers;
            numbers["messages"] = report.messages;
            numbers["dropped"] = report.dropped;
            numbers["bytes"] = report.bytes;
            return numbers;
          },
          nb::sig("def finish_recording(self) -> dict[str, int]"),
          "Ends the recording: numbers of messages, of dropped measurements, and of bytes.")
      .def("record_page", &RunningSimulation::record_page, "file"_a,
           nb::sig("def record_page(self, file: str | os.PathLike[str]) -> None"),
           "The frames of the next steps become one HTML file, which a browser opens without a server; see "
           "finish_page().")
      .def("finish_page", &RunningSimulation::finish_page, "Writes the page that record_page() began.")
      .def(
          "warn", [](RunningSimulation& self, const std::string& text) { self.idle().warn(text); }, "text"_a,
          "Adds a warning of the program's own, which recordings and pages show. Raises if the simulation is strict.")
      .def(
          "serve",
          [](RunningSimulation& self, const std::string& name, const nb::sequence& folders) {
            ServeDesc desc{.name = name};
            for (const nb::handle folder : folders) desc.folders.emplace_back(path_of("a folder", folder));
            self.idle().serve(desc);
          },
          "name"_a, "folders"_a = nb::tuple(),
          nb::sig("def serve(self, name: str, folders: collections.abc.Sequence[str | os.PathLike[str]] = ()) -> "
                  "None"),
          "Serves the simulation to other processes of this machine, which find it by its name.")
      .def("_open_window", &RunningSimulation::open_window, "port"_a)
      .def("_close_window", &RunningSimulation::close_window)
      .def("_update_window", &RunningSimulation::update_window, "seconds"_a);
}

void bind_sensors(BoundClass<RunningSimulation>& core) {
  core.def("_attributes", &attributes, nb::sig("def _attributes(self, sensor: str) -> dict[str, str]"))
      .def("_images", &RunningSimulation::images)
      .def("_scan", &RunningSimulation::scan)
      .def(
          "_points",
          [](RunningSimulation& self, const std::string& sensor, const std::string& frame, const nb::object& out) {
            const KeptMeasurement last = self.measurement(sensor);
            const bool is_camera = std::ranges::count(last.arrays, OutputKind::image, &MeasuredArray::kind) > 0;
            return is_camera ? points_of(last, frame, out) : points_of(self.scan(sensor), frame, out);
          },
          "sensor"_a, "frame"_a, "out"_a.none(),
          nb::sig("def _points(self, sensor: str, frame: str, out: typing.Any) -> numpy.typing.NDArray[numpy.float64]"))
      .def("_image", &RunningSimulation::image)
      .def("_measurement", &RunningSimulation::measurement)
      .def("_value", [](const RunningSimulation& self, const std::string& sensor,
                        const std::string& name) { return self.idle().value(sensor, name); })
      .def("_reading", &reading,
           nb::sig("def _reading(self, sensor: str) -> tuple[list[str], numpy.typing.NDArray[numpy.float64]]"))
      .def(
          "_sensor_pose",
          [](const RunningSimulation& self, const std::string& sensor) {
            glm::dmat4 pose;
            return pose_or_none(self.idle().sensor_pose(sensor, pose), pose);
          },
          nb::sig("def _sensor_pose(self, sensor: str) -> numpy.typing.NDArray[numpy.float64] | None"));
}

}  // namespace

// simvis.Simulation inherits from the class. What begins with _ is for the package alone.
void bind_simulation(nb::module_& module) {
  bind_settings(module);

  BoundClass<RunningSimulation> core(module, "Core", "A running simulation, below simvis.Simulation.");
  bind_frames(core);
  bind_values(core);
  bind_lists(core);
  bind_outlets(core);
  bind_sensors(core);
}

}  // namespace simvis::python
