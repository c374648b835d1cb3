// The rays of one view of a camera, and what they hit, by the test's own geometry.
#pragma once

#include <optional>
#include <vector>

#include "tests/combinations/comparison.h"

namespace simvis::combined {

struct PixelRay {
  bool sees = false;  ///< false: beyond the lens
  Vector ray{0};      ///< optical frame
  ExactHit surface;   ///< the first one that the camera sees
  ExactHit hit;       ///< the same, or a splat before it at which half of the light is left
  /// A splat lies so near to a limit of what counts that rounding decides whether it is the hit.
  bool is_doubtful = false;
  std::vector<ExactHit> hits{};  ///< all surfaces that have their front towards the camera
};

class ViewRays {
 public:
  /// Of two cameras, the right one stands beside the sensor.
  ViewRays(const Comparison& comparison, Real right_m);

  const Comparison& with() const { return with_; }
  bool is_left() const { return right_m_ == 0; }

  /// Whether the camera casts its pixels; otherwise it draws them.
  bool is_cast() const;
  /// How far an edge may be from where it is, where this is the range.
  Real reach_px(Real range_m) const;

  Frame eye(Real share) const { return with_.world.sensor(with_.sensor, share) * Frame{Matrix(1), {0, -right_m_, 0}}; }
  /// Rows above and below the image are taken with its first and its last one.
  Real share_of_row(int row) const;
  PixelRay pixel(Real x_px, Real y_px, Real share) const;

  /// Without the backs of single-sided triangles.
  std::vector<ExactHit> surfaces(const Vector& origin, const Vector& direction, Real share) const;
  Seen seen() const;
  /// The range of `near` along a ray of the optical frame. It counts along the axis of the ray's view.
  Real near_m(const Vector& ray) const;

  static Vector sensor_of_optical(const Vector& v) { return {v.z, -v.x, -v.y}; }
  static Vector optical_of_sensor(const Vector& v) { return {-v.y, -v.z, v.x}; }

 private:
  void see_splats(PixelRay& pixel, const Frame& sensor, Real share) const;

  const Comparison& with_;
  Real right_m_;
  bool is_on_cube_;
};

/// The largest difference of places that snapping causes.
inline constexpr Real kSnapping_px = 0.5L / 256 * 1.41421356237309505L * 1.1L;

/// Whether the model of a lens says where it shows a direction of the optical frame: it does not beyond its end.
bool shows(const SensorDesc& desc, const Vector& view);

/// Where a point of a pixel is in another frame.
struct FollowedPoint {
  Vector from{0}, to{0};                     ///< of the point, in the world; of the sky, directions
  std::optional<glm::vec<2, Real>> at_px{};  ///< in the other image; empty: it has no such place
  bool is_defined = false;                   ///< whether the lens is defined there
};

/// The point of the pixel's surface at this range in the frame of the share `from`, and where it is at the share `to`.
FollowedPoint follow(const ViewRays& rays, const PixelRay& pixel, Real range_m, Real from, Real to);

/// Whether nothing of the other frame shows the point that a pixel shows; empty: rounding decides.
std::optional<bool> is_hidden(const ViewRays& rays, const PixelRay& pixel, Real from, Real to);

/// Compares the table of boxes with the pixels of the image and of a canvas with one more image on each side.
void compare_boxes(const ViewRays& rays);

}  // namespace simvis::combined
