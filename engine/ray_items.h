// What rays can meet of a draw list: its items at their places, the same for every engine of ray_caster.h.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/bvh.h"
#include "engine/draw_list.h"
#include "engine/ray_caster.h"
#include "engine/ray_triangle.h"

namespace simvis {

/// By how much boxes are padded, as a share of the size of the coordinates in play: 32 half ulps of a float32.
inline constexpr double kPadding = 0x1p-19;

/// Boxes are cut here, so that products of their coordinates stay within float32.
inline constexpr double kFarthest = 1e18;

/// The box from `low` to `high`, grown by `padding` on every side.
Box padded_box(const glm::dvec3& low, const glm::dvec3& high, double padding);

double frobenius(const glm::dmat3& m);

/// A mesh of triangles and its unit frame, in which it lies in the unit ball: (p - centre) / radius. An engine derives
/// its own from it, with a tree.
class RayMesh {
 public:
  /// Meshes of so few triangles need no tree: testing them all costs less than walking one.
  static constexpr std::uint32_t kFew = 12;

  explicit RayMesh(std::shared_ptr<const Mesh> mesh);
  virtual ~RayMesh() = default;

  const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }
  std::uint32_t triangles() const { return triangles_; }
  const glm::dvec3& centre() const { return centre_; }        ///< of the mesh's box
  double radius() const { return radius_; }                   ///< half the box's diagonal; 0: no ray can meet it
  const glm::dvec3& half_size() const { return half_size_; }  ///< of the box, in radii

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::uint32_t triangles_;
  glm::dvec3 centre_, half_size_;
  double radius_;
};

/// An item in the world.
struct PlacedItem {
  std::uint32_t item = 0;  ///< of the draw list
  const RayMesh* mesh = nullptr;
  glm::dmat4 world_from_mesh{1.0};
  Box box{};  ///< padded; world frame, its origin moved to RayItems::origin()
};

/// Boxes are in the world frame with its origin moved to near the sensors: at most kReach_m away from whoever casts.
class RayItems {
 public:
  static constexpr double kReach_m = 1000;
  using MakeMesh = std::function<std::unique_ptr<RayMesh>(std::shared_ptr<const Mesh>)>;

  explicit RayItems(MakeMesh make_mesh) : make_mesh_(std::move(make_mesh)) {}

  /// Brings everything up to date with the list, for a sensor at this place.
  void update(const DrawList& list, const glm::dvec3& world_sensor);

  /// After update() for the first of these places in the frame of a sensor: how many of them, without a gap, it serves.
  std::size_t in_reach(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> places_m) const;

  /// In the order of the list's items.
  const std::vector<PlacedItem>& items() const { return items_; }
  const glm::dvec3& origin() const { return origin_; }

  /// By the last update(): whether there are other items than before, and which stand elsewhere.
  bool restructured() const { return restructured_; }
  const std::vector<std::uint32_t>& moved() const { return moved_; }

  RayCounters counters;  ///< what is the engine's own, the engine counts

 private:
  bool take_structure(const DrawList& list);
  void place(const DrawList& list, bool everything);

  MakeMesh make_mesh_;
  std::unordered_map<const Mesh*, std::unique_ptr<RayMesh>> meshes_;
  std::vector<DrawItem> list_items_;
  std::vector<std::shared_ptr<const Mesh>> list_meshes_;
  std::vector<PlacedItem> items_;
  std::vector<std::uint32_t> moved_;
  bool made_ = false, restructured_ = false, anchored_ = false;
  glm::dvec3 origin_{0};
};

/// An item as one sensor sees it.
struct SeenItem {
  std::uint64_t cast = 0;  ///< the cast for which this was made
  MeshPlacement placement;
  glm::dvec3 centre{0};              ///< of the mesh's box, sensor frame
  glm::dmat3 unit_from_sensor{1.0};  ///< for vectors: to the mesh's unit frame. Not if `one_by_one`
  double units_per_m = 1;            ///< about how long a vector of 1 m is there
  bool one_by_one = false;           ///< triangles are tested without a tree
  double corner_error_m = 0;         ///< by how much rounding may have displaced a corner
};

/// `world_from_sensor` is rigid.
SeenItem see(const PlacedItem& item, const glm::dmat4& world_from_sensor);

/// A ray in the unit frame of a mesh, from where it enters the mesh's box.
struct UnitRay {
  glm::dvec3 from{0}, way{0};  ///< `way` is about of unit length
  double start_m = 0;          ///< range at which it begins; `way` is 1 / units_per_m metres long
};

/// False where the ray, a unit vector from the sensor, does not run through the box before `end_m`.
bool enter_mesh(const SeenItem& item, const RayMesh& mesh, const glm::dvec3& direction, double end_m, UnitRay& ray);

}  // namespace simvis
