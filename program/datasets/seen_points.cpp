#include "program/datasets/seen_points.h"

#include <utility>

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
  for (const SceneItem& item : frame.items) {
    part_of_[item.instance] = item.part;
    parts_.insert(item.part);
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
                       "none of the points is named after a part with shapes, expected names PART/NAME, such as \"" +
                       (frame.items.empty() ? "PART" : frame.items.front().part) + "/NAME\"");
    }
  }
}

// A point belongs to the part with the longest name that its own name begins with.
bool FramePoints::add(const DatasetSensor& sensor, const SeenView& view) {
  const MeasuredArray& number = *sensor.measurement.find("point");
  const auto value = [&](const char* name, std::size_t row) { return sensor.measurement.find(name)->number(row); };
  bool added = false;
  for (std::size_t row = 0; row < number.count(); ++row) {
    const std::string& name = sensor.points.at(static_cast<std::uint32_t>(number.number(row)));
    for (std::size_t slash = name.rfind('/'); slash != std::string::npos && slash > 0;
         slash = name.rfind('/', slash - 1)) {
      const std::string part = name.substr(0, slash);
      if (!parts_.contains(part)) continue;
      points_[view.name][part][name.substr(slash + 1)] = {.x_px = value("x_px", row),
                                                          .y_px = value("y_px", row),
                                                          .in_picture = value("in_picture", row) != 0,
                                                          .visible = value("visible", row) != 0};
      added = true;
      break;
    }
  }
  return added;
}

SeenPoints FramePoints::take(const SeenView& view, std::uint32_t instance) {
  const auto part = part_of_.find(instance);
  if (part == part_of_.end()) return {};
  return std::exchange(points_[view.name][part->second], {});
}

}  // namespace simvis
