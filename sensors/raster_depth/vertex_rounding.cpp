#include "sensors/raster_depth/vertex_rounding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include <simvis/pose.h>
#include "engine/base/assert.h"
#include "engine/geometry/item_index.h"

namespace simvis {

namespace {

constexpr double kFloatRounding = 0x1p-24, kDoubleUnit = 0x1p-53;
constexpr double kTransform = 5, kCuts = 3;
// Three matrix products (world, view, clip) with four roundings per entry each.
constexpr double kDoubleRoundings = 3 * 4;

// Four bins per octave, from 2^-12 m (0.2 mm) to 2^12 m: the exponent and the two leading bits of the float.
constexpr auto kShift = 21;
constexpr int kFirst = std::bit_cast<std::int32_t>(0x1p-12f) >> kShift;

// A lower bound on the distance of a box at `centre` from the origin; the columns of `m` are its half axes.
double distance_of_box(const glm::dvec3& centre, const glm::dmat3& m) {
  const glm::dvec3 half = lengths_of(m);
  const double distance = glm::length(centre), radius = glm::length(half);
  if (!is_orthogonal(m) || half.x == 0 || half.y == 0 || half.z == 0) return distance - radius;
  const glm::dvec3 along(glm::dot(centre, m[0]) / half.x, glm::dot(centre, m[1]) / half.y,
                         glm::dot(centre, m[2]) / half.z);
  const double beyond = glm::length(glm::max(glm::abs(along) - half, glm::dvec3(0)));
  return beyond - 4 * kOrthogonal * (distance + radius);
}

// For lists up to this size, computing all bins at once is cheaper than searching.
constexpr std::size_t kFew = 128;

}  // namespace

int VertexRounding::bin(double range_m) {
  const int index = std::bit_cast<std::int32_t>(static_cast<float>(range_m)) >> kShift;
  return std::clamp(index - kFirst, 0, kBins - 1);
}

const std::array<double, VertexRounding::kBins>& VertexRounding::upper_limits() {
  static const auto limits = [] {
    std::array<double, kBins> values;
    for (int b = 0; b < kBins - 1; ++b) values[b] = std::bit_cast<float>((b + 1 + kFirst) << kShift);
    values[kBins - 1] = std::numeric_limits<double>::infinity();
    return values;
  }();
  return limits;
}

/// The quantities of one item that determine its displacement, or upper bounds on them for several items.
struct VertexRounding::Reach {
  ItemExtent extent;
  double distance_m = 0;                 // distance of the mesh's origin
  double nearest_m = 0, farthest_m = 0;  // of the mesh
  int first_bin = 0, last_bin = 0;

