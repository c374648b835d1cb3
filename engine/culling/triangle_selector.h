// Selects the triangles of a mesh that can change a pixel of a view.
//
// A CPU device takes as long for a triangle that it discards as the host takes for tens of tests, and in most pictures
// the greater part of the triangles show their backs, lie between the centres of pixels or behind walls. The test is
// conservative to the sample: the device's rounding is taken into account, and whatever is uncertain is selected. So no
// byte of a picture changes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/culling/occlusion_culler.h"
#include "engine/geometry/clusters.h"

namespace simvis {

/// For perspective views that are no strips.
class TriangleSelector {
 public:
  /// `samples` is the number of samples of a pixel along each axis, all in the middles of equal parts of the pixel, as
  /// the device's standard locations are seen along one axis. `snap_px` is that of PassResult. `occlusion` outlives the
  /// view; triangles behind its occluders are not selected.
  void begin(const View& view, std::uint32_t samples, double snap_px, const OcclusionCuller& occlusion);

  /// Sets the mesh whose clusters follow. Rounding moves its vertices by up to `slack_m`. `culls_backs`: the device
  /// draws front faces only. `mirrored`: view_from_mesh turns right-handed axes into left-handed ones. `partly_hidden`:
  /// each triangle is compared with the occluders, which does not pay off for a mesh that is visible.
  void place(const glm::dmat4& view_from_mesh, double slack_m, bool culls_backs, bool mirrored, bool partly_hidden);

  /// Appends the corners of the selected triangles of a cluster. Spans as in Clustering.
  void select(const ClusterVertices& vertices, std::span<const std::uint8_t> corners,
              std::span<const glm::vec3> positions, std::vector<std::uint32_t>& selected) const;

 private:
  struct Corner {
    double u, v;          ///< in pixels of the view
    double z_m;           ///< depth along Z
    double uncertain_px;  ///< rounding moves it by up to this along each axis; infinity: it is not inside the view
  };

  Corner corner(const glm::vec3& position) const;
  bool can_change_a_pixel(const Corner& a, const Corner& b, const Corner& c) const;
  bool misses_samples(double low_px, double high_px, double uncertain_px) const;
  bool is_hidden(const Corner& a, const Corner& b, const Corner& c, const glm::vec3& p, const glm::vec3& q,
                 const glm::vec3& r) const;

  double width_px_ = 0, height_px_ = 0, near_m_ = 0;
  double fx_px_ = 0, fy_px_ = 0, cx_px_ = 0, cy_px_ = 0;
  double snap_px_ = 0, px_per_tangent_ = 0, samples_ = 1;
  glm::dvec4 row_u_{0}, row_v_{0}, row_z_{0};  // u = row_u . (p, 1) / row_z . (p, 1)
  double slack_m_ = 0;
  const OcclusionCuller* occlusion_ = nullptr;
  std::optional<EyeInMesh> eye_;  // empty: nothing hides triangles of the mesh
  double back_ = 0;  // 1 or -1: the sign of the area of a triangle that shows its back; 0: both sides are drawn
};

}  // namespace simvis
