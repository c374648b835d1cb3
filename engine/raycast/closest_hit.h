// The last word on what a ray meets, in double, the same for every engine of ray_caster.h: engines find candidates.
#pragma once

#include <span>
#include <vector>

#include "engine/raycast/ray_instances.h"

namespace simvis {

/// The nearest hit so far.
struct ClosestHit {
  double range_m = std::numeric_limits<double>::infinity();
  std::uint32_t placed = 0, primitive = 0;  ///< of RayInstances::items()
  double t_min_m = 0;                       ///< what is met at or before this range is passed
};

/// The world as one sensor sees it. One per thread: items are brought to the sensor when a ray comes near.
class RayView {
 public:
  /// For another cast: what was made for the last one is made anew.
  void begin(const DrawList& list, const RayInstances& items, const glm::dmat4& world_from_sensor);

  const glm::dmat4& world_from_sensor() const { return world_from_sensor_; }
  const RayInstances& items() const { return *items_; }
  const RayInstance& placed(std::uint32_t index) const { return items_->items()[index]; }
  const SeenItem& seen(std::uint32_t placed);

  /// Takes the triangle for the nearest hit if the ray meets it where it is solid, and nearer than `nearest`; at the
  /// same range, if its item comes first by content, see engine/canonical_order.h, or else its primitive.
  bool try_triangle(const ShearedRay& ray, std::uint32_t placed, std::uint32_t primitive,
                    const std::array<glm::dvec3, 3>& corners, ClosestHit& nearest) const;

  /// Range and bound of what was found.
  RayHit finish(const ShearedRay& ray, const ClosestHit& nearest);

  std::uint64_t item_tests = 0, triangle_tests = 0;  ///< of all casts, as the engine counts them: see RayCounters

 private:
  bool comes_before(const ClosestHit& nearest, std::uint32_t placed, std::uint32_t primitive) const;

  const DrawList* list_ = nullptr;
  const RayInstances* items_ = nullptr;
  glm::dmat4 world_from_sensor_{1.0};
  std::uint64_t cast_ = 0;
  std::vector<SeenItem> seen_;
};

/// Of a cast's `t_min_m`, which may be empty.
inline std::span<const double> part_of(std::span<const double> t_min_m, std::size_t first, std::size_t count) {
  return t_min_m.empty() ? t_min_m : t_min_m.subspan(first, count);
}

}  // namespace simvis
