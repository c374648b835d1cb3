#include "sensors/laser_scanner/table_order.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "engine/raycast/ray_packet.h"
#include "sensors/laser_scanner/scan_beams.h"

namespace simvis {
namespace {

constexpr std::size_t kPacket = RayPacket::kMax;
using BeamOrder = std::vector<std::uint32_t>;

struct TableRays {
  std::vector<glm::dvec3> directions{};
  std::vector<RayOrigin> origins{};  // empty: all beams start at the sensor's origin
};

TableRays rays_in_order(const ScanBeams& beams, const BeamOrder& order) {
  TableRays rays;
  for (const std::uint32_t beam : order) {
    rays.directions.push_back(beams.direction(beam));
    if (!beams.origin_m.empty()) rays.origins.push_back({beams.origin_m[beam], beams.origin_m[beam]});
  }
  return rays;
}

// A packet meets the boxes and triangles whose image overlaps its own. With images of the mean size s there are
// (width + s) (height + s) / s^2 of them for each layer of the scene. Origins that differ make a packet wider at the
// distance of the nearest objects.
double expected_cost(const TableRays& rays) {
  constexpr double kImage = 0.1, kNear_m = 1;  // shear; mean of scenes/marvin
  double cost = 0;
  for (std::size_t first = 0; first < rays.directions.size();) {
    const std::size_t left = std::min(kPacket - first % kPacket, rays.directions.size() - first);
    const std::span origins(rays.origins);
    const RayPacket packet(std::span(rays.directions).subspan(first, left), {},
                           origins.empty() ? origins : origins.subspan(first, left));
    const double wider = kImage + 2 * packet.spread_m / kNear_m;
    cost += (packet.high[0] - packet.low[0] + wider) * (packet.high[1] - packet.low[1] + wider);
    first += packet.count;
  }
  return cost;
}

// Halves the beams along the longest side of the box around their directions, at a multiple of a packet's size, until
// each part is a packet.
void halve(const std::vector<glm::dvec3>& directions, std::span<std::uint32_t> order) {
  if (order.size() <= kPacket) return;
  glm::dvec3 low(2), high(-2);
  for (const std::uint32_t i : order) {
    low = glm::min(low, directions[i]);
    high = glm::max(high, directions[i]);
  }
  const glm::dvec3 side = high - low;
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const std::size_t packets = (order.size() + kPacket - 1) / kPacket;
  const std::size_t half = packets / 2 * kPacket;
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [&](std::uint32_t i) { return std::pair(directions[i][axis], i); });
  halve(directions, order.first(half));
  halve(directions, order.subspan(half));
}

BeamOrder halved(const ScanBeams& beams) {
  BeamOrder order(beams.size());
  std::iota(order.begin(), order.end(), 0);
  const TableRays rays = rays_in_order(beams, order);
  halve(rays.directions, order);
  return order;
}

// As halved(), with the beams of one origin together.
BeamOrder halved_by_origin(const ScanBeams& beams) {
  BeamOrder order(beams.size());
  std::iota(order.begin(), order.end(), 0);
  const TableRays rays = rays_in_order(beams, order);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) {
    const glm::dvec3& origin = beams.origin_m[i];
    return std::tuple(origin.x, origin.y, origin.z);
  });
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    for (end = first + 1; end < order.size() && beams.origin_m[order[end]] == beams.origin_m[order[first]];) ++end;
    halve(rays.directions, std::span(order).subspan(first, end - first));
  }
  return order;
}

// The beams of each ring by azimuth, rings from the lowest to the highest.
std::vector<BeamOrder> by_azimuth(const ScanBeams& beams) {
  std::vector<std::pair<double, BeamOrder>> rings(beams.rings);
  for (std::uint32_t ring = 0; ring < beams.rings; ++ring) {
    auto& [elevation, order] = rings[ring];
    for (std::uint32_t i = ring * beams.beams; i < (ring + 1) * beams.beams; ++i) {
      elevation += beams.elevation_rad[i];
      order.push_back(i);
    }
    std::ranges::sort(order, {},
                      [&](std::uint32_t i) { return std::pair(std::remainder(beams.azimuth_deg[i], 360.0), i); });
  }
  std::ranges::stable_sort(rings, {}, [](const auto& ring) { return ring.first; });
  std::vector<BeamOrder> sorted;
  for (auto& ring : rings) sorted.push_back(std::move(ring.second));
  return sorted;
}

// Packets of `height` rings each. What is left over at the ends of rings comes last, so that each whole packet begins
// at a multiple of its size.
BeamOrder in_blocks(const std::vector<BeamOrder>& rings, std::size_t height) {
  const std::size_t width = kPacket / height, beams = rings[0].size();
  BeamOrder order, rest;
  for (std::size_t bottom = 0; bottom < rings.size(); bottom += height) {
    const std::size_t top = std::min(bottom + height, rings.size());
    for (std::size_t first = 0; first < beams; first += width) {
      const std::size_t end = std::min(first + width, beams);
      BeamOrder& block = (top - bottom) * (end - first) == kPacket ? order : rest;
      for (std::size_t ring = bottom; ring < top; ++ring) {
        block.insert(block.end(), rings[ring].begin() + static_cast<std::ptrdiff_t>(first),
                     rings[ring].begin() + static_cast<std::ptrdiff_t>(end));
      }
    }
  }
  order.insert(order.end(), rest.begin(), rest.end());
  return order;
}

}  // namespace

std::vector<std::uint32_t> table_order(const ScanBeams& beams) {
  BeamOrder best = halved(beams);
  if (beams.origin_m.empty() && beams.rings == 1) return best;
  double best_cost = expected_cost(rays_in_order(beams, best));
  const auto consider = [&](BeamOrder order) {
    const double cost = expected_cost(rays_in_order(beams, order));
    if (!(cost < best_cost)) return;
    best = std::move(order);
    best_cost = cost;
  };
  if (!beams.origin_m.empty()) consider(halved_by_origin(beams));
  if (beams.rings == 1) return best;
  const std::vector<BeamOrder> rings = by_azimuth(beams);
  for (std::size_t height = 1; height <= kPacket; height *= 2) consider(in_blocks(rings, height));
  return best;
}

}  // namespace simvis
