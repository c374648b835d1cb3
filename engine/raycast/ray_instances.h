// What rays can meet of a draw list: its items at their places, the same for every engine of ray_caster.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>
#include "engine/raycast/blas.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {

/// A tree over items into which moved ones were fitted is built anew where a ray has to look into so many times the
/// boxes that it had to when it was built.
inline constexpr double kMaxSahCostRatio = 2;

/// By how much boxes are padded, as a share of the size of the coordinates in play: 32 half ulps of a float32.
inline constexpr double kPadding = 0x1p-19;

/// Boxes are cut here, so that products of their coordinates stay within float32.
inline constexpr double kFarthest = 1e18;

/// The box from `low` to `high`, grown by `padding` on every side.
Box padded_box(const glm::dvec3& low, const glm::dvec3& high, double padding);

double frobenius(const glm::dmat3& m);

/// An item in the world.
struct RayInstance {
  std::uint32_t item = 0;  ///< of the draw list
  const Blas* mesh = nullptr;
  glm::dmat4 world_from_mesh{1.0};
  Box box{};  ///< padded; world frame, its origin moved to RayInstances::origin()
};

/// Boxes are in the world frame with its origin moved to near the sensors: at most kReach_m away from whoever casts.
class RayInstances {
 public:
  static constexpr double kReach_m = 1000;

  /// `cache`: a folder where trees of large meshes are kept; empty: nowhere.
  explicit RayInstances(std::filesystem::path cache) : cache_(std::move(cache)) {}

  /// Brings everything up to date with the list, for a sensor at this place.
  void update(const DrawList& list, const glm::dvec3& world_sensor);

  /// Whether, after update(), a sensor at this place is served by it, too.
  bool reaches(const glm::dvec3& world_sensor) const { return glm::distance(world_sensor, origin_) <= kReach_m; }

  /// After update() for the first of these places in the frame of a sensor: how many of them, without a gap, it serves.
  std::size_t in_reach(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> places_m) const;

  /// In the order of the list's items.
  const std::vector<RayInstance>& items() const { return items_; }
  const glm::dvec3& origin() const { return origin_; }

  /// By the last update(): whether there are other items than before, and which stand elsewhere, in any order.
  bool structure_changed() const { return structure_changed_; }
  const std::vector<std::uint32_t>& moved_items() const { return moved_; }

  RayCounters counters;  ///< what is the engine's own, the engine counts

 private:
  bool update_structure(const DrawList& list);
  void place(const DrawList& list, bool everything);
  void place(std::uint32_t placed, const glm::dmat4& world_from_mesh);

  std::filesystem::path cache_;
  std::unordered_map<const Mesh*, std::unique_ptr<Blas>> meshes_;
  std::vector<DrawItem> list_items_;
  std::vector<std::shared_ptr<const Mesh>> list_meshes_;
  std::vector<RayInstance> items_;
  StandingAt standing_;  // the numbers in items_
  std::vector<std::uint32_t> moved_;
  ListVersion version_;  // of the list as of the last update()
  bool made_ = false, structure_changed_ = false, anchored_ = false;
  glm::dvec3 origin_{0};
};

/// An item as one sensor sees it.
struct SeenItem {
  std::uint64_t cast = 0;  ///< the cast for which this was made
  MeshPlacement placement;
  /// From the mesh's unit frame to the sensor frame, lengths scaled such that its points come to lie in the unit ball.
  glm::mat3 scaled_linear{1.0f};
  glm::vec3 scaled_centre{0};
  double scale = 1;           ///< of these lengths, from metres
  double corner_error_m = 0;  ///< by how much rounding may have displaced a corner
  bool solid = false;         ///< at every point
};

/// All but `cast` and `solid`. `world_from_sensor` is rigid.
SeenItem see(const RayInstance& item, const glm::dmat4& world_from_sensor);

}  // namespace simvis
