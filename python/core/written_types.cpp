#include "python/core/written_types.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <simvis/element.h>
#include <simvis/pose.h>
#include <simvis/sensor.h>
#include "python/core/errors.h"
#include "python/core/measurements.h"
#include "python/core/running_simulation.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

/// A type that Python code describes. It is never destroyed: the registry refers to it for the rest of the program.
struct WrittenType {
  nb::object python_class;
  std::string name, summary, notes;
  std::deque<std::string> texts;  // of the rows
  std::vector<AttributeSpec> rows;
  std::vector<std::string_view> live, values;
};

std::map<std::string, WrittenType*, std::less<>>& element_classes() {
  static auto* const all = new std::map<std::string, WrittenType*, std::less<>>;
  return *all;
}

std::map<std::string, WrittenType*, std::less<>>& sensor_classes() {
  static auto* const all = new std::map<std::string, WrittenType*, std::less<>>;
  return *all;
}

/// An object of Python that code without the interpreter's lock owns.
class Owned {
 public:
  explicit Owned(nb::object object) : object_(std::move(object)) {}
  ~Owned() {
    if (!Py_IsInitialized()) {
      object_.release();
      return;
    }
    const nb::gil_scoped_acquire locked;
    object_.reset();
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  nb::handle operator*() const { return object_; }

 private:
  nb::object object_;
};

thread_local bool scene_may_change = false;  // Python code runs that an element's constructor or update() called

class SceneChange {
 public:
  SceneChange() : before_(std::exchange(scene_may_change, true)) {}
  ~SceneChange() { scene_may_change = before_; }
  SceneChange(const SceneChange&) = delete;
  SceneChange& operator=(const SceneChange&) = delete;

 private:
  bool before_;
};

void require_scene_change() {
  if (!scene_may_change) throw InputError("the scene can be changed in an element's __init__() and update() only");
}

/// A transform that an element inserted.
struct InsertedTransform {
  std::shared_ptr<Transform> node;
};

nb::object value_of(const AttributeValues& values, const AttributeSpec& row) {
  if (!values.is_set(row.name)) return nb::none();
  switch (row.kind) {
    case AttributeKind::number:
      return nb::float_(values.number(row.name));
    case AttributeKind::integer:
      return nb::int_(values.integer(row.name));
    case AttributeKind::choice:
      return nb::cast(values.choice(row.name));
    case AttributeKind::vector: {
      const double(&v)[3] = values.vector(row.name);
      return nb::make_tuple(v[0], v[1], v[2]);
    }
    default:
      return nb::cast(values.text(row.name));
  }
}

nb::dict values_of(const AttributeValues& values, const std::vector<AttributeSpec>& rows) {
  nb::dict all;
  for (const AttributeSpec& row : rows) all[nb::str(row.name.data(), row.name.size())] = value_of(values, row);
  return all;
}

/// What the constructor of an element or a sensor gets.
struct CreationContext {
  std::string name;
  nb::dict attributes;
  const ElementContext* element = nullptr;  // null: a sensor, or the constructor has returned
};

const ElementContext& element_context(const CreationContext& creation) {
  if (creation.element != nullptr) return *creation.element;
  throw InputError("this belongs into the __init__() of an element");
}

InsertedTransform insert_transform(const CreationContext& creation) {
  const ElementContext& context = element_context(creation);
  InsertedTransform transform{std::make_shared<Transform>()};
  context.scene.insert(context.command, transform.node);
  return transform;
}

using Positions = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Triangles = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

InsertedTransform insert_mesh(const CreationContext& creation, const Positions& positions, const Triangles& triangles,
                              const std::vector<float>& color) {
  const ElementContext& context = element_context(creation);
  if (color.size() != 3) throw InputError("color has " + std::to_string(color.size()) + " numbers, expected 3");
  auto mesh = std::make_shared<Mesh>();
  mesh->name = creation.name;
  for (std::size_t i = 0; i < positions.shape(0); ++i) {
    const glm::vec3 position(positions(i, 0), positions(i, 1), positions(i, 2));
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(position[axis])) throw InputError("positions: vertex " + std::to_string(i) + " is not finite");
    }
    mesh->positions.push_back(position);
  }
  mesh->attributes.resize(mesh->positions.size());
  for (std::size_t i = 0; i < triangles.shape(0); ++i) {
    glm::vec3 corners[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = triangles(i, c);
      if (vertex >= mesh->positions.size()) {
        throw InputError("triangles: vertex " + std::to_string(vertex) + " of triangle " + std::to_string(i) +
                         " does not exist, expected less than " + std::to_string(mesh->positions.size()));
      }
      mesh->indices.push_back(vertex);
      corners[c] = mesh->positions[vertex];
    }
    const glm::vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    for (std::size_t c = 0; c < 3; ++c) mesh->attributes[triangles(i, c)].normal += normal;
  }
  for (auto& attributes : mesh->attributes) {
    const float length = glm::length(attributes.normal);
    attributes.normal = length > 0 ? attributes.normal / length : glm::vec3(0, 0, 1);
  }
  if (mesh->indices.empty()) throw InputError("triangles: there are none, expected at least one");
  compute_bounds(*mesh);
  auto material = std::make_shared<Material>();
  material->base_color = glm::vec4(color[0], color[1], color[2], 1);
  material->double_sided = true;
  InsertedTransform transform{std::make_shared<Transform>()};
  auto group = std::make_shared<Separator>();
  group->add(transform.node);
  group->add(std::make_shared<MaterialNode>(material));
  group->add(std::make_shared<Shape>(mesh));
  context.scene.insert(context.command, group);
  return transform;
}

