// Conservative tiled occlusion culling for one view.
//
// The image is divided into tiles. An opaque occluder that covers a whole tile lowers the tile's far limit. An object
// is culled if, in every tile that its screen bounds touch, it lies behind that limit. No pixel that the device would
// draw is lost, with the device's rounding included: occluders are shrunk by the largest displacement for which the
// bounds of pixel_polygon.h hold. Occludees are grown by their own displacement, and in w = 1 / z they are assumed to
// be nearer by the excess that FacingTolerance::min_m2() bounds.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/culling/facing_tolerance.h"
#include "engine/culling/mesh_range.h"
#include "engine/culling/occluders.h"
#include "engine/culling/pixel_polygon.h"
#include "engine/geometry/clusters.h"
#include "engine/geometry/view_projection.h"

namespace simvis {

/// A box in the view frame.
struct ViewBox {
  glm::dvec3 center{0}, half_size{0};
  double slack_m = 0;  ///< rounding may move the content by this much, in any direction
};

ViewBox view_box(const ViewProjection& projection, const WorldBox& box);
/// The box of a cluster of a mesh with this transform.
ViewBox view_box(const glm::dmat4& view_from_mesh, const Cluster& cluster, double slack_m);

/// Where a shape appears at most, in pixels of the view, and its depths along Z, in metres; all of these with the
/// displacement that rounding may cause.
struct ViewExtent {
  double left = 0, right = 0, top = 0, bottom = 0;
  double nearest_m = 0, farthest_m = 0;
};

/// Reuses its memory from view to view. Orthographic views are not supported.
class OcclusionCuller {
 public:
  /// Starts a view without occluders. `snap_px` is that of PassResult.
  void begin(const View& view, double snap_px);

  /// Returns whether a face of an object in the box could be large enough to be a useful occluder.
  bool may_hold_occluders(const ViewBox& box) const;

  /// Adds opaque occluders of a mesh with this transform. Rounding moves the mesh's vertices by up to `slack_m`, in any
  /// direction. With `from_front`, only front faces are drawn, so occluders that show their backs are skipped.
  /// `mirrored`: view_from_mesh turns right-handed axes into left-handed ones.
  void add(std::span<const Occluder> occluders, const glm::dmat4& view_from_mesh, double slack_m, bool from_front,
           bool mirrored);

  /// Returns whether any occluder was added that may hide something.
  bool any() const { return any_; }

  /// Returns whether all triangles of the mesh, or of the cluster, are within the image and behind occluders. The
  /// triangles lie in the box.
  bool is_occluded(const ViewBox& box, const glm::dmat4& view_from_mesh, const MeshRange& mesh) const;
  bool is_occluded(const ViewBox& box, const glm::dmat4& view_from_mesh, const MeshRange& mesh,
                   const Cluster& cluster) const;

  /// Returns whether occluders hide the middle of the box, so that triangles of its content may be hidden too.
  bool hides_middle(const ViewBox& box) const;

  /// Returns the threshold of h D, see FacingTolerance, that each triangle in the extent must exceed to be occluded.
  /// Infinite if the extent is not occluded. The extent includes the displacement by `slack_m`.
  double min_seen_m2(const ViewExtent& extent, double slack_m) const;

 private:
  void add_occluder(std::span<const glm::dvec3> corners, double min_z_m, const PixelSlant& slant,
                    double min_uncertain_w);
  ViewExtent extent(const ViewBox& box) const;
  double clearance(const ViewExtent& extent) const;

  PixelSides sides_;
  FacingTolerance limit_;
  double width_ = 0, height_ = 0;
  double snapped_px_ = 0;  // the rasteriser moves a corner by no more than this
  double inwards_px_ = 0;  // an occluder certainly fills what lies so far within its edges along both axes
  Pinhole pinhole_;
  bool any_ = false;
  std::size_t columns_ = 0, rows_ = 0;  // number of tiles along each axis
  std::vector<float> hidden_below_;     // if any_, by tile: a surface with a smaller w is invisible there
};

}  // namespace simvis
