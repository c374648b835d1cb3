// The order in which beams are cast.
#include "sensors/laser_scanner/casting_order.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <set>
#include <span>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/raycast/ray_packet.h"
#include "sensors/beam_tables/device_tables.h"
#include "sensors/laser_scanner/scan_beams.h"
#include "sensors/laser_scanner/table_order.h"
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

ScanBeams beams_of(std::string_view device) {
  const DeviceTable* const table = find_device_table(device);
  REQUIRE(table != nullptr);
  return table_beams(table->make(table->index));
}

bool has_every_beam_once(std::vector<std::uint32_t> order, std::size_t count) {
  std::ranges::sort(order);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    if (order[i] != i) return false;
  }
  return order.size() == count;
}

struct PacketsOfScan {
  std::size_t count = 0;
  double mean_extent = 0;  // width x height of a packet, in shears
};

PacketsOfScan packets(const ScanBeams& beams, const std::vector<std::uint32_t>& order) {
  std::vector<glm::dvec3> directions;
  std::vector<RayOrigin> origins;
  for (const std::uint32_t beam : order) {
    directions.push_back(beams.direction(beam));
    if (!beams.origin_m.empty()) origins.push_back({beams.origin_m[beam], beams.origin_m[beam]});
  }
  PacketsOfScan all;
  for (std::size_t first = 0; first < directions.size(); ++all.count) {
    const std::size_t left = std::min(RayPacket::kMax - first % RayPacket::kMax, directions.size() - first);
    const std::span<const RayOrigin> of_packet =
        origins.empty() ? std::span<const RayOrigin>() : std::span(origins).subspan(first, left);
    const std::span<const glm::dvec3> all_directions(directions);
    const RayPacket packet(all_directions.subspan(first, left), {}, of_packet);
    all.mean_extent += (packet.high[0] - packet.low[0]) * (packet.high[1] - packet.low[1]);
    first += packet.count;
  }
  all.mean_extent /= static_cast<double>(all.count);
  return all;
}

TEST_CASE("every beam of a table is cast once") {
  for (const DeviceTable& device : device_tables()) {
    CAPTURE(device.name);
    const ScanBeams beams = beams_of(device.name);
    CHECK(has_every_beam_once(table_order(beams), beams.size()));
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const auto& [rings, count] : {std::pair(1u, 1u), std::pair(1u, 77u), std::pair(5u, 1u), std::pair(3u, 41u)}) {
    for (const bool from_places : {false, true}) {
      CAPTURE(rings);
      CAPTURE(count);
      ScanBeams beams{.rings = rings, .beams = count};
      for (std::uint32_t i = 0; i < rings * count; ++i) {
        beams.azimuth_deg.push_back(180 * unit(random));
        beams.elevation_deg.push_back(90 * unit(random));
        beams.azimuth_rad.push_back(glm::radians(beams.azimuth_deg.back()));
        beams.elevation_rad.push_back(glm::radians(beams.elevation_deg.back()));
        if (from_places) beams.origin_m.emplace_back(unit(random), unit(random), 0);
      }
      CHECK(has_every_beam_once(table_order(beams), beams.size()));
    }
  }
}

TEST_CASE("packets of a table are as full and as compact as those of an even grid") {
  // The columns of an Ouster start at places of their own, and its beams are turned by up to 4.2 degrees against them.
  // Among beams in the order of azimuth that widens a packet of the grid, eight or four columns wide, by up to one
  // column on each side, so by less than twice. Beams of one column would extend over eight degrees and ten.
  const ScanBeams beams = beams_of("ouster_os1_128");
  const auto radians = [](double degrees) { return degrees * kPi / 180; };
  const ScanPattern grid{.beams = 1024,
                         .rings = 128,
                         .min_azimuth_rad = -kPi,
                         .max_azimuth_rad = kPi * 1022 / 1024,
                         .min_elevation_rad = radians(-21.82),
                         .max_elevation_rad = radians(20.95)};
  const PacketsOfScan of_table = packets(beams, table_order(beams)),
                      of_grid = packets(grid_beams(grid), casting_order(grid));
  CHECK(of_table.mean_extent < 2 * of_grid.mean_extent);
  CHECK(of_table.count < beams.size() / RayPacket::kMax * 11 / 10);
  // The 28,800 beams of a VLP-16 fill 900 packets. In groups of two rings, each of the planes x = +-y, which beams
  // cross four times, divides a packet into up to four.
  const ScanBeams vlp = beams_of("velodyne_vlp16");
  CHECK(packets(vlp, table_order(vlp)).count <= 900 + 8 * 4 * 3);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
