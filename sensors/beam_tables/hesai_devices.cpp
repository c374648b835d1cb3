// Beam tables of Hesai devices. The angles are those that Hesai's SDK takes for a unit without a calibration of its
// own; a unit's file of angles can be given as a CSV table. Channels are numbered from 0, in Hesai's order.
//
// The head turns clockwise, and the azimuths of the channels are clockwise from it. The first column looks backwards. A
// channel of a PandarXT fires at its own time, and the head turns meanwhile. The SDK's angles of the others hold for
// all channels of a column together, which fire together here: an even share of a turn at 10 Hz after the column
// before. Beams start at the axis.
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sensors/beam_tables/device_tables.h"
#include "sensors/beam_tables/turn.h"

namespace simvis {
namespace {

constexpr double kPandar64Elevation_deg[] = {
    14.803, 10.953, 7.98,   4.978,  2.961,  1.949,   1.781,   1.609,   1.443,   1.272,   1.105,   0.934,  0.767,
    0.596,  0.429,  0.258,  0.09,   -0.079, -0.248,  -0.416,  -0.587,  -0.754,  -0.924,  -1.092,  -1.263, -1.43,
    -1.601, -1.767, -1.939, -2.107, -2.277, -2.444,  -2.615,  -2.779,  -2.952,  -3.119,  -3.289,  -3.454, -3.627,
    -3.791, -3.963, -4.129, -4.3,   -4.464, -4.637,  -4.799,  -4.971,  -5.136,  -5.308,  -5.47,   -5.644, -5.805,
    -5.977, -6.14,  -7.142, -8.138, -9.139, -10.124, -11.111, -12.085, -13.053, -14.009, -18.968, -24.976};
constexpr double kPandar64Azimuth_deg[] = {
    -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, 1.042,  3.125,  5.208,  -5.208, -3.125, -1.042, 1.042,
    3.125,  5.208,  -5.208, -3.125, -1.042, 1.042,  3.125,  5.208,  -5.208, -3.125, -1.042, 1.042,  3.125,
    5.208,  -5.208, -3.125, -1.042, 1.042,  3.125,  5.208,  -5.208, -3.125, -1.042, 1.042,  3.125,  5.208,
    -5.208, -3.125, -1.042, 1.042,  3.125,  5.208,  -5.208, -3.125, -1.042, 1.042,  3.125,  5.208,  -5.208,
    -3.125, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042};

constexpr double kPandarQtElevation_deg[] = {
    -52.121, -49.785, -47.577, -45.477, -43.465, -41.528, -39.653, -37.831, -36.055, -34.32, -32.619, -30.95,  -29.308,
    -27.69,  -26.094, -24.517, -22.964, -21.42,  -19.889, -18.372, -16.865, -15.368, -13.88, -12.399, -10.925, -9.457,
    -7.994,  -6.535,  -5.079,  -3.626,  -2.175,  -0.725,  0.725,   2.175,   3.626,   5.079,  6.534,   7.993,   9.456,
    10.923,  12.397,  13.877,  15.365,  16.861,  18.368,  19.885,  21.415,  22.959,  24.524, 26.101,  27.697,  29.315,
    30.957,  32.627,  34.328,  36.064,  37.84,   39.662,  41.537,  43.475,  45.487,  47.587, 49.795,  52.133};
constexpr double kPandarQtAzimuth_deg[] = {
    8.736,  8.314, 7.964,  7.669,  7.417,  7.198,  7.007,  6.838,  6.688,  6.554,  6.434,  6.326,  6.228,
    6.14,   6.059, 5.987,  -5.27,  -5.216, -5.167, -5.123, -5.083, -5.047, -5.016, -4.988, -4.963, -4.942,
    -4.924, -4.91, -4.898, -4.889, -4.884, -4.881, 5.493,  5.496,  5.502,  5.512,  5.525,  5.541,  5.561,
    5.584,  5.611, 5.642,  5.676,  5.716,  5.759,  5.808,  5.862,  5.921,  -5.33,  -5.396, -5.469, -5.55,
    -5.64,  -5.74, -5.85,  -5.974, -6.113, -6.269, -6.447, -6.651, -6.887, -7.163, -7.493, -7.892};

constexpr double kPandarXtElevation_deg[] = {15, 14, 13, 12, 11, 10, 9,  8,  7,  6,   5,   4,   3,   2,   1,   0,
                                             -1, -2, -3, -4, -5, -6, -7, -8, -9, -10, -11, -12, -13, -14, -15, -16};

constexpr double kTurn_ns = 1e8;  // at 10 Hz

struct HesaiSpec {
  const char* name;
  std::uint32_t columns;                  // of a turn
  std::span<const double> elevation_deg;  // of each `every`th channel
  std::span<const double> azimuth_deg{};  // clockwise; empty: 0
  std::uint32_t every = 1;
  double cycle_ns, laser_ns = 0, first_ns = 0;  // of a column, from channel to channel, of the first
};

constexpr HesaiSpec kHesais[] = {
    {.name = "Hesai PandarXT-32",
     .columns = 2000,
     .elevation_deg = kPandarXtElevation_deg,
     .cycle_ns = 50000,
     .laser_ns = 1512,
     .first_ns = 368},
    {.name = "Hesai PandarXT-16",
     .columns = 2000,
     .elevation_deg = kPandarXtElevation_deg,
     .every = 2,
     .cycle_ns = 50000,
     .laser_ns = 3024,
     .first_ns = 368},
    {.name = "Hesai Pandar64",
     .columns = 1800,
     .elevation_deg = kPandar64Elevation_deg,
     .azimuth_deg = kPandar64Azimuth_deg,
     .cycle_ns = kTurn_ns / 1800},
    {.name = "Hesai PandarQT",
     .columns = 600,
     .elevation_deg = kPandarQtElevation_deg,
     .azimuth_deg = kPandarQtAzimuth_deg,
     .cycle_ns = kTurn_ns / 600},
};

BeamTable make_hesai_table(std::size_t i) {
  const HesaiSpec& spec = kHesais[i];
  const auto rings = static_cast<std::uint32_t>(spec.elevation_deg.size()) / spec.every;
  BeamTable table{.rings = rings, .beams = spec.columns};
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    const std::size_t channel = std::size_t{ring} * spec.every;
    const double offset_deg = spec.azimuth_deg.empty() ? 0 : spec.azimuth_deg[channel];
    const double fired_ns = spec.first_ns + ring * spec.laser_ns;
    for (std::uint32_t column = 0; column < spec.columns; ++column) {
      table.azimuth_deg.push_back(
          wrapped_deg(-180 - 360.0 / spec.columns * (column + fired_ns / spec.cycle_ns) - offset_deg));
      table.elevation_deg.push_back(spec.elevation_deg[channel]);
      table.time_ns.push_back(std::llround(column * spec.cycle_ns + fired_ns - spec.first_ns));
    }
  }
  return table;
}

}  // namespace

std::vector<DeviceTable> hesai_device_tables() {
  return {
      {"hesai_xt32", kHesais[0].name,
       "HesaiLidar_General_SDK 5fbcbb8, pandarXT.h: elevations, firing times 1.512 and 50 us; 0.18 degrees a column",
       make_hesai_table, 0},
      {"hesai_xt16", kHesais[1].name,
       "HesaiLidar_General_SDK 5fbcbb8, pandarXT.h: every second channel of a PandarXT-32", make_hesai_table, 1},
      {"hesai_pandar64", kHesais[2].name,
       "HesaiLidar_General_SDK be07fc7, angle_correction_Pandar64.csv; 0.2 degrees a column, which fires at once",
       make_hesai_table, 2},
      {"hesai_qt64", kHesais[3].name,
       "HesaiLidar_General_SDK 5fbcbb8, pandarQT.h; 0.6 degrees a column, which fires at once", make_hesai_table, 3},
  };
}

}  // namespace simvis
