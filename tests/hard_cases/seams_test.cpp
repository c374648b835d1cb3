// The seams between the virtual cameras of a scanner, and agreement of different scanners about the same beam.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "sensors/laser_scanner/scan_layout.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

HardCase in_skew_room(const ScanPattern& pattern, double resolution_px = 0) {
  HardCase hard;
  add_item(hard.world, skew_room(), glm::dmat4(1.0));
  hard.scanner.pattern = pattern;
  hard.scanner.resolution_px = resolution_px;
  hard.truth = [room = skew_room()](const glm::dvec3& d) { return convex_range(room, {0, 0, 0}, d); };
  return hard;
}

/// Two readings of one beam agree if each is within its own bound.
void check_agree(const Scan& a, std::size_t beam_of_a, const Scan& b, std::size_t beam_of_b) {
  const double first = a.range_m[beam_of_a], second = b.range_m[beam_of_b];
  CAPTURE(first);
  CAPTURE(second);
  CHECK(std::abs(first - second) <= static_cast<double>(a.error_bound_m[beam_of_a]) + b.error_bound_m[beam_of_b]);
}

std::array<const Scan*, 4> scans(const HardResults& results) {
  return {&results.nearest.scan, &results.planar.scan, &results.hybrid.scan, &results.raycast.scan};
}

/// Patterns with a beam on a border between horizontal faces, or the next number above or below it. Rounding decides
/// which of them occur, so they are searched: one for each kind of beam and each border of a span.
std::vector<ScanPattern> patterns_at_seams() {
  std::vector<ScanPattern> patterns;
  std::set<std::array<int, 4>> found;  // span, border, side
  std::array<int, 3> kinds{};
  constexpr std::array<std::array<double, 2>, 4> kSpans{{{-kPi / 2, kPi / 2}, {-kPi, kPi}, {-2.9, 1.1}, {0.3, 6.5}}};
  for (int span = 0; span < static_cast<int>(kSpans.size()); ++span) {
    const auto [min, max] = kSpans[span];
    const int faces = static_cast<int>(std::ceil((max - min) / (kPi / 2)));
    const double width = (max - min) / faces;
    for (std::uint32_t step = 1; step < 60; ++step) {
      const ScanPattern pattern{.beams = faces * step + 1, .min_azimuth_rad = min, .max_azimuth_rad = max};
      const std::vector<double> beams = azimuths(pattern);
      bool news = false;
      for (int border = 1; border < faces; ++border) {
        const double seam = min + border * width, beam = beams[border * step];
        const int side = beam == seam                               ? 0
                         : beam == std::nextafter(seam, -kInfinity) ? -1
                         : beam == std::nextafter(seam, kInfinity)  ? 1
                                                                    : 2;
        if (side != 2 && found.insert({span, border, side}).second) {
          news = true;
          ++kinds[side + 1];
        }
      }
      if (news) patterns.push_back(pattern);
    }
  }
  CHECK(kinds[0] > 1);
  CHECK(kinds[1] > 1);
  CHECK(kinds[2] > 1);
  return patterns;
}

/// Three rings: one at this elevation, one at the next double on each side.
ScanPattern rings_around(double elevation_rad, std::uint32_t samples) {
  ScanPattern pattern{.beams = samples,
                      .rings = 3,
                      .min_azimuth_rad = -kPi,
                      .max_azimuth_rad = kPi,
                      .min_elevation_rad = std::nextafter(elevation_rad, -kInfinity),
                      .max_elevation_rad = std::nextafter(elevation_rad, kInfinity)};
  REQUIRE(elevations(pattern)[1] == elevation_rad);
  return pattern;
}

}  // namespace

TEST_CASE("beams on the borders of horizontal faces and one ulp to each side") {
  std::vector<HardCase> cases;
  for (const ScanPattern& pattern : patterns_at_seams()) cases.push_back(in_skew_room(pattern));
  measure_together("beams on borders of faces and 1 ulp beside them, one ring", cases);
}

TEST_CASE("an edge between two walls, or of a wall in front of another one, on a border of faces") {
  // A half turn has its border straight ahead, where both faces have the centre of a pixel.
  const ScanPattern half_turn{.beams = 2001, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2};
  REQUIRE(azimuths(half_turn)[1000] == 0);
  const double pixel_rad = 1 / kPlanarResolution;  // beside the border; in the middle of a face it is twice as wide
  std::vector<HardCase> cases;
  const Patch behind{{9, -16, -4}, {-4, 32, 0}, {0, 0, 8}};
  const Patch right{{4, 0, -2}, {0.5f, -8, 0}, {0, 0, 4}};
  for (const float far_m : {3.0f, 5.0f}) {  // convex and concave, seen from the scanner
    const Patch left{{4, 0, -2}, {far_m - 4, 8, 0}, {0, 0, 4}};
    cases.push_back(patch_case("crease", {behind, left, right}));
    cases.push_back(patch_case("crease, turned", {behind, left, right}, glm::rotate(glm::dmat4(1.0), 0.3, {1, 0, 0})));
  }
  for (const float beside_px : {-0.75f, -0.25f, 0.25f, 0.75f}) {
    Patch edge = right;
    edge.corner.y = static_cast<float>(beside_px * pixel_rad * 4);
    edge.side_a.y = -8 - edge.corner.y;
    cases.push_back(patch_case("step", {behind, edge}));
  }
  for (HardCase& hard : cases) hard.scanner.pattern = half_turn;
  measure_together("creases and silhouettes on a border of faces", cases);
}

