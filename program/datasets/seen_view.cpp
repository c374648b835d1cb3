#include "program/datasets/seen_view.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <set>
#include <string>

#include <simvis/depth_points.h>
#include <simvis/error.h>
#include <simvis/pose.h>

namespace simvis {
namespace {

/// The table of a camera's objects, row by row.
class ThingTable {
 public:
  explicit ThingTable(const Measurement& measurement) : measurement_(measurement) {}

  std::size_t rows() const { return count("object"); }
  bool has_view(std::size_t row, std::size_t view) const {
    const MeasuredArray* const views = measurement_.find("view");
    return views == nullptr || views->number(row) == static_cast<double>(view);
  }
  ObjectInView object(std::size_t row) const {
    const auto whole = [&](const char* name) { return static_cast<std::uint64_t>(number(row, name)); };
    ObjectInView object{
        .instance = static_cast<std::uint32_t>(whole("object")),
        .semantic = static_cast<std::uint32_t>(whole("object_class")),
        .visible_pixels = whole("visible_pixels"),
        .picture_pixels = whole("picture_pixels"),
        .full_pixels = whole("full_pixels"),
        .visible_fraction = number(row, "visible_fraction"),
        .truncated = number(row, "truncated"),
        .visible = box(row, "visible"),
        .picture = box(row, "picture"),
        .full = box(row, "full"),
        .centre_m = {number(row, "box_x_m"), number(row, "box_y_m"), number(row, "box_z_m")},
        .size_m = {number(row, "box_size_x_m"), number(row, "box_size_y_m"), number(row, "box_size_z_m")}};
    object.optical_from_box = glm::mat3_cast(
        glm::dquat(number(row, "box_qw"), number(row, "box_qx"), number(row, "box_qy"), number(row, "box_qz")));
    return object;
  }

 private:
  std::size_t count(std::string_view name) const {
    const MeasuredArray* const found = measurement_.find(name);
    return found == nullptr ? 0 : found->count();
  }
  double number(std::size_t row, std::string_view name) const { return measurement_.find(name)->number(row); }
  BoxPx box(std::size_t row, const std::string& name) const {
    return {number(row, name + "_x_min"), number(row, name + "_y_min"), number(row, name + "_x_max"),
            number(row, name + "_y_max")};
  }

  const Measurement& measurement_;
};

SeenView view_of(const DatasetSensor& sensor, std::size_t number) {
  const Measurement& measurement = sensor.measurement;
  const Calibration& calibration = (*measurement.calibrations)[number];
  const std::string prefix = calibration.view.empty() ? "" : calibration.view + "_";
  SeenView view{.name = calibration.view.empty() ? sensor.name : sensor.name + "_" + calibration.view,
                .camera = calibration.camera,
                .world_from_optical = glm::translate(sensor.world_from_sensor, {0, -calibration.camera.baseline_m, 0}) *
                                      sensor_from_view(),
                .color = {},
                .depth = {}};
  for (const MeasuredArray& each : measurement.arrays) {
    if (each.kind != OutputKind::image || each.view != calibration.view) continue;
    if (each.content == ImageContent::color) view.color = to_image(each);
    if (each.content == ImageContent::depth) view.depth = to_image(each);
    if (each.name == prefix + "instance") view.instance = &each;
    if (each.name == prefix + "semantic") view.semantic = &each;
    if (each.name == prefix + "silhouettes") view.silhouettes = &each;
  }
  const ThingTable table(measurement);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.has_view(row, number)) view.objects.push_back(table.object(row));
  }
  return view;
}

}  // namespace

bool is_camera(const DatasetSensor& sensor) {
  return sensor.measurement.calibrations != nullptr && !sensor.measurement.calibrations->empty() &&
         std::ranges::count(sensor.measurement.arrays, OutputKind::image, &MeasuredArray::kind) > 0;
}

bool is_keypoints(const DatasetSensor& sensor) {
  return sensor.measurement.calibrations != nullptr && sensor.measurement.find("in_picture") != nullptr;
}

bool is_scanner(const DatasetSensor& sensor) {
  const MeasuredArray* const range = sensor.measurement.find("range_m");
  return range != nullptr && range->kind == OutputKind::scan_column;
}

std::vector<SeenView> views_of(std::span<const DatasetSensor> sensors) {
  std::vector<SeenView> views;
  for (const DatasetSensor& sensor : sensors) {
    if (!is_camera(sensor)) continue;
    for (std::size_t i = 0; i < sensor.measurement.calibrations->size(); ++i) views.push_back(view_of(sensor, i));
  }
  return views;
}

void require_outputs(const DatasetSensor& camera, std::string_view format,
                     std::initializer_list<NeededOutput> outputs) {
  std::string all;
  bool complete = true;
  for (const NeededOutput& needed : outputs) {
    all += (all.empty() ? "" : " ") + std::string(needed.word);
    complete &= std::ranges::any_of(camera.measurement.arrays, [&](const MeasuredArray& each) {
      if (needed.array.empty()) return each.content == needed.content;
      return each.name == needed.array || each.name.ends_with("_" + std::string(needed.array));
    });
  }
  if (complete) return;
  throw InputError("--dataset " + std::string(format) + ": camera \"" + camera.name +
                   "\" lacks outputs, expected at least outputs=\"" + all + "\"");
}

void require_pinhole(const DatasetSensor& camera, std::string_view format) {
  for (const Calibration& each : *camera.measurement.calibrations) {
    if (is_pinhole(each.camera)) continue;
    throw InputError("--dataset " + std::string(format) + ": camera \"" + camera.name +
                     "\" has a lens, which the format cannot describe, expected distortion=\"none\"");
  }
}

void require_views(std::span<const DatasetSensor> sensors, std::string_view format) {
  if (std::ranges::any_of(sensors, is_camera)) return;
  throw InputError("--dataset " + std::string(format) + ": the scene has no camera that is on, expected at least one");
}

void require_own_names(std::span<const DatasetSensor> sensors, std::string_view format) {
  std::set<std::string> names;
  for (const SeenView& view : views_of(sensors)) {
    if (names.insert(view.name).second) continue;
    throw InputError("--dataset " + std::string(format) + ": two views have the name \"" + view.name +
                     "\", expected another name for one of their sensors");
  }
}

void refuse_sensor(const DatasetSensor& sensor, std::string_view format, std::string_view holds) {
  throw InputError("--dataset " + std::string(format) + ": the format cannot hold the sensor \"" + sensor.name +
                   "\", expected " + std::string(holds) + "; --sensor chooses among the sensors of a scene");
}

}  // namespace simvis
