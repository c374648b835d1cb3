// The keypoints of the things that a view shows: rows of a sensor `keypoints` that stands where the view's camera
// stands and has its picture. The point PART/NAME is the keypoint NAME of the thing that is the part PART.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "datasets/dataset_format.h"
#include "datasets/seen_view.h"

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
  /// Throws InputError if a sensor of keypoints has the place and picture of no view, or if none of its points is named
  /// after a part of the scene.
  FramePoints(const DatasetFrame& frame, std::span<const SeenView> views, std::string_view format);

  /// Those of the first part in the view whose things are asked for: each part has its keypoints once in a view. Empty:
  /// it has none, or they were given before.
  SeenPoints take(const SeenView& view, std::uint32_t instance);

 private:
  void add(const DatasetSensor& sensor, const SeenView& view);

  std::map<std::uint32_t, std::string> part_of_;  // by instance
  std::set<std::string> parts_;
  std::map<std::string, std::map<std::string, SeenPoints>> points_;  // by view, by part
};

}  // namespace simvis