void set_matrix(const InsertedTransform& transform,
                const nb::ndarray<const double, nb::shape<4, 4>, nb::device::cpu>& rows) {
  require_scene_change();
  glm::dmat4 matrix;
  for (glm::length_t row = 0; row < 4; ++row) {
    for (glm::length_t column = 0; column < 4; ++column) {
      const double value = rows(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
      if (!std::isfinite(value)) throw InputError("the matrix has a number that is not finite");
      matrix[column][row] = value;
    }
  }
  transform.node->set_matrix(matrix);
}

void set_pose(const InsertedTransform& transform, double x, double y, double z, double roll, double pitch, double yaw) {
  require_scene_change();
  for (const double value : {x, y, z, roll, pitch, yaw}) {
    if (!std::isfinite(value)) throw InputError("the pose has a number that is not finite");
  }
  transform.node->set_matrix(matrix_from_degrees({x, y, z}, roll, pitch, yaw));
}

// Makes the Python object of a command. What its constructor raises becomes an error at the command.
nb::object make(const WrittenType& type, CreationContext& creation, const Command& command) {
  const nb::object given = nb::cast(&creation, nb::rv_policy::copy);
  CreationContext& copy = nb::cast<CreationContext&>(given);
  struct End {
    CreationContext& creation;
    ~End() { creation.element = nullptr; }
  } const end{copy};
  const SceneChange change;
  try {
    return type.python_class(given);
  } catch (nb::python_error& error) {
    const std::string reason = nb::cast<std::string>(nb::str(nb::handle(error.value())));
    const std::string kind = nb::cast<std::string>(nb::handle(error.type()).attr("__name__"));
    keep_error(std::move(error));
    fail_at(command.where, type.name + ": its Python class raised " + kind + ": " + reason);
  }
}

class WrittenElement : public Element {
 public:
  WrittenElement(const WrittenType& type, nb::object object) : type_(type), object_(std::move(object)) {}

  void update(ParameterView values) override {
    const nb::gil_scoped_acquire locked;
    const SceneChange change;
    try {
      nb::dict named;
      for (std::size_t i = 0; i < values.size(); ++i) {
        named[nb::str(type_.live[i].data(), type_.live[i].size())] = values[i];
      }
      (*object_).attr("update")(named);
    } catch (nb::python_error& error) {
      keep_error(std::move(error));
    }
  }

 private:
  const WrittenType& type_;
  Owned object_;
};

std::unique_ptr<Element> create_element(const ElementContext& context) {
  const WrittenType& type = *element_classes().at(context.command.require("type").value);
  const nb::gil_scoped_acquire locked;
  CreationContext creation{context.command.require("name").value, values_of(context.attributes, type.rows), &context};
  return std::make_unique<WrittenElement>(type, make(type, creation, context.command));
}

/// A sensor that casts rays and whose Python code turns the hits into numbers.
class WrittenSensor : public Sensor {
 public:
  WrittenSensor(const WrittenType& type, std::string name, nb::object object)
      : type_(type), name_(std::move(name)), object_(std::move(object)) {
    for (const std::string_view value : type.values) {
      values_.push_back({value, std::numeric_limits<double>::quiet_NaN()});
    }
    read_directions();
  }

  void begin(const FrameTime& time) override { time_ = time; }
  void plan(const glm::dmat4& world_from_sensor, const DrawList&, FramePlan& plan) override {
    world_from_sensor_ = world_from_sensor;
    plan.casts.push_back({.name = name_, .reason = "rays of sensor " + name_, .max_rays = directions_.size()});
  }
  void collect(const FrameTime&, const FramePlan&, std::span<const PassResult>) override {}
  void cast(RayCaster& rays) override {
    hits_.resize(directions_.size());
    rays.cast(world_from_sensor_, directions_, hits_);
    const nb::gil_scoped_acquire locked;
    try {
      take(measure());
    } catch (nb::python_error& error) {
      keep_error(std::move(error));
    }
  }
  std::span<const NamedValue> values() const override { return values_; }
  void write(OutputSink& sink) const override {
    std::vector<TableColumn> columns;
    std::vector<double> row;
    for (const NamedValue& value : values_) {
      columns.push_back({std::string(value.name), "%.9g"});
      row.push_back(value.value);
    }
    sink.rows(columns, row);
  }
  std::string method() const override { return "python"; }

 private:
  void read_directions() {
    nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu> given;
    const nb::object directions = nb::module_::import_("numpy").attr("asarray")(
        (*object_).attr("directions"), nb::arg("dtype") = "float64", nb::arg("order") = "C");
    if (!nb::try_cast(directions, given) || given.shape(0) == 0) {
      throw InputError("sensor " + in_quotes(name_) + ": expected `directions`, an (n, 3) array of unit vectors");
    }
    for (std::size_t i = 0; i < given.shape(0); ++i) {
      const glm::dvec3 direction(given(i, 0), given(i, 1), given(i, 2));
      const double length = glm::length(direction);
      if (!(std::abs(length - 1) < 1e-6)) {
        throw InputError("sensor " + in_quotes(name_) + ": direction " + std::to_string(i) + " has length " +
                         format_number(length) + ", expected 1");
      }
      directions_.push_back(direction / length);
    }
  }
  nb::object measure() const {
    const nb::object empty = nb::module_::import_("numpy").attr("empty");
    nb::object ranges = empty(hits_.size());
    nb::ndarray<double, nb::shape<-1>, nb::device::cpu> array;
    if (!nb::try_cast(ranges, array)) throw InputError("numpy.empty() gave no array of float64");
    for (std::size_t i = 0; i < hits_.size(); ++i) array(i) = hits_[i].range_m;
    return (*object_).attr("measure")(ranges, static_cast<double>(time_.time_ns) / 1e9);
  }
  // All or nothing.
  void take(const nb::object& measured) {
    const nb::object named = nb::module_::import_("builtins").attr("dict")(measured);
    std::vector<NamedValue> values = values_;
    for (NamedValue& value : values) {
      value.value = nb::cast<double>(nb::float_(named[nb::str(value.name.data(), value.name.size())]));
    }
    values_ = std::move(values);
  }

  const WrittenType& type_;
  std::string name_;
  Owned object_;
  std::vector<glm::dvec3> directions_;
  std::vector<RayHit> hits_;
  std::vector<NamedValue> values_;
  FrameTime time_;
  glm::dmat4 world_from_sensor_{1.0};
};

std::unique_ptr<Sensor> create_sensor(const SensorContext& context) {
  const WrittenType& type = *sensor_classes().at(context.command.require("type").value);
  const nb::gil_scoped_acquire locked;
  CreationContext creation{context.name, values_of(context.attributes, type.rows)};
  nb::object object = make(type, creation, context.command);
  try {
    return std::make_unique<WrittenSensor>(type, context.name, std::move(object));
  } catch (nb::python_error& error) {
    keep_error(std::move(error));
    fail_at(context.command.where, type.name + ": its attribute `directions` cannot be read");
  }
}

constexpr std::pair<std::string_view, AttributeKind> kKinds[] = {
    {"number", AttributeKind::number},   {"integer", AttributeKind::integer}, {"choice", AttributeKind::choice},
    {"vector", AttributeKind::vector},   {"text", AttributeKind::text},       {"part", AttributeKind::part},
    {"element", AttributeKind::element}, {"sensor", AttributeKind::sensor}};

std::string_view store(WrittenType& type, std::string text) { return type.texts.emplace_back(std::move(text)); }

std::string string_in(nb::handle row, const char* name) { return nb::cast<std::string>(row.attr(name)); }

void add_row(WrittenType& type, nb::handle row) {
  AttributeSpec spec{.name = store(type, string_in(row, "name"))};
  const std::string kind = string_in(row, "kind");
  const auto found = std::ranges::find(kKinds, std::string_view(kind), [](const auto& each) { return each.first; });
  if (found == std::end(kKinds))
    throw InputError("attribute " + in_quotes(spec.name) + ": unknown kind " + in_quotes(kind));
  spec.kind = found->second;
  spec.default_value = store(type, string_in(row, "default_text"));
  spec.unit = store(type, string_in(row, "unit"));
  spec.text = store(type, string_in(row, "text"));
  spec.choices = store(type, string_in(row, "choices"));
  spec.min = nb::cast<double>(row.attr("min"));
  spec.max = nb::cast<double>(row.attr("max"));
  spec.live = nb::cast<bool>(row.attr("live"));
  if (spec.live) type.live.push_back(spec.name);
  type.rows.push_back(spec);
}

std::unique_ptr<WrittenType> describe_type(const nb::object& python_class, const std::string& name,
                                           const std::string& summary, nb::handle rows) {
  auto type = std::make_unique<WrittenType>();
  type->python_class = python_class;
  type->name = name;
  type->summary = summary;
  for (const nb::handle row : rows) add_row(*type, row);
  if (const std::string wrong = check_table(type->rows); !wrong.empty()) {
    throw InputError("type " + in_quotes(name) + ": " + wrong);
  }
  return type;
}

bool same_rows(const std::vector<AttributeSpec>& a, const std::vector<AttributeSpec>& b) {
  return std::ranges::equal(a, b, [](const AttributeSpec& x, const AttributeSpec& y) {
    return x.name == y.name && x.kind == y.kind && x.default_value == y.default_value && x.unit == y.unit &&
           x.text == y.text && x.min == y.min && x.max == y.max && x.choices == y.choices && x.live == y.live;
  });
}

// A cell of a notebook that is run again replaces the class. The registry keeps the table, so that must be the same.
bool replaced(WrittenType& known, const WrittenType& type) {
  if (!same_rows(known.rows, type.rows) || known.values != type.values || known.summary != type.summary) {
    throw InputError(
        "type " + in_quotes(type.name) +
        " is registered with another table of attributes, expected the same, another name or a new process");
  }
  known.python_class = type.python_class;
  return true;
}

void refuse_taken(const std::string& name, bool taken) {
  if (taken) throw InputError("type " + in_quotes(name) + " exists already, expected another name");
}

void register_element(const nb::object& python_class, const std::string& name, const std::string& summary,
                      const nb::object& rows) {
  std::unique_ptr<WrittenType> type = describe_type(python_class, name, summary, rows);
  auto& classes = element_classes();
  if (const auto known = classes.find(name); known != classes.end() && replaced(*known->second, *type)) return;
  refuse_taken(name, find_element_type(name) != nullptr);
  WrittenType& kept = *type.release();
  classes[name] = &kept;
  const ElementRegistration registration(
      {.name = kept.name, .summary = kept.summary, .attributes = kept.rows, .create = create_element});
}

void register_sensor(const nb::object& python_class, const std::string& name, const std::string& summary,
                     const nb::object& rows, const std::vector<std::string>& values) {
  std::unique_ptr<WrittenType> type = describe_type(python_class, name, summary, rows);
  type->rows.push_back(kRateAttribute);
  if (values.empty()) throw InputError("type " + in_quotes(name) + " has no values, expected at least one name");
  for (const std::string& value : values) type->values.push_back(store(*type, value));
  auto& classes = sensor_classes();
  if (const auto known = classes.find(name); known != classes.end() && replaced(*known->second, *type)) return;
  refuse_taken(name, find_sensor_type(name) != nullptr);
  WrittenType& kept = *type.release();
  classes[name] = &kept;
  const SensorRegistration registration(
      {.name = kept.name, .summary = kept.summary, .attributes = kept.rows, .create = create_sensor});
}

}  // namespace

