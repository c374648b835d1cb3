// KITTI odometry, and SemanticKITTI, which adds labels of points.
//
//   sequences/00/image_2/000000.png     the first view of the cameras by their names; image_3: the second
//   sequences/00/velodyne/000000.bin    float32 x y z reflectance of each point, in the scanner's frame
//   sequences/00/labels/000000.label    uint32 of each point: the class in the lower 16 bits, the instance in the upper
//   sequences/00/calib.txt times.txt
//   poses/00.txt                        12 numbers for each frame: the first view's optical frame in that of frame 0
//
// Cameras  one or two views of pinhole cameras that look in the same direction, as those of a stereo camera.
// Scanner  at most one; points without a return are left out. The reflectance is the column `intensity`, or 0.
// Labels   need truth="instance semantic" of the scanner. An instance is its rank among the ids of the frame's items,
//          from 1: all frames must have the same items. 0, 0 where no item is known.
#pragma once

#include <string>
#include <vector>

#include "program/datasets/dataset_format.h"

namespace simvis {

class KittiFormat : public DatasetFormat {
 public:
  /// `labels`: SemanticKITTI.
  explicit KittiFormat(bool labels) : labels_(labels) {}
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  std::string_view name() const { return labels_ ? "semantickitti" : "kitti"; }

  bool labels_;
  std::vector<std::string> views_;  // image_2 first
  std::size_t scanners_ = 0;
};

}  // namespace simvis
