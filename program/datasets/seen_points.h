// The keypoints of the things that a view shows: rows of a sensor `keypoints` with the pose, picture size and lens of
// the view's camera. The point PART/NAME is the keypoint NAME of the part PART.
#pragma once

#include <cstdint>
#include <map>
#include <set>
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

/// The keypoints of one thing, by their names.
using SeenPoints = std::map<std::string, SeenPoint>;

/// The keypoints of all views of a frame.
class FramePoints {
 public:
  /// Throws InputError if a sensor of keypoints has the place and picture of no view, or if it has points and none is
  /// named after a part of the scene. `format` is the name of the dataset's format, for messages.
  FramePoints(const DatasetFrame& frame, std::span<const SeenView> views, std::string_view format);

  /// The keypoints of the part that has the item `instance`, in a view. Only the first call for a part and a view
  /// returns them, so that one item of a part with several has them; further calls return nothing.
  SeenPoints take(const SeenView& view, std::uint32_t instance);

 private:
  /// Returns whether any point of the sensor is named after a part.
  bool add(const DatasetSensor& sensor, const SeenView& view);

  std::map<std::uint32_t, std::string> part_of_;  // by instance
  std::set<std::string> parts_;
  std::map<std::string, std::map<std::string, SeenPoints>> points_;  // by view, by part
};

}  // namespace simvis
