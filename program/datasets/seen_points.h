// The keypoints of the objects that a view shows: rows of a sensor `keypoints` with the pose, picture size and lens of
// the view's camera. A point is one of the nearest object with a class that it belongs to, and the rest of its path is
// the keypoint's name: the point CHAIR/seat is the keypoint `seat` of CHAIR.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "program/datasets/dataset_format.h"
#include "program/datasets/seen_view.h"

namespace simvis {

struct SeenPoint {
  double x_px = 0, y_px = 0;  ///< from the picture's corner
  bool in_picture = false, visible = false;
};

/// The keypoints of one object, by their names.
using SeenPoints = std::map<std::string, SeenPoint>;

/// The keypoints of all views of a frame.
class FramePoints {
 public:
  /// Throws InputError if a sensor of keypoints has the place and picture of no view, or if it has points and none
  /// belongs to an object with a class. `format` is the name of the dataset's format, for messages.
  FramePoints(const DatasetFrame& frame, std::span<const SeenView> views, std::string_view format);

  /// The keypoints of an object in a view; none if it has none.
  SeenPoints of(const SeenView& view, std::uint32_t instance) const;

 private:
  /// Returns whether any point of the sensor belongs to an object with a class.
  bool add(const DatasetSensor& sensor, const SeenView& view);

  std::map<std::string, const SceneObject*> by_name_;
  std::map<std::uint32_t, const SceneObject*> by_instance_;
  std::map<std::string, std::map<std::uint32_t, SeenPoints>> points_;  // by view, by instance
};

}  // namespace simvis