void bind_written_types(nb::module_& module) {
  nb::class_<CreationContext>(module, "Context",
                              "What the constructor of an element or a sensor gets. Valid during the call.")
      .def_ro("name", &CreationContext::name, "The name in the scene.")
      .def_ro("attributes", &CreationContext::attributes,
              "The values of the table's rows; None where a row is not set.",
              nb::sig("def attributes(self) -> dict[str, typing.Any]"))
      .def("insert_transform", &insert_transform,
           "Inserts a transform at the insertion point; it moves what follows. Elements only.")
      .def(
          "insert_mesh", &insert_mesh, "positions"_a, "triangles"_a, "color"_a = std::vector<float>{0.8f, 0.8f, 0.8f},
          "Inserts a mesh: positions (n, 3) float32 in metres, triangles (m, 3) uint32, linear colour. Elements only.");
  nb::class_<InsertedTransform>(module, "Transform",
                                "A transform in the scene. It can be set in __init__() and update() only.")
      .def("set_matrix", &set_matrix, "matrix"_a, "(4, 4) float64, parent_from_child.")
      .def("set_pose", &set_pose, "x"_a = 0.0, "y"_a = 0.0, "z"_a = 0.0, "roll"_a = 0.0, "pitch"_a = 0.0, "yaw"_a = 0.0,
           "Metres and degrees: R = Rz(yaw) Ry(pitch) Rx(roll).");
  module.def("register_element", &register_element);
  module.def("register_sensor", &register_sensor);
}

}  // namespace simvis::python
