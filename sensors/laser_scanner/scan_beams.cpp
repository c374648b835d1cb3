#include "sensors/laser_scanner/scan_beams.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include <simvis/scan.h>
#include "engine/base/assert.h"
#include "sensors/laser_scanner/casting_order.h"

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

// Halves the beams along the longest side of the box around their directions, at a multiple of a packet's size, until
// each part is a packet.
void halve(const std::vector<glm::dvec3>& directions, std::span<std::uint32_t> order) {
  if (order.size() <= RayCaster::kPacketSize) return;
  glm::dvec3 low(2), high(-2);
  for (const std::uint32_t i : order) {
    low = glm::min(low, directions[i]);
    high = glm::max(high, directions[i]);
  }
  const glm::dvec3 side = high - low;
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const std::size_t packets = (order.size() + RayCaster::kPacketSize - 1) / RayCaster::kPacketSize;
  const std::size_t half = packets / 2 * RayCaster::kPacketSize;
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [&](std::uint32_t i) { return std::pair(directions[i][axis], i); });
  halve(directions, order.first(half));
  halve(directions, order.subspan(half));
}

std::vector<std::uint32_t> order_of_table(const ScanBeams& beams) {
  std::vector<glm::dvec3> directions;
  directions.reserve(beams.size());
  for (std::size_t i = 0; i < beams.size(); ++i) directions.push_back(beams.direction(i));
  std::vector<std::uint32_t> order(beams.size());
  std::iota(order.begin(), order.end(), 0);
  if (!beams.origin_m.empty()) {
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) {
      const glm::dvec3& origin = beams.origin_m[i];
      return std::tuple(origin.x, origin.y, origin.z);
    });
  }
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    end = beams.origin_m.empty() ? order.size() : first + 1;
    while (end < order.size() && beams.origin_m[order[end]] == beams.origin_m[order[first]]) ++end;
    halve(directions, std::span(order).subspan(first, end - first));
  }
  return order;
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

CastBeams cast_order(const ScanBeams& beams, std::vector<std::uint32_t> order) {
  CastBeams cast{.order = order.empty() ? order_of_table(beams) : std::move(order)};
  for (const std::uint32_t beam : cast.order) {
    cast.directions.push_back(beams.direction(beam));
    if (!beams.origin_m.empty()) cast.origins_m.push_back(beams.origin_m[beam]);
  }
  return cast;
}

// An origin o is transformed to the world as a sum of three products and the sensor's position p, with an error of less
// than d = 12 u (|o| + |p|), u = 2^-53, as in traced_scan.cpp. The caster's bound of a range r is that of corners that
// are displaced by e >= u (28 r + 21 |p + o|) (see ray_caster.h: reach and distance of the mesh are at least r
// together, and the offsets contain that of the ray's own origin), and each of its terms with e grows in proportion. A
// bound that is larger by the factor 1 + d / e therefore covers corners that are displaced by d + e.
void cast_from_origins(RayCaster& rays, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                       std::span<const glm::dvec3> directions, std::span<RayHit> hits, const HitsReady& there) {
  if (origins_m.empty()) return rays.cast(world_from_sensor, directions, hits, {}, there);
  rays.cast_from(world_from_sensor, origins_m, directions, hits);
  const double place_m = glm::length(glm::dvec3(world_from_sensor[3]));
  double displaced = 0, start_m = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (i == 0 || origins_m[i] != origins_m[i - 1]) {
      displaced = 12 * (glm::length(origins_m[i]) + place_m);
      start_m = glm::length(glm::dvec3(world_from_sensor * glm::dvec4(origins_m[i], 1)));
    }
    if (!std::isfinite(hits[i].range_m)) continue;
    hits[i].error_bound_m *= 1 + displaced / (28 * hits[i].range_m + 21 * start_m);
  }
  if (there) there(0, hits.size());
}

}  // namespace simvis
