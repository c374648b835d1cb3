// How thin a triangle has to be seen for a device's rounding to turn it over, or to bring it nearer than it is.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include <simvis/frame_plan.h>

namespace simvis {

/// Of a view. Let h be a triangle's least height, which is that over its longest side, and D how far the eye lies from
/// its plane: h D says how thin it is seen.
class FacingTolerance {
 public:
  FacingTolerance() = default;  ///< nothing can be told
  /// `snap_px` as in PassResult. Nothing can be told of parallel views.
  FacingTolerance(const View& view, double snap_px);

  bool is_usable() const { return snapped_ > 0; }

  /// Of triangles between two depths along the optical axis, in metres, neither of which is 0 or less, none of them cut
  /// by a side of the view; rounding moves their corners by up to `slack_m`. With more than the result as h D, in m^2:
  ///   a triangle shows the side that it would without rounding;
  ///   it comes no nearer in w = 1 / z than its nearest corner, but for twice what lies between the w of the depths.
  ///   With k times as much as h D, k >= 1, for a k-th of that.
  double min_m2(double nearest_m, double farthest_m, double slack_m) const {
    const double snapped = snapped_ + rounded_ * slack_m / nearest_m;
    return snapped * farthest_m * farthest_m * farthest_m / nearest_m;
  }

 private:
  double snapped_ = 0, rounded_ = 0;
};

/// Where the eye is in a mesh's frame, and the mesh's unit of length there.
struct EyeInMesh {
  glm::dvec3 place{0};
  double unit_m = 1;
};

/// Of a mesh that is seen here; nothing unless it is of the same scale along all axes.
std::optional<EyeInMesh> eye_in(const glm::dmat4& view_from_mesh);

}  // namespace simvis