TEST_CASE("the first and last beam of a full turn agree") {
  std::vector<HardCase> cases;
  for (const double first : {-kPi, 0.0, 0.7}) {
    for (const std::uint32_t rings : {1u, 5u}) {
      cases.push_back(in_skew_room({.beams = 181,
                                    .rings = rings,
                                    .min_azimuth_rad = first,
                                    .max_azimuth_rad = first + 2 * kPi,
                                    .min_elevation_rad = rings > 1 ? -1.3 : 0,
                                    .max_elevation_rad = rings > 1 ? 1.1 : 0}));
    }
  }
  for (const HardResults& results : measure_together("full turns: first and last beam", cases)) {
    for (const Scan* scan : scans(results)) {
      for (std::uint32_t ring = 0; ring < scan->rings; ++ring) {
        check_agree(*scan, ring * scan->beams, *scan, (ring + 1) * scan->beams - 1);
      }
    }
  }
}

TEST_CASE("scanners with different fields of view, resolutions and numbers of rings agree about the same beam") {
  // Beams at multiples of 1/64 rad, which are exact in each pattern. The horizontal ring is ring 4 of nine.
  constexpr double kStep_rad = 1.0 / 64;
  constexpr std::array<std::array<double, 2>, 4> kSpans{{{-0.75, 0.5}, {-1, 1.25}, {-0.5, 3.5}, {-3, 3.25}}};
  std::vector<HardCase> cases;
  for (const auto& [min, max] : kSpans) {
    for (const double resolution_px : {64.0, 500.0, 4096.0}) {
      for (const std::uint32_t rings : {1u, 9u}) {
        if (rings > 1 && resolution_px > kRingsResolution) continue;
        cases.push_back(in_skew_room({.beams = static_cast<std::uint32_t>((max - min) / kStep_rad) + 1,
                                      .rings = rings,
                                      .min_azimuth_rad = min,
                                      .max_azimuth_rad = max,
                                      .min_elevation_rad = rings > 1 ? -1.0 : 0.0,
                                      .max_elevation_rad = rings > 1 ? 1.0 : 0.0},
                                     resolution_px));
      }
    }
  }
  const std::vector<HardResults> all = measure_together("the same beam from 20 scanners of 64 to 4096 pixels", cases);
  std::array<std::map<double, std::pair<const Scan*, std::size_t>>, 4> first_of;  // by method and azimuth
  std::size_t pairs = 0;
  for (const HardResults& results : all) {
    for (std::size_t method = 0; method < 4; ++method) {
      const Scan& scan = *scans(results)[method];
      const std::size_t level = scan.rings / 2 * scan.beams;
      REQUIRE(scan.elevation_rad[scan.rings / 2] == 0);
      for (std::size_t beam = 0; beam < scan.beams; ++beam) {
        const auto [other, is_first] = first_of[method].try_emplace(scan.azimuth_rad[beam], &scan, level + beam);
        if (is_first) continue;
        const auto& [other_scan, other_beam] = other->second;
        check_agree(scan, level + beam, *other_scan, other_beam);
        ++pairs;
        // Cast ranges depend on neither pixels nor faces.
        if (method == 3) CHECK(scan.range_m[level + beam] == other_scan->range_m[other_beam]);
      }
    }
  }
  CHECK(pairs > 4 * 1000);
}

TEST_CASE("the borders of a lidar's faces: steps of elevation, corners of the cube, straight up and down") {
  std::vector<HardCase> cases;
  // Rings one degree apart from straight down to straight up, beams at centres and borders of horizontal faces.
  cases.push_back(in_skew_room({.beams = 9,
                                .rings = 181,
                                .min_azimuth_rad = -kPi,
                                .max_azimuth_rad = kPi,
                                .min_elevation_rad = -kPi / 2,
                                .max_elevation_rad = kPi / 2}));
  const double edge = kPi / 4, corner = std::atan(std::cos(kPi / 4));
  for (const double elevation : {edge, -edge, corner, -corner}) {
    cases.push_back(in_skew_room(rings_around(elevation, 9)));
    // Within these three neighbouring numbers both a horizontal and an upright face are used.
    const ScanLayout layout = make_scan_layout(cases.back().scanner.pattern, kRingsResolution);
    std::set<bool> upright;
    for (std::uint32_t ring = 0; ring < 3; ++ring) {
      const std::size_t beam = ring * 9 + (std::abs(elevation) == edge ? 1 : 2);  // centre of a face; between two
      upright.insert(std::abs(layout.faces[layout.taps[beam].face].face_from_sensor[2].z) > 0.5);
    }
    CHECK(upright.size() == 2);
  }
  const std::vector<HardResults> all =
      measure_together("borders of a lidar's faces, cube corners, straight up and down", cases);
  // Straight up and straight down all beams are the same.
  for (const Scan* scan : scans(all.front())) {
    for (const std::size_t ring : {std::size_t{0}, std::size_t{180}}) {
      for (std::size_t beam = 1; beam < 9; ++beam) check_agree(*scan, ring * 9, *scan, ring * 9 + beam);
    }
  }
}

TEST_SUITE_END();
