// The order in which beams are cast.
#include "sensors/laser_scanner/casting_order.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <vector>

#include <simvis/ray_caster.h>
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> order) {
  std::ranges::sort(order);
  return order;
}

std::vector<std::uint32_t> all_beams(const ScanPattern& pattern) {
  std::vector<std::uint32_t> beams(pattern.beams * pattern.rings);
  for (std::uint32_t i = 0; i < beams.size(); ++i) beams[i] = i;
  return beams;
}

TEST_CASE("every beam is cast once for any pattern") {
  const ScanPattern patterns[] = {
      {.beams = 361, .rings = 1, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2},
      {.beams = 1, .rings = 1},
      {.beams = 1, .rings = 40, .min_elevation_rad = -0.2, .max_elevation_rad = 0.2},
      {.beams = 7, .rings = 3, .min_azimuth_rad = 0, .max_azimuth_rad = 1, .max_elevation_rad = 0.1},
      {.beams = 100, .rings = 50, .min_azimuth_rad = 0.5, .max_azimuth_rad = 0.5},           // all along one line
      {.beams = 33, .rings = 65, .max_azimuth_rad = 2 * kPi},                                // all rings equal
      {.beams = 2048, .rings = 63, .max_azimuth_rad = 2 * kPi, .max_elevation_rad = 0.001},  // almost parallel
  };
  for (const ScanPattern& pattern : patterns) {
    CAPTURE(pattern.beams);
    CAPTURE(pattern.rings);
    CHECK(sorted(casting_order(pattern)) == all_beams(pattern));
  }
}

TEST_CASE("the beams of a single ring are cast one after another") {
  const ScanPattern pattern{.beams = 361, .rings = 1, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2};
  CHECK(casting_order(pattern) == all_beams(pattern));
}

TEST_CASE("beams of one packet are neighbours along and across the rings") {
  // Rings 0.45 degrees apart, beams 0.25: four rings of eight beams take 2 degrees of width and 1.8 of height, eight of
  // four would take 1 and 3.6. One beam is left over in each four of the rings.
  const ScanPattern pattern{
      .beams = 1441, .rings = 8, .max_azimuth_rad = 2 * kPi, .max_elevation_rad = 7 * 0.45 * kPi / 180};
  const std::vector<std::uint32_t> order = casting_order(pattern);
  for (std::size_t first = 0; first < std::size_t{2 * 180} * RayCaster::kPacketSize; first += RayCaster::kPacketSize) {
    CAPTURE(first);
    std::set<std::uint32_t> rings, beams;
    for (std::size_t i = first; i < first + RayCaster::kPacketSize; ++i) {
      rings.insert(order[i] / pattern.beams);
      beams.insert(order[i] % pattern.beams);
    }
    CHECK(rings.size() == 4);
    CHECK(*rings.rbegin() - *rings.begin() == 3);
    CHECK(beams.size() == 8);
    CHECK(*beams.rbegin() - *beams.begin() == 7);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
