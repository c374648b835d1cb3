// Beam tables of Velodyne devices. A laser fires at its own time in a firing cycle, and the head turns meanwhile: the
// columns of a ring have equal steps, and each laser's azimuth is that of the head when it fires.
//
// A turn is a whole number of firing cycles and of packets, so that turns repeat: 1800 cycles of a VLP-16 (10.05 turns
// a second), 2160 of an HDL-32E (10.05), 1875 of a VLS-128 (10.01). The first column looks backwards.
//
// Beams do not start at one point. They meet the axis of rotation, from which distances are measured, at different
// heights: a laser with the elevation e crosses the axis at -f tan e, where f is the distance of the focal point from
// the axis; for the HDL-32E Velodyne's drawing lists the heights.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "sensors/beam_tables/device_tables.h"
#include "sensors/beam_tables/turn.h"

namespace simvis {
namespace {

// In the order in which the lasers of a packet fire.
constexpr double kVlp16Elevation_deg[] = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};

constexpr double kHdl32eElevation_deg[] = {-30.67, -9.33, -29.33, -8, -28, -6.67, -26.67, -5.33, -25.33, -4, -24, -2.67,
                                           -22.67, -1.33, -21.33, 0,  -20, 1.33,  -18.67, 2.67,  -17.33, 4,  -16, 5.33,
                                           -14.67, 6.67,  -13.33, 8,  -12, 9.33,  -10.67, 10.67};
constexpr double kHdl32eHeight_mm[] = {17.17, 4.76,  16.27, 4.07,  15.4, 3.38,  14.54, 2.7,   13.71, 2.02, 12.89,
                                       1.35,  12.09, 0.67,  11.31, 0,    10.54, -0.67, 9.78,  -1.35, 9.04, -2.02,
                                       8.3,   -2.7,  7.58,  -3.38, 6.86, -4.07, 6.15,  -4.76, 5.45,  -5.45};

constexpr double kVls128Rotation_deg[] = {
    -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,
    2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548,
    -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,
    6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911,
    0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354,
    -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,
    4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732,
    -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,
    -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,
    2.732,  4.548,  6.354,  -6.354, -4.548, -2.732, -0.911, 0.911,  2.732,  4.548,  6.354,
};
constexpr double kVls128Elevation_deg[] = {
    -11.742, -1.99, 3.4,   -5.29,  -0.78, 4.61,  -4.08, 1.31,    -6.5,  -1.11,   4.28,   -4.41, 0.1,     6.48,  -3.2,
    2.19,    -3.86, 1.53,  -9.244, -1.77, 2.74,  -5.95, -0.56,   4.83,  -2.98,   2.41,   -6.28, -0.89,   3.62,  -5.07,
    0.32,    7.58,  -0.34, 5.18,   -3.64, 1.75,  -25,   -2.43,   2.96,  -5.73,   0.54,   9.7,   -2.76,   2.63,  -7.65,
    -1.55,   3.84,  -4.85, 3.18,   -5.51, -0.12, 5.73,  -4.3,    1.09,  -16.042, -2.21,  4.06,  -4.63,   0.76,  15,
    -3.42,   1.97,  -6.85, -1.33,  -5.62, -0.23, 5.43,  -3.53,   0.98,  -19.582, -2.32,  3.07,  -4.74,   0.65,  11.75,
    -2.65,   1.86,  -7.15, -1.44,  3.95,  -2.1,  3.29,  -5.4,    -0.01, 4.5,     -4.19,  1.2,   -13.565, -1.22, 4.17,
    -4.52,   0.87,  6.08,  -3.31,  2.08,  -6.65, 1.42,  -10.346, -1.88, 3.51,    -6.06,  -0.67, 4.72,    -3.97, 2.3,
    -6.39,   -1,    4.39,  -5.18,  0.21,  6.98,  -3.09, 4.98,    -3.75, 1.64,    -8.352, -2.54, 2.85,    -5.84, -0.45,
    8.43,    -2.87, 2.52,  -6.17,  -1.66, 3.73,  -4.96, 0.43,
};

struct VelodyneSpec {
  const char* name;
  std::uint8_t model;
  std::uint32_t columns;            // of a turn
  std::uint32_t stamped_laser = 0;  // as VelodynePackets
  double cycle_ns;                  // of one firing cycle
  double distance_unit_m;
  double focal_mm = 0;                      // 0: heights are listed
  std::span<const double> elevation_deg;    // by laser
  std::span<const double> rotation_deg{};   // by laser; empty: 0
  std::span<const double> height_mm{};      // by laser; empty: by focal_mm
  double (*fired_ns)(std::uint32_t laser);  // after the beginning of the cycle
};

constexpr VelodyneSpec kVelodynes[] = {
    {.name = "Velodyne VLP-16",
     .model = 0x22,
     .columns = 1800,
     .cycle_ns = 55296,
     .distance_unit_m = 0.002,
     .focal_mm = 41.91,
     .elevation_deg = kVlp16Elevation_deg,
     .fired_ns = [](std::uint32_t laser) { return 2304.0 * laser; }},
    {.name = "Velodyne HDL-32E",
     .model = 0x21,
     .columns = 2160,
     .cycle_ns = 46080,
     .distance_unit_m = 0.002,
     .elevation_deg = kHdl32eElevation_deg,
     .height_mm = kHdl32eHeight_mm,
     .fired_ns = [](std::uint32_t laser) { return 1152.0 * laser; }},
    // Groups of eight lasers; after the eighth group the lasers wait for the time of one group. The fourth stamps.
    {.name = "Velodyne VLS-128",
     .model = 0xa1,
     .columns = 1875,
     .stamped_laser = 24,
     .cycle_ns = 53300,
     .distance_unit_m = 0.004,
     .focal_mm = 58.63,
     .elevation_deg = kVls128Elevation_deg,
     .rotation_deg = kVls128Rotation_deg,
     .fired_ns = [](std::uint32_t laser) { return 2665.0 * (laser / 8 + laser / 64); }},
};

double height_m(const VelodyneSpec& spec, std::uint32_t laser) {
  const double height_mm = spec.height_mm.empty() ? -spec.focal_mm * std::tan(glm::radians(spec.elevation_deg[laser]))
                                                  : spec.height_mm[laser];
  return height_mm / 1000;
}

void add_ring(const VelodyneSpec& spec, std::uint32_t laser, BeamTable& table) {
  const double step_deg = 360.0 / spec.columns, fired_ns = spec.fired_ns(laser);
  const double rotation_deg = spec.rotation_deg.empty() ? 0 : spec.rotation_deg[laser];
  for (std::uint32_t column = 0; column < spec.columns; ++column) {
    const double turned_deg = step_deg * (column + fired_ns / spec.cycle_ns);  // clockwise
    table.azimuth_deg.push_back(wrapped_deg(rotation_deg - 180 - turned_deg));
    table.elevation_deg.push_back(spec.elevation_deg[laser]);
    table.origin_m.emplace_back(0, 0, height_m(spec, laser));
    table.time_ns.push_back(std::llround(column * spec.cycle_ns + fired_ns));
  }
}

BeamTable make_velodyne_table(std::size_t i) {
  const VelodyneSpec& spec = kVelodynes[i];
  auto device = std::make_shared<ScannerDevice>();
  device->name = spec.name;
  device->velodyne = {.model = spec.model,
                      .distance_unit_m = spec.distance_unit_m,
                      .stamped_laser = spec.stamped_laser,
                      .laser_of_ring = std::vector<std::uint32_t>(spec.elevation_deg.size())};
  std::vector<std::uint32_t>& lasers = device->velodyne.laser_of_ring;
  std::iota(lasers.begin(), lasers.end(), 0);
  std::ranges::stable_sort(lasers, {}, [&](std::uint32_t laser) { return spec.elevation_deg[laser]; });
  BeamTable table{.rings = static_cast<std::uint32_t>(lasers.size()), .beams = spec.columns};
  for (const std::uint32_t laser : lasers) add_ring(spec, laser, table);
  table.device = std::move(device);
  return table;
}

}  // namespace

std::vector<DeviceTable> velodyne_device_tables() {
  return {
      {"velodyne_vlp16", kVelodynes[0].name,
       "VLP-16 User Manual, 63-9243 Rev. E: elevations, focal distance 41.91 mm, firing times 2.304 and 55.296 us",
       make_velodyne_table, 0},
      {"velodyne_hdl32e", kVelodynes[1].name,
       "HDL-32E User Manual, p. 10: elevations; 63-9277 Rev. D: firing times 1.152 and 46.080 us; envelope drawing "
       "86-0106 Rev. B, p. 2: heights",
       make_velodyne_table, 1},
      {"velodyne_vls128", kVelodynes[2].name,
       "VLS-128 User Manual, pp. 49 and 61: groups of eight lasers, 2.665 and 53.3 us; angles and focal distance "
       "58.63 mm of velodyne_decoder 3.1.0 (Valgur), calib_db.cpp",
       make_velodyne_table, 2},
  };
}

}  // namespace simvis
