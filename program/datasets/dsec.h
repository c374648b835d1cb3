// DSEC: event cameras with frame cameras, flow and disparity (Gehrig, Aarents, Gehrig, Scaramuzza, IEEE RA-L 6(3),
// 2021).
//
//   events/left/events.h5 rectify_map.h5         the first event camera by its name; right: the second
//   images/left/rectified/000000.png             the first view with colour; right: the second
//   images/timestamps.txt
//   flow/forward/000000.png forward_timestamps.txt
//   disparity/event/000000.png image/000000.png timestamps.txt
//   calibration/cam_to_cam.yaml
//
// Frames   All sensors measure in all frames. Times are microseconds of the simulation, rounded down.
// Truth    A camera with the place and the picture of the left event camera gives flow by `flow_forward`, and the
//          disparity to the right event camera by `depth`. `depth` of the left view gives the disparity of two views.
//          Other cameras have no `flow_forward`.
// Pairs    Two event cameras, and two views, look in the same direction, side by side, and have the same pictures.
// Cameras  They have no lens: cam0 and cam3 are the event cameras, cam1 and cam2 the views. They stand on one body.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "program/datasets/dataset_format.h"

namespace simvis {

class DsecFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  struct Cameras;
  Cameras cameras_of(const DatasetFrame& frame) const;

  struct EventSize {
    std::uint32_t width_px, height_px;
  };
  std::vector<EventSize> event_sizes_;  // of the event cameras, left first
  std::vector<std::string> views_;      // left first
};

}  // namespace simvis
