// Positions of the beams of a laser scanner in the virtual cameras that cover its field of view. Pure geometry:
// computed once, in double precision, when the scanner is created.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "sensors/raster_depth/beam_tap.h"

namespace simvis {

/// The limits of a ScanPattern as a scene gives them, in degrees.
struct ScanLimits {
  double min_azimuth_deg = 0, max_azimuth_deg = 0, min_elevation_deg = 0, max_elevation_deg = 0;
};

/// The directions that a scanner measures.
///
/// Frames   sensor frame: azimuth counter-clockwise from +x about +z, elevation positive upwards.
/// Default  one beam along +x. LaserScannerDesc holds the defaults of scanners in a scene.
/// Shape    beam i of a ring lies at min + i * (max - min) / (beams - 1), both ends included; a single beam lies at
///          min. With `degrees` the formula is computed in degrees, and each angle is glm::radians() of its result. A
///          table in degrees then has exactly the angles that are measured; about one double in ten is glm::radians()
///          of no double.
struct ScanPattern {
  std::uint32_t beams = 1, rings = 1;                   ///< beams of each ring
  double min_azimuth_rad = 0, max_azimuth_rad = 0;      ///< max - min within [0, 2 pi]
  double min_elevation_rad = 0, max_elevation_rad = 0;  ///< within [-pi/2, pi/2]
  std::optional<ScanLimits> degrees{};                  ///< the same limits
};

std::vector<double> azimuths(const ScanPattern& pattern);    ///< rad
std::vector<double> elevations(const ScanPattern& pattern);  ///< rad

/// The same in degrees: with `degrees` the doubles of which azimuths() and elevations() are glm::radians().
std::vector<double> azimuths_deg(const ScanPattern& pattern);
std::vector<double> elevations_deg(const ScanPattern& pattern);

/// Number of pixel rows of a single horizontal ring that are as high as a pixel is wide.
inline constexpr double kRowsPerPixel = 4;

/// Every beam has its pixel neighbourhood in both directions. The scan plane of a single horizontal ring runs through
/// the centres of a row of pixels; the rows beside it only show where surfaces end and how they slope. These rows are
/// thin: only geometry near the scan plane is drawn, and fewer surfaces end near a beam.
struct ScanLayout {
  std::vector<ScanFace> faces;
  std::vector<BeamTap> taps;  ///< [ring * beams + beam]
};

/// `resolution_px` is the number of pixels across 90 degrees, at least 1.
ScanLayout make_scan_layout(const ScanPattern& pattern, double resolution_px);

}  // namespace simvis
