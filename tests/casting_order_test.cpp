// In which order beams are cast.
#include "sensors/casting_order.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <vector>

#include "engine/ray_caster.h"

namespace simvis {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> order) {
  std::ranges::sort(order);
  return order;
}

std::vector<std::uint32_t> all_beams(const ScanPattern& pattern) {
  std::vector<std::uint32_t> beams(pattern.samples * pattern.rings);
  for (std::uint32_t i = 0; i < beams.size(); ++i) beams[i] = i;
  return beams;
}

TEST_CASE("every beam is cast once, whatever the pattern") {
  const ScanPattern patterns[] = {
      {.samples = 361, .rings = 1, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2},
      {.samples = 1, .rings = 1},
      {.samples = 1, .rings = 40, .min_elevation_rad = -0.2, .max_elevation_rad = 0.2},
      {.samples = 7, .rings = 3, .min_azimuth_rad = 0, .max_azimuth_rad = 1, .max_elevation_rad = 0.1},
      {.samples = 100, .rings = 50, .min_azimuth_rad = 0.5, .max_azimuth_rad = 0.5},           // all along one line
      {.samples = 33, .rings = 65, .max_azimuth_rad = 2 * kPi},                                // all rings alike
      {.samples = 2048, .rings = 63, .max_azimuth_rad = 2 * kPi, .max_elevation_rad = 0.001},  // hardly apart
  };
  for (const ScanPattern& pattern : patterns) {
    CAPTURE(pattern.samples);
    CAPTURE(pattern.rings);
    CHECK(sorted(casting_order(pattern)) == all_beams(pattern));
  }
}

TEST_CASE("the beams of a single ring are cast one after another") {
  const ScanPattern pattern{.samples = 361, .rings = 1, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2};
  CHECK(casting_order(pattern) == all_beams(pattern));
}

TEST_CASE("beams that travel together are neighbours along and across the rings") {
  // Rings 0.5 degrees apart, beams 0.25: two rings of 16 beams are 3.75 degrees wide and 0.5 high; four of eight would
  // be 1.75 wide and 1.5 high, which is no higher than wide; eight of four would be higher.
  const ScanPattern pattern{
      .samples = 1441, .rings = 8, .max_azimuth_rad = 2 * kPi, .max_elevation_rad = 7 * 0.5 * kPi / 180};
  const std::vector<std::uint32_t> order = casting_order(pattern);
  std::set<std::uint32_t> rings, columns;
  for (std::uint32_t i = 0; i < RayCaster::kTogether; ++i) {
    rings.insert(order[i] / pattern.samples);
    columns.insert(order[i] % pattern.samples);
  }
  CHECK(rings.size() == 4);
  CHECK(columns.size() == 8);
}

}  // namespace
}  // namespace simvis
