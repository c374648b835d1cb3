// TUM: the RGB-D sequences of the Technical University of Munich, for one camera.
//
//   rgb/TIME.png depth/TIME.png     TIME in seconds with six decimals
//   rgb.txt depth.txt               lines "TIME FILE"
//   groundtruth.txt                 lines "TIME tx ty tz qx qy qz qw": the optical frame (x right, y down, z
//                                   forward) in the world
//
// Depth    along the optical axis: 16-bit codes, 5000 for each metre; 0: nothing, or farther than 13.1 m.
// Times    A file is named by its frame's time in whole microseconds; two frames with the same number are refused.
#pragma once

#include "program/datasets/dataset_format.h"

namespace simvis {

class TumFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;
};

}  // namespace simvis
