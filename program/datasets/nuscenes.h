// nuScenes: the tables of its schema v1.0, pictures of pinhole cameras and sweeps of laser scanners.
//
//   v1.0-simvis/*.json                  the thirteen tables; one scene, "scene-0001"
//   samples/SENSOR/000000.png .bin      of key frames; sweeps/SENSOR/... of all others
//   maps/none.png                       a map of one pixel, which says nothing: there is no map
//
// Frames   A key frame is one in which all sensors measure. The frame "ego" is that of the first scanner by its name.
//          Without a scanner it is that of the first camera: x forward, y left, z up. Its pose is in three dimensions.
//          Sensors must be on one body. A camera's frame is its optical one (x right, y down, z forward); the principal
//          point counts from the centre of the first pixel.
// Points   float32 x y z intensity ring, in metres in the scanner's frame. The intensity is not scaled to 255; it is 0
//          for a scanner without the column `intensity`.
// Boxes    of all shapes with a class in key frames, seen or not, in metres in the world: width (y), length (x),
//          height (z). num_lidar_pts counts points that are on the shape, so scanners need truth="instance". Visibility
//          is the share of visible_pixels in picture_pixels over all cameras with `boxes`; without them it is empty.
// Times    microseconds of simulated time. Tokens are numbers of 32 digits, unique in the dataset.
#pragma once

#include <string>
#include <vector>

#include "program/datasets/dataset_format.h"

namespace simvis {

class NuscenesFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  std::vector<std::string> sensors_;  // names of scanners and views; the first one stands in the frame "ego"
};

}  // namespace simvis
