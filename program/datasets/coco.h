// COCO: pictures, and one file of boxes and masks for detection.
//
//   images/CAMERA/000000.png
//   annotations/instances.json
//
// Boxes    [x, y, width, height] of the visible pixels, the width being the number of columns, as COCO's own tools
//          make them from a mask; `area` is the number of visible pixels. What shows no pixel has no annotation.
// Masks    run lengths as a text, see coco_rle(). `iscrowd` is 0.
// Ids      `category_id` is the id of the class. Pictures and annotations count from 1, by camera and frame.
// Points   of sensors `keypoints`, see seen_points.h: x and y in pixels from the centre of the first pixel; v is 0 for
//          a point that is not in the picture, 1 for a hidden one, 2 for a visible one. A category has the names of the
//          keypoints of all its annotations, sorted.
// More     `instance_id`, `visible_fraction` and `truncated` are additions that readers of COCO pass over.
#pragma once

#include "program/datasets/dataset_format.h"

namespace simvis {

class CocoFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;
};

}  // namespace simvis
