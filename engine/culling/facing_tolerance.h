// Robust winding threshold: how thin a triangle must appear for the device's rounding to reverse its winding, or to
// bring it nearer than it is.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include <simvis/frame_plan.h>

namespace simvis {

/// The tolerance of a view. Let h be a triangle's smallest height, which is the height over its longest side, and D the
/// distance of the eye from the triangle's plane. The product h D measures how thin the triangle appears.
class FacingTolerance {
 public:
  FacingTolerance() = default;  ///< not usable
  /// `snap_px` is that of PassResult. The tolerance of an orthographic view is not usable.
  FacingTolerance(const View& view, double snap_px);

  bool is_usable() const { return snapped_ > 0; }

  /// Returns a threshold of h D, in m^2, for triangles between two depths along Z. Both depths are in metres and above
  /// 0, no side of the view clips the triangles, and rounding moves their corners by up to `slack_m`. If h D of a
  /// triangle exceeds the threshold:
  ///   - the triangle shows the same side as without rounding;
  ///   - its w = 1 / z exceeds that of its nearest corner by at most twice the difference between the w of the two
  ///   depths. If h D is k times the threshold, k >= 1, the excess is at most a k-th of that.
  double min_m2(double nearest_m, double farthest_m, double slack_m) const {
    const double snapped = snapped_ + rounded_ * slack_m / nearest_m;
    return snapped * farthest_m * farthest_m * farthest_m / nearest_m;
  }

 private:
  double snapped_ = 0, rounded_ = 0;
};

/// The position of the eye in a mesh's frame, and the length of the mesh's unit in metres.
struct EyeInMesh {
  glm::dvec3 place{0};
  double unit_m = 1;
};

/// The eye in the frame of a mesh with this transform. Empty unless the transform scales all axes equally.
std::optional<EyeInMesh> eye_in(const glm::dmat4& view_from_mesh);

/// (h D)^2 of a triangle of the mesh (see FacingTolerance), in the mesh's unit to the fourth. Not a number if its
/// corners are one point.
double squared_thickness(const EyeInMesh& eye, const glm::vec3& p, const glm::vec3& q, const glm::vec3& r);

}  // namespace simvis