  void take_bins() {
    first_bin = bin(std::max(nearest_m, 0x1p-12) * (1 - 1e-6));
    last_bin = bin(farthest_m * (1 + 1e-6));
  }
  // Increases with each of the members above.
  double displacement_m(double limit_m) const {
    const double reach = extent.reach_m, edge = extent.edge_m;
    const double offset = extent.away_m + distance_m + reach;
    const double corner = std::min(limit_m + edge, farthest_m);  // farthest corner of a triangle that is seen there
    return kFloatRounding * (kTransform * (std::min(reach, corner + distance_m) + distance_m) +
                             kCuts * (2 * edge + corner) + corner) +
           kDoubleRoundings * kDoubleUnit * offset;
  }
};

VertexRounding::VertexRounding(const DrawList& list, const glm::dmat4& sensor_from_world)
    : sensor_from_world_(sensor_from_world) {
  if (list.changes.kept() && list.items.size() > kFew) {
    list_ = &list;
    version_ = list.changes.version();
    sensor_ = glm::dvec3(rigid_inverse(sensor_from_world)[3]);
    return;
  }
  const double* const limits = upper_limits().data();
  for (std::uint32_t item = 0; item < list.items.size(); ++item) {
    const DrawItem& i = list.items[item];
    if (!i.visible) continue;
    const Reach reach = reach_of(list, item, extent_of(*list.meshes[i.mesh], list.world_from_node[i.transform]));
    for (int b = reach.first_bin; b <= reach.last_bin; ++b) {
      displacement_m_[b] = std::max(displacement_m_[b], reach.displacement_m(limits[b]));
    }
  }
}

VertexRounding::Reach VertexRounding::reach_of(const DrawList& list, std::uint32_t item,
                                               const ItemExtent& extent) const {
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  const glm::dmat4& world_from_mesh = list.world_from_node[list.items[item].transform];
  const glm::dvec3 centre = 0.5 * (glm::dvec3(mesh.bounds_min) + glm::dvec3(mesh.bounds_max));
  const glm::dvec3 half = 0.5 * (glm::dvec3(mesh.bounds_max) - glm::dvec3(mesh.bounds_min));
  const glm::dmat3 linear = glm::dmat3(sensor_from_world_) * glm::dmat3(world_from_mesh);
  const glm::dvec3 middle(sensor_from_world_ * (world_from_mesh * glm::dvec4(centre, 1)));
  Reach reach;
  reach.extent = extent;
  reach.distance_m = glm::length(glm::dvec3(sensor_from_world_ * world_from_mesh[3]));
  reach.nearest_m = distance_of_box(middle, {half.x * linear[0], half.y * linear[1], half.z * linear[2]});
  reach.farthest_m = glm::length(middle) + extent.radius_m;
  reach.take_bins();
  return reach;
}

// The middle of an item's box, and so of its mesh's box, lies in the box of the node. The mesh's origin is no farther
// from the middle than the farthest corner is from the origin. distance_of_box() subtracts 4 kOrthogonal; the tolerance
// here covers this, the same amount again for its own sums, and a rest for rounding in double.
VertexRounding::Reach VertexRounding::reach_of_node(const ItemIndex& index, std::uint32_t node) const {
  constexpr double kRoom = 1e-9, kPlaceRoom = 1e-14;
  const BvhNode& box = index.tree().nodes[node];
  const glm::dvec3 low = index.origin() + glm::dvec3(box.low) - sensor_;
  const glm::dvec3 high = index.origin() + glm::dvec3(box.high) - sensor_;
  const double room_m = kPlaceRoom * (glm::length(index.origin()) + glm::length(sensor_));
  const double near = glm::length(glm::max(glm::max(low, -high), glm::dvec3(0))) - room_m;
  const double far = glm::length(glm::max(glm::abs(low), glm::abs(high))) + room_m;
  Reach reach;
  reach.extent = index.longest_below(node);
  reach.distance_m = (far + reach.extent.reach_m) * (1 + kRoom);
  reach.nearest_m = near - reach.extent.radius_m - 10 * kOrthogonal * (far + reach.extent.radius_m);
  reach.farthest_m = (far + reach.extent.radius_m) * (1 + kRoom);
  reach.take_bins();
  return reach;
}

// Visits the node with the largest upper bound first, and skips nodes whose bound is no larger than the displacement
// found so far.
void VertexRounding::find(int bin) const {
  SIMVIS_ASSERT(list_->changes.version() == version_);
  const ItemIndex& index = *index_of(*list_);
  const double limit_m = upper_limits()[static_cast<std::size_t>(bin)];
  double& found_m = displacement_m_[static_cast<std::size_t>(bin)];
  const auto in_bin = [bin](const Reach& reach) { return reach.first_bin <= bin && bin <= reach.last_bin; };
  struct Waiting {
    std::uint32_t node = 0;
    double max_m = 0;
  };
  const auto promise = [&](std::uint32_t node) -> Waiting {
    const Reach reach = reach_of_node(index, node);
    return {node, in_bin(reach) ? reach.displacement_m(limit_m) : 0};
  };
  Waiting waiting[Bvh::kMaxDepth + 2] = {promise(0)};
  for (std::size_t count = 1; count > 0;) {
    const Waiting next = waiting[--count];
    if (!(next.max_m > found_m)) continue;
    const BvhNode& node = index.tree().nodes[next.node];
    for (const std::uint32_t item :
         std::span(index.tree().order).subspan(node.count > 0 ? node.first : 0, node.count)) {
      if (!list_->items[item].visible) continue;
      const Reach reach = reach_of(*list_, item, index.extent(item));
      if (in_bin(reach)) found_m = std::max(found_m, reach.displacement_m(limit_m));
    }
    if (node.count > 0) continue;
    Waiting first = promise(node.first), second = promise(node.first + 1);
    if (first.max_m > second.max_m) std::swap(first, second);
    waiting[count++] = first;
    waiting[count++] = second;
  }
  known_[static_cast<std::size_t>(bin)] = true;
}

void VertexRounding::complete() {
  if (list_ == nullptr) return;
  for (int b = 0; b < kBins; ++b) {
    if (!known_[static_cast<std::size_t>(b)]) find(b);
  }
  list_ = nullptr;
}

double VertexRounding::at(double range_m) const {
  const auto b = static_cast<std::size_t>(bin(range_m));
  if (list_ != nullptr && !known_[b]) find(static_cast<int>(b));
  return displacement_m_[b];
}

}  // namespace simvis
