// The items that have moved since a scanner's previous measurement, for beams that left before the frame's time.
//
// An item was, the share b of the time earlier, where displacement() of its path at -b puts it. A ray that left then
// meets it where the ray moved by the inverse displacement meets the item as it is now, at the same range. So an item
// keeps its place and its tree, and the rays are moved instead.
//
// A ray's path through the objects that stand is that of the caster's world without the moved items: a hit on one of
// these is passed over by casting the ray again from behind it.
#pragma once

#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

class MovedItems {
 public:
  /// A ray as a moved item sees it.
  struct Seen {
    BeamRay ray;               ///< moved to the item as it is now
    glm::dmat3 ray_from_seen;  ///< turns normals back
  };

  MovedItems();
  ~MovedItems();

  /// Replaces hits[i] of rays that met a moved item as it is now, or that meet one as it was when they left.
  /// `caster`'s world is `list`.
  void cast(const ScanContext& context, const DrawList& list, std::span<const BeamRay> rays, RayCaster& caster,
            std::span<RayHit> hits);
  /// Ray i as the item of its hit sees it; null if it did not hit a moved item.
  const Seen* seen(std::size_t ray) const;
  /// Number of rays of the last cast().
  std::uint64_t rays() const { return rays_cast_; }

 private:
  struct OneMesh;
  void cast_behind_moved(const ScanContext& context, std::span<const BeamRay> rays, RayCaster& caster,
                         std::span<RayHit> hits);
  void meet(const ScanContext& context, const DrawList& list, const ItemMove& move, std::span<const BeamRay> rays,
            unsigned threads, std::span<RayHit> hits);

  std::vector<bool> has_moved_;                                       // by item
  std::unordered_map<const Mesh*, std::unique_ptr<OneMesh>> meshes_;  // with a tree
  std::vector<Seen> seen_;
  std::vector<std::size_t> seen_of_ray_;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace simvis
