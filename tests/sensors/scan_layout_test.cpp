#include "sensors/laser_scanner/scan_layout.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

// Directions are computed by a few double operations on numbers below 10: a dozen ulps of 10.
constexpr double kDirectionTolerance = 12 * 10 * 0x1p-53;

// The direction of a tap's beam in the sensor frame.
glm::dvec3 direction(const ScanLayout& layout, const BeamTap& tap) {
  const ScanFace& face = layout.faces[tap.face];
  const double qx = (tap.x + tap.fraction_x + 0.5 - face.pinhole.cx_px) / face.pinhole.fx_px;
  const double qy = (tap.y + tap.fraction_y + 0.5 - face.pinhole.cy_px) / face.pinhole.fy_px;
  return glm::transpose(face.face_from_sensor) * glm::normalize(glm::dvec3(qx, qy, 1));
}

void check_layout(const ScanPattern& pattern, double resolution_px) {
  const ScanLayout layout = make_scan_layout(pattern, resolution_px);
  const auto a = azimuths(pattern), e = elevations(pattern);
  REQUIRE(layout.taps.size() == a.size() * e.size());
  for (std::size_t ring = 0; ring < e.size(); ++ring) {
    for (std::size_t beam = 0; beam < a.size(); ++beam) {
      const BeamTap& tap = layout.taps[ring * a.size() + beam];
      const glm::dvec3 expected(std::cos(e[ring]) * std::cos(a[beam]), std::cos(e[ring]) * std::sin(a[beam]),
                                std::sin(e[ring]));
      // Pixels are counted from the edge of the face, which loses its width in pixels times the ulp of 1.
      REQUIRE(glm::length(direction(layout, tap) - expected) < kDirectionTolerance + 4 * 0x1p-53 * resolution_px);
      const ScanFace& face = layout.faces[tap.face];
      REQUIRE(tap.x >= static_cast<std::uint32_t>(kPixelsBefore));
      REQUIRE(tap.x + kPixelsAfter < face.width_px);
      REQUIRE(tap.fraction_x >= 0);
      REQUIRE(tap.fraction_x <= 1);
      REQUIRE(tap.y >= static_cast<std::uint32_t>(kPixelsBefore));
      REQUIRE(tap.y + kPixelsAfter < face.height_px);
      if (pattern.rings == 1 && pattern.min_elevation_rad == 0) {
        REQUIRE(tap.fraction_y == 0);
        REQUIRE(face.height_px == kPixelsBefore + 1 + kPixelsAfter);
      }
      REQUIRE(tap.ray_per_depth <= std::sqrt(3.0) * (1 + 1e-12));
    }
  }
}

}  // namespace

TEST_CASE("beams are spread evenly and include both ends") {
  const ScanPattern pattern{.beams = 361, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2};
  const auto a = azimuths(pattern);
  REQUIRE(a.size() == 361);
  CHECK(a.front() == -kPi / 2);
  CHECK(a.back() == kPi / 2);
  CHECK(a[180] == 0);
  CHECK(elevations(pattern) == std::vector<double>{0});
}

TEST_CASE("taps point along their beams, inside their faces") {
  const double quarter = kPi / 2;
  check_layout({.beams = 361, .min_azimuth_rad = -quarter, .max_azimuth_rad = quarter}, 4096);
  check_layout({.beams = 721, .min_azimuth_rad = -kPi, .max_azimuth_rad = kPi}, 1000);
  check_layout({.beams = 10, .min_azimuth_rad = 0.1, .max_azimuth_rad = 0.2}, 512);
  check_layout({.beams = 1, .min_azimuth_rad = 1, .max_azimuth_rad = 1}, 512);
  check_layout({.beams = 200,
                .rings = 16,
                .min_azimuth_rad = -kPi,
                .max_azimuth_rad = kPi,
                .min_elevation_rad = -0.26,
                .max_elevation_rad = 0.26},
               1024);
  check_layout({.beams = 90,
                .rings = 45,
                .min_azimuth_rad = -kPi,
                .max_azimuth_rad = kPi,
                .min_elevation_rad = -quarter,
                .max_elevation_rad = quarter},
               256);
}

TEST_CASE("a half circle takes two faces, a full turn four, the sphere six; a planar strip has two rows") {
  const double quarter = kPi / 2;
  CHECK(make_scan_layout({.beams = 361, .min_azimuth_rad = -quarter, .max_azimuth_rad = quarter}, 4096).faces.size() ==
        2);
  CHECK(make_scan_layout({.beams = 361, .min_azimuth_rad = -kPi, .max_azimuth_rad = kPi}, 4096).faces.size() == 4);
  CHECK(make_scan_layout({.beams = 361,
                          .rings = 181,
                          .min_azimuth_rad = -kPi,
                          .max_azimuth_rad = kPi,
                          .min_elevation_rad = -quarter,
                          .max_elevation_rad = quarter},
                         256)
            .faces.size() == 6);
}

TEST_CASE("the width of a face follows its beams") {
  const ScanLayout layout = make_scan_layout({.beams = 3, .min_azimuth_rad = -0.01, .max_azimuth_rad = 0.01}, 2000);
  REQUIRE(layout.faces.size() == 1);
  // Tangents up to 0.01 at 1000 pixels each: 10 pixels to either side, and the neighbourhood.
  CHECK(layout.faces[0].width_px <= 2 * 11 + kPixelsBefore + kPixelsAfter + 1);
}

TEST_SUITE_END();
