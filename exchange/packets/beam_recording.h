// What a real laser scanner has measured, beam by beam.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <string>
#include <vector>

namespace simvis {

/// Frame    the sensor's: x forward, y left, z up. Azimuth is counter-clockwise from +x about +z, elevation positive
///          upwards: where the beam points by the device's own numbers.
struct RecordedBeam {
  std::uint32_t ring = 0, scan = 0;                             ///< scans count from 0
  double azimuth_rad = 0, elevation_rad = 0;                    ///< azimuth from -pi to pi
  glm::dvec3 origin_m{0};                                       ///< where the beam starts
  double range_m = std::numeric_limits<double>::infinity();     ///< along the beam; +infinity: nothing returned
  double intensity = std::numeric_limits<double>::quiet_NaN();  ///< in the device's unit; NaN: not recorded
};

struct BeamRecording {
  std::string source;  ///< what it is of: "Velodyne VLP-16", "topic /LIDAR/points"
  std::vector<RecordedBeam> beams{};
  std::uint32_t rings = 0, scans = 0;
  double range_unit_m = 0;  ///< ranges are whole multiples of this; 0: they are not rounded
  double max_intensity = std::numeric_limits<double>::infinity();  ///< the largest number that the device can say
  double intensity_unit = 0;    ///< intensities are whole multiples of this; 0: they are not rounded
  bool has_lost_beams = false;  ///< beams without a return are among `beams`
};

}  // namespace simvis
