#include "python/core/written_sensors.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/reading_sensor.h>
#include "python/core/errors.h"
#include "python/core/written_type.h"

namespace nb = nanobind;

namespace simvis::python {
namespace {

/// Never destroyed: the registry refers to the types for the rest of the program.
WrittenTypes& sensor_classes() {
  static auto* const all = new WrittenTypes;
  return *all;
}

/// The author of a type gives names only.
std::vector<TableColumn> columns_of(const WrittenType& type) {
  std::vector<TableColumn> columns;
  for (const std::string_view value : type.values) columns.push_back({.name = std::string(value), .format = "%.9g"});
  return columns;
}

/// A sensor that casts rays and whose Python code turns the hits into numbers.
class WrittenSensor : public ReadingSensor {
 public:
  WrittenSensor(const WrittenType& type, std::string name, nb::object object)
      : ReadingSensor(columns_of(type)), type_(type), name_(std::move(name)), object_(std::move(object)) {
    read_directions();
  }

  void begin(const FrameTime& time) override { time_ = time; }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override {
    ReadingSensor::plan(world_from_sensor, list, plan);
    plan.casts.push_back({.name = name_, .reason = "rays of sensor " + name_, .max_rays = directions_.size()});
  }
  void collect(const FrameTime&, const FramePlan&, std::span<const PassResult>) override {}
  void cast(RayCaster& rays) override {
    hits_.resize(directions_.size());
    rays.cast(world_from_sensor(), directions_, hits_);
    const nb::gil_scoped_acquire locked;
    try {
      set_reading(time_, nb::cast<std::vector<double>>(measure()));
    } catch (nb::python_error& error) {
      keep_error(std::move(error));
    }
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
    nb::list names;
    for (const std::string_view value : type_.values) names.append(nb::str(value.data(), value.size()));
    return (*object_).attr("_measured")(name_, names, ranges, static_cast<double>(time_.time_ns) / 1e9);
  }

  const WrittenType& type_;
  std::string name_;
  Owned object_;
  std::vector<glm::dvec3> directions_;
  std::vector<RayHit> hits_;
  FrameTime time_;
};

std::unique_ptr<Sensor> create_sensor(const SensorContext& context) {
  const nb::gil_scoped_acquire locked;  // of the map too
  const WrittenType& type = *sensor_classes().at(context.command.require("type").value);
  CreationContext creation{context.name, values_of(context.attributes, type.rows)};
  nb::object object = make_object(type, creation, context.command);
  try {
    return std::make_unique<WrittenSensor>(type, context.name, std::move(object));
  } catch (nb::python_error& error) {
    keep_cause(std::move(error));
    fail_at(context.command.where, type.name + ": its attribute `directions` cannot be read");
  }
}

std::vector<OutputSpec> written_outputs(const SensorContext& context) {
  const nb::gil_scoped_acquire locked;  // of the map
  const WrittenType& type = *sensor_classes().at(context.command.require("type").value);
  return reading_outputs(context, columns_of(type));
}

void register_sensor(const nb::object& python_class, const std::string& name, const std::string& summary,
                     const nb::object& rows, const std::vector<std::string>& values) {
  std::unique_ptr<WrittenType> type = describe_type(python_class, name, summary, rows);
  type->rows.push_back(kRateAttribute);
  if (values.empty()) throw InputError("type " + in_quotes(name) + " has no values, expected at least one name");
  for (const std::string& value : values) type->values.push_back(store(*type, value));
  const WrittenType* const kept = keep_type(sensor_classes(), std::move(type), find_sensor_type(name) != nullptr);
  if (kept == nullptr) return;
  const SensorRegistration registration({.name = kept->name,
                                         .summary = kept->summary,
                                         .attributes = kept->rows,
                                         .create = create_sensor,
                                         .outputs = written_outputs});
}

}  // namespace

void bind_written_sensors(nb::module_& module) { module.def("register_sensor", &register_sensor); }

}  // namespace simvis::python
