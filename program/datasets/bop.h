// BOP, the benchmark for 6-D poses of objects: docs/bop_datasets_format.md of bop_toolkit.
//
//   camera.json                      the first camera
//   models/obj_000001.ply            millimetres, in the frame of the object's box; models/models_info.json
//   train/000000/                    one scene for each view of a camera, by their names
//     rgb/000000.png depth/000000.png mask/000000_000000.png mask_visib/000000_000000.png
//     scene_camera.json scene_gt.json scene_gt_info.json
//
// Objects  Items that have a class; items of the same mesh and scale are the same object. Objects are numbered from
//          1 by their lowest instance id. All frames must have the same things.
// Poses    from the object's box to the camera (x right, y down, z forward), in millimetres; matrices row by row.
// Depth    along the optical axis: 16-bit codes x depth_scale are millimetres; 0: nothing, or too far for the codes.
// Boxes    (x, y, xmax - xmin, ymax - ymin) of pixel numbers, so that one pixel has the width 0. `bbox_obj` and
//          `px_count_all` are of the silhouette with a picture's width and height more on each side; `bbox_visib` is
//          all -1 where nothing is visible. Visibility is exact, whereas the toolkit's own is a test of distances with
//          a tolerance of 15 mm in which missing depth counts as visible.
#pragma once

#include <string>
#include <vector>

#include "program/datasets/dataset_format.h"

namespace simvis {

class BopFormat : public DatasetFormat {
 public:
  /// `depth_unit_m` is the length of one code of depth.
  explicit BopFormat(double depth_unit_m) : depth_unit_m_(depth_unit_m) {}
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  double depth_unit_m_;
  std::vector<std::string> scenes_;  // names of views, by the number of the scene
};

}  // namespace simvis
