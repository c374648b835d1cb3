// EuRoC: the ASL layout of the EuRoC MAV datasets, for cameras with an inertial measurement unit.
//
//   mav0/body.yaml
//   mav0/cam0/data/TIME.png data.csv sensor.yaml     the first view of the cameras by their names; cam1: the next one
//   mav0/imu0/data.csv sensor.yaml                   the sensor of type `imu`, if there is one
//   mav0/state_groundtruth_estimate0/data.csv sensor.yaml
//
// Times    TIME is the frame's time in nanoseconds. Sensors may have rates of their own.
// Body     the frame of the imu, or without one the optical frame of cam0. T_BS leads from a sensor's frame to the
//          body's; that of a camera is its optical frame (x right, y down, z forward). Sensors must be on one body.
// Cameras  pinhole, with the lens brown_conrady without k3 (radial-tangential) or kannala_brandt (equidistant); the
//          principal point counts from the centre of the first pixel. Pictures are grey: sRGB codes of the luminance.
// State    a row for each frame in which the sensor of the body frame measures: position, orientation with qw first,
//          velocity in the world, true biases of the imu. A velocity is the mean since the row before; the first is 0.
// Noise    in imu0/sensor.yaml: stddev counts as white noise, and both drifts together as a random walk.
#pragma once

#include <string>
#include <vector>

#include "program/datasets/dataset_format.h"

namespace simvis {

class EurocFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  std::vector<std::string> views_;  // names of the views; cam0 first
  std::string imu_;                 // name of the imu; empty if the scene has none
};

}  // namespace simvis
