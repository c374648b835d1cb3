// Where the beams of a laser scanner lie in the virtual cameras that cover its field of view. Pure geometry: made
// once, in double, when the scanner is made.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

/// The directions that a scanner measures.
///
/// Frames   sensor frame: azimuth counter-clockwise from +x about +z, elevation positive upwards.
/// Shape    beam i of a ring lies at min + i * (max - min) / (samples - 1), both ends included; a single one at min.
struct ScanPattern {
  std::uint32_t samples = 361, rings = 1;
  double min_azimuth_rad = 0, max_azimuth_rad = 0;      ///< max - min within [0, 2 pi]
  double min_elevation_rad = 0, max_elevation_rad = 0;  ///< within [-pi/2, pi/2]
};

std::vector<double> azimuths(const ScanPattern& pattern);
std::vector<double> elevations(const ScanPattern& pattern);

/// One virtual camera of at most 90 degrees by 90 degrees, cut down to the pixels that its beams need.
struct ScanFace {
  glm::dmat3 face_from_sensor{1.0};  ///< rotation; the face's frame is x right, y down, z forward
  Pinhole pinhole;                   ///< fx = fy, or fy = kRowsPerPixel fx
  std::uint32_t width_px = 0, height_px = 0;
  std::uint32_t beams = 0;
  std::shared_ptr<const std::vector<std::uint32_t>> columns;  ///< ascending: those that its beams' neighbourhoods have
};

/// Where a beam meets the pixel grid of its face: between the centres of pixels (x, y) and (x + 1, y + 1).
struct BeamTap {
  std::uint32_t face = 0;
  std::uint32_t x = 0, y = 0;
  double fraction_x = 0, fraction_y = 0;  ///< [0, 1] of the way to the next centre
  double tangent_x = 0, tangent_y = 0;    ///< the beam meets the plane z = 1 of the face at (tangent_x, tangent_y, 1)
  double ray_per_depth = 1;               ///< range along the ray = ray_per_depth * depth along Z
};

/// Pixels kept around the outermost beams, so that each beam has its neighbourhood: 2 before its pixel, 3 after.
inline constexpr int kPixelsBefore = 2, kPixelsAfter = 3;

/// How many rows of a single horizontal ring are as high as a pixel is wide.
inline constexpr double kRowsPerPixel = 4;

/// The faces and taps of a pattern.
///
/// Every beam has its neighbourhood in both directions. The scan plane of a single horizontal ring runs through the
/// centres of a row of pixels; the rows beside it only tell where surfaces end and how they slant. So they are thin:
/// what is drawn is what lies near the scan plane, and fewer surfaces end near a beam.
struct ScanLayout {
  std::vector<ScanFace> faces;
  std::vector<BeamTap> taps;  ///< [ring * samples + beam]
};

/// `resolution_px`: pixels across 90 degrees, at least 1.
ScanLayout make_scan_layout(const ScanPattern& pattern, double resolution_px);

}  // namespace simvis
