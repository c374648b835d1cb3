#include "sensors/laser_scanner/casting_order.h"

#include <algorithm>

#include <simvis/ray_caster.h>

namespace simvis {

namespace {

// The number of rings in a group that makes it no higher than wide.
std::uint32_t rings_together(const ScanPattern& pattern) {
  if (pattern.rings == 1 || pattern.beams == 1) return 1;
  const double step = (pattern.max_azimuth_rad - pattern.min_azimuth_rad) / (pattern.beams - 1);
  const double ring_step = (pattern.max_elevation_rad - pattern.min_elevation_rad) / (pattern.rings - 1);
  std::uint32_t rings = 1;
  while (2 * rings <= RayCaster::kPacketSize) {
    const auto beams_of_ring = static_cast<double>(RayCaster::kPacketSize / (2 * rings));
    if (2 * rings * ring_step > beams_of_ring * step) break;
    rings *= 2;
  }
  return rings;
}

}  // namespace

std::vector<std::uint32_t> casting_order(const ScanPattern& pattern) {
  const std::uint32_t height = rings_together(pattern), width = RayCaster::kPacketSize / height;
  std::vector<std::uint32_t> order, rest;
  order.reserve(std::size_t{pattern.rings} * pattern.beams);
  for (std::uint32_t bottom = 0; bottom < pattern.rings; bottom += height) {
    const std::uint32_t top = std::min(bottom + height, pattern.rings);
    for (std::uint32_t first = 0; first < pattern.beams; first += width) {
      const std::uint32_t end = std::min(first + width, pattern.beams);
      // Incomplete groups follow after all complete ones, so that each complete group begins at a multiple of the group
      // size.
      std::vector<std::uint32_t>& group = (top - bottom) * (end - first) == RayCaster::kPacketSize ? order : rest;
      for (std::uint32_t ring = bottom; ring < top; ++ring) {
        for (std::uint32_t beam = first; beam < end; ++beam) group.push_back(ring * pattern.beams + beam);
      }
    }
  }
  order.insert(order.end(), rest.begin(), rest.end());
  return order;
}

}  // namespace simvis
