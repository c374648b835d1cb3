#include "program/datasets/seen_points.h"

#include <simvis/error.h>
#include <simvis/pose.h>
#include "program/datasets/rigid_text.h"
#include "program/output/output_writer.h"

namespace simvis {
namespace {

bool has_picture_of(const CameraCalibration& a, const CameraCalibration& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px && a.pinhole == b.pinhole &&
         a.distortion_model == b.distortion_model && a.distortion_coefficients == b.distortion_coefficients;
}

}  // namespace

FramePoints::FramePoints(const DatasetFrame& frame, std::span<const SeenView> views, std::string_view format) {
  for (const SceneObject& object : frame.objects) {
    by_name_[object.name] = &object;
    by_instance_[object.instance] = &object;
  }
  for (const DatasetSensor& sensor : frame.sensors) {
    if (!is_keypoints(sensor)) continue;
    const std::string who = "--dataset " + std::string(format) + ": keypoints \"" + sensor.name + "\" in frame " +
                            frame_name(frame.time.index) + ": ";
    bool has_view = false, has_points = false;
    for (const SeenView& view : views) {
      const bool is_same = has_picture_of(view.camera, sensor.measurement.calibrations->front().camera) &&
                           is_same_place(view.world_from_optical, sensor.world_from_sensor * sensor_from_view());
      if (!is_same) continue;
      has_view = true;
      has_points |= add(sensor, view);
    }
    if (!has_view) {
      throw InputError(who + "no camera has their place and picture, expected one with the same pose, width, height, " +
                       "hfov and lens, which is due in the same frames");
    }
    if (!has_points && !sensor.points.empty()) {
      throw InputError(who +
                       "none of the points belongs to an object with a class, expected points that are inserted at "
                       "one, or that stand in its file");
    }
  }
}

bool FramePoints::add(const DatasetSensor& sensor, const SeenView& view) {
  const MeasuredArray& number = *sensor.measurement.find("point");
  const auto value = [&](const char* name, std::size_t row) { return sensor.measurement.find(name)->number(row); };
  bool added = false;
  for (std::size_t row = 0; row < number.count(); ++row) {
    const auto point = by_name_.find(sensor.points.at(static_cast<std::uint32_t>(number.number(row))));
    if (point == by_name_.end()) continue;
    const SceneObject* owner = point->second;
    do {
      const auto parent = by_instance_.find(owner->parent);
      owner = parent == by_instance_.end() ? nullptr : parent->second;
    } while (owner != nullptr && owner->semantic == 0);
    if (owner == nullptr) continue;
    points_[view.name][owner->instance][point->second->path.substr(owner->path.size() + 1)] = {
        .x_px = value("x_px", row),
        .y_px = value("y_px", row),
        .in_picture = value("in_picture", row) != 0,
        .visible = value("visible", row) != 0};
    added = true;
  }
  return added;
}

SeenPoints FramePoints::of(const SeenView& view, std::uint32_t instance) const {
  const auto in_view = points_.find(view.name);
  if (in_view == points_.end()) return {};
  const auto found = in_view->second.find(instance);
  return found == in_view->second.end() ? SeenPoints{} : found->second;
}

}  // namespace simvis
