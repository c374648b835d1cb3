// The items of a draw list that rays can hit, with their transforms and boxes, for every engine of ray_caster.h.
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
#include "engine/geometry/box_padding.h"
#include "engine/raycast/blas.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {

double frobenius(const glm::dmat3& m);

/// Whether cameras do not see the backs of an item's surfaces. Discs have two fronts.
inline bool has_back(const Material& material, const Mesh& mesh) {
  return !material.double_sided && !is_cloud_of_discs(mesh);
}

/// An item in the world.
struct RayInstance {
  std::uint32_t item = 0;  ///< index into DrawList::items
  const Blas* mesh = nullptr;
  bool visible = true;  ///< rays pass an item that is not
  glm::dmat4 world_from_mesh{1.0};
  Box box{};  ///< padded; in the world frame with its origin moved to RayInstances::origin()
};

/// Boxes are in the world frame with its origin moved near the sensors: every sensor that casts is at most kReach_m
/// away from it.
class RayInstances {
 public:
  static constexpr double kReach_m = 1000;

  /// `cache`: folder that keeps the trees of large meshes; empty for none. `pool`: threads that build trees.
  RayInstances(std::filesystem::path cache, std::shared_ptr<ThreadPool> pool)
      : cache_(std::move(cache)), pool_(std::move(pool)) {}

  ThreadPool& threads() const { return *pool_; }

  /// Updates all instances to the list, for a sensor at `world_sensor`, in metres in the world frame. Of the list's
  /// items, those in `ignored` are not visible.
  void update(const DrawList& list, std::span<const std::uint32_t> ignored, const glm::dvec3& world_sensor);

  /// Whether the last update() also serves a sensor at this position.
  bool reaches(const glm::dvec3& world_sensor) const { return glm::distance(world_sensor, origin_) <= kReach_m; }

  /// How many of the leading positions in `places_m`, given in the frame of a sensor, the last update() serves. That
  /// update() must have been for the first of them.
  std::size_t in_reach(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> places_m) const;

  /// In the order of the list's items.
  const std::vector<RayInstance>& items() const { return items_; }
  const glm::dvec3& origin() const { return origin_; }

  /// Indices into items() of planes without end. Their boxes are those of their drawn parts, so that any ray may hit
  /// them outside of their boxes.
  std::span<const std::uint32_t> endless() const { return endless_; }

  /// Results of the last update(): whether the set of items changed, whether the mesh of any of them did, and the
  /// indices of the items that moved or have another mesh, in any order.
  bool structure_changed() const { return structure_changed_; }
  bool meshes_changed() const { return meshes_changed_; }
  const std::vector<std::uint32_t>& moved_items() const { return moved_; }

  RayCounters counters;  ///< each engine adds its own counts

 private:
  struct HeldBlas {
    std::shared_ptr<const Blas> blas;
    std::uint32_t uses = 0;  // items that have the mesh
  };
  static constexpr std::uint32_t kNotHit = ~0u;

  bool update_structure(const DrawList& list);
  bool update_items(const DrawList& list, std::span<const std::uint32_t> changed);
  void set_visible(const DrawList& list, std::span<const std::uint32_t> ignored);
  bool replace_mesh(const DrawList& list, std::uint32_t placed);
  HeldBlas& blas_of(const std::shared_ptr<const Mesh>& mesh, const std::filesystem::path& cache);
  void place(const DrawList& list, bool everything);
  void place(std::uint32_t placed, const glm::dmat4& world_from_mesh);

  std::filesystem::path cache_;
  std::shared_ptr<ThreadPool> pool_;
  std::unordered_map<const Mesh*, HeldBlas> meshes_;
  std::vector<DrawItem> list_items_;
  std::vector<std::shared_ptr<const Mesh>> list_meshes_;
  std::vector<RayInstance> items_;
  std::vector<std::uint32_t> endless_;
  std::vector<std::uint32_t> placed_of_;  // index into items_ by item of the list; kNotHit: there is none
  std::vector<std::uint32_t> ignored_;    // items of the list, at the last update()
  std::vector<std::uint32_t> replaced_;   // indices into items_ of those that got another mesh in this update()
  StandingAt standing_;                   // indices into items_ for each transform
  std::vector<std::uint32_t> moved_;
  ListVersion version_;  // version of the list at the last update()
  bool made_ = false, structure_changed_ = false, meshes_changed_ = false, anchored_ = false;
  glm::dvec3 origin_{0};
};

/// An item as one sensor sees it.
struct SeenItem {
  std::uint64_t cast = 0;  ///< number of the cast that these values belong to
  MeshPlacement placement;
  /// From the mesh's unit frame to the sensor frame, with lengths scaled so that all points of the item lie in the unit
  /// ball.
  glm::mat3 scaled_linear{1.0f};
  glm::vec3 scaled_centre{0};
  glm::dvec3 centre_m{0};     ///< of the mesh, sensor frame
  double scaled_radius = 0;   ///< mean half diagonal of the item in these lengths
  double scale = 1;           ///< factor from metres to these lengths
  double corner_error_m = 0;  ///< largest displacement of a corner by rounding
  double reach_m = 0,         ///< largest distance of a corner from the origin of its mesh
      place_m = 0;            ///< distance of that origin from the world's
  bool solid = false;         ///< whether the item is solid at every point
  bool passes_backs = false;  ///< whether rays pass the backs of its surfaces
  bool mirrored = false;      ///< whether `placement` turns the winding of triangles round
  static constexpr std::uint32_t kNoSurface = ~0u;
  std::uint32_t surface = kNoSurface;  ///< number of the item's shape in its RayView; kNoSurface: it has none
  std::uint32_t grid = kNoSurface;     ///< the same of its grid of heights
};

/// Sets all fields except `cast`, `solid`, `passes_backs`, `mirrored`, `surface` and `grid`. `world_from_sensor` is
/// rigid.
SeenItem see(const RayInstance& item, const glm::dmat4& world_from_sensor);

}  // namespace simvis
