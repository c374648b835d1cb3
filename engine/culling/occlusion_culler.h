// What of a view lies behind walls, and so need not be drawn.
//
// The picture is cut into tiles. Each wall that fills a tile says how far one can see there at the most; what lies
// behind that in all the tiles that it touches is hidden. What is said is certain, with the device's rounding: see
// pixel_polygon.h for walls. What hides is taken to reach a pixel farther than it does, and in w = 1 / z nearer by
// twice what lies between its nearest and its farthest point: see NormalConeCuller::sees_slivers().
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/culling/facing_tolerance.h"
#include "engine/culling/occluders.h"
#include "engine/culling/pixel_polygon.h"
#include "engine/geometry/clusters.h"
#include "engine/geometry/view_projection.h"
#include "engine/render/geometry_pool.h"

namespace simvis {

/// A box in the view frame.
struct ViewBox {
  glm::dvec3 center{0}, half_size{0};
  double slack_m = 0;  ///< by so much rounding may move what is in it, in any direction
};

ViewBox view_box(const ViewProjection& projection, const WorldBox& box);
/// Of a cluster of a mesh that is seen here.
ViewBox view_box(const glm::dmat4& view_from_mesh, const Cluster& cluster, double slack_m);

/// Keeps its memory from view to view. Not of parallel views.
class OcclusionCuller {
 public:
  /// Nothing is hidden. `limit` is the view's.
  void begin(const View& view, const FacingTolerance& limit);

  /// Whether a face of what lies in the box could be large enough to hide anything worth the while.
  bool may_hold_occluders(const ViewBox& box) const;

  /// Opaque walls of a mesh that is seen here; rounding moves its vertices by up to `slack_m`, in any direction.
  /// Of those drawn `from_front` alone, the ones that show their backs hide nothing; `mirrored`: view_from_mesh turns
  /// right-handed axes into left-handed ones.
  void add(std::span<const Occluder> occluders, const glm::dmat4& view_from_mesh, double slack_m, bool from_front,
           bool mirrored);

  /// Whether any wall was there that may hide something.
  bool any() const { return any_; }

  /// Whether all of a mesh's triangles, or a cluster's, that lie in the box are in the picture and behind walls.
  bool is_occluded(const ViewBox& box, const glm::dmat4& view_from_mesh, const MeshRange& mesh) const;
  bool is_occluded(const ViewBox& box, const glm::dmat4& view_from_mesh, const MeshRange& mesh,
                   const Cluster& cluster) const;

 private:
  void add_occluder(std::span<const glm::dvec3> corners, double min_z_m, const PixelSlant& slant,
                    double min_uncertain_w);
  double clearance(const ViewBox& box) const;
  double min_seen_m2(const ViewBox& box) const;

  PixelSides sides_;
  FacingTolerance limit_;
  double width_ = 0, height_ = 0;
  Pinhole pinhole_;
  bool any_ = false;
  std::size_t columns_ = 0, rows_ = 0;  // of tiles
  std::vector<float> hidden_below_;     // if any: by tile, what has a smaller w cannot be seen there
};

}  // namespace simvis
