#include "sensors/laser_scanner/scan_beams.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <simvis/scan.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

std::vector<double> in_radians(const std::vector<double>& angles_deg) {
  std::vector<double> angles_rad;
  angles_rad.reserve(angles_deg.size());
  for (const double angle : angles_deg) angles_rad.push_back(glm::radians(angle));
  return angles_rad;
}

// Beams [first, first + count) of the table, which starts again after its end.
ScanBeams part_of_table(const BeamTable& table, std::size_t first, std::size_t count) {
  ScanBeams part;
  const auto copy = [&](const auto& from, auto& to) {
    for (std::size_t i = 0; i < count && !from.empty(); ++i) to.push_back(from[(first + i) % from.size()]);
  };
  copy(table.azimuth_deg, part.azimuth_deg);
  copy(table.elevation_deg, part.elevation_deg);
  copy(table.origin_m, part.origin_m);
  copy(table.channel, part.ring);
  part.azimuth_rad = in_radians(part.azimuth_deg);
  part.elevation_rad = in_radians(part.elevation_deg);
  return part;
}

BeamTable in_order_of_time(const BeamTable& table) {
  std::vector<std::uint32_t> order(table.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return table.time_ns[i]; });
  BeamTable sorted{.rings = 1, .beams = static_cast<std::uint32_t>(table.size())};
  const auto pick = [&](const auto& from, auto& to) {
    for (const std::uint32_t i : order) {
      if (!from.empty()) to.push_back(from[i]);
    }
  };
  pick(table.azimuth_deg, sorted.azimuth_deg);
  pick(table.elevation_deg, sorted.elevation_deg);
  pick(table.origin_m, sorted.origin_m);
  pick(table.time_ns, sorted.time_ns);
  pick(table.channel, sorted.channel);
  if (sorted.channel.empty() && table.rings > 1) {
    for (const std::uint32_t i : order) sorted.channel.push_back(i / table.beams);
  }
  return sorted;
}

}  // namespace

glm::dvec3 ScanBeams::direction(std::size_t i) const {
  return beam_direction(azimuth_rad[azimuth_rad.size() == beams ? i % beams : i],
                        elevation_rad[elevation_rad.size() == rings ? i / beams : i]);
}

ScanBeams grid_beams(const ScanPattern& pattern) {
  return {.rings = pattern.rings,
          .beams = pattern.beams,
          .azimuth_deg = azimuths_deg(pattern),
          .elevation_deg = elevations_deg(pattern),
          .azimuth_rad = azimuths(pattern),
          .elevation_rad = elevations(pattern)};
}

ScanBeams table_beams(const BeamTable& table) {
  ScanBeams beams = part_of_table(table, 0, table.size());
  beams.rings = table.rings;
  beams.beams = table.beams;
  if (table.time_ns.empty()) return beams;
  const std::int64_t last_ns = *std::ranges::max_element(table.time_ns);
  for (const std::int64_t time_ns : table.time_ns) {
    beams.age_s.push_back(static_cast<double>(last_ns - time_ns) / 1e9);
  }
  return beams;
}

RunningBeams::RunningBeams(const BeamTable& table, std::uint32_t count)
    : table_(in_order_of_time(table)), count_(count) {
  const std::int64_t last_ns = table_.time_ns.back();
  SIMVIS_ASSERT(last_ns > 0 && count >= 1 && count <= table_.size());
  std::size_t times = 1;  // beams that fire together are one step
  for (std::size_t i = 1; i < table_.size(); ++i) times += table_.time_ns[i] != table_.time_ns[i - 1] ? 1 : 0;
  period_ns_ = last_ns + std::llround(static_cast<double>(last_ns) / static_cast<double>(times - 1));
}

ScanBeams RunningBeams::at(std::int64_t time_ns) const {
  const std::int64_t now_ns = (time_ns % period_ns_ + period_ns_) % period_ns_;
  const std::size_t size = table_.size();
  const auto fired =
      static_cast<std::size_t>(std::ranges::upper_bound(table_.time_ns, now_ns) - table_.time_ns.begin());
  const std::size_t first = (fired + size - count_) % size;
  ScanBeams beams = part_of_table(table_, first, count_);
  beams.rings = 1;
  beams.beams = count_;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const std::int64_t ago_ns = now_ns - table_.time_ns[(first + i) % size];
    beams.age_s.push_back(static_cast<double>(ago_ns < 0 ? ago_ns + period_ns_ : ago_ns) / 1e9);
  }
  return beams;
}

}  // namespace simvis
