// The test's own geometry of a scene: places, motions and rays in long double,
// from the numbers of the scene alone.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "tests/combinations/combined_scene.h"

namespace simvis::combined {

using Real = long double;
using Vector = glm::vec<3, Real>;
using Matrix = glm::mat<3, 3, Real>;

/// A rigid frame: a point p of it is at turn p + at in its parent.
struct Frame {
  Matrix turn{1};
  Vector at{0};
};

/// A screw motion by Chasles: a turn about a line through `point`, and a way
/// along it.
struct Twisting {
  Vector axis{0, 0, 1}, point{0};
  Real angle = 0, way = 0;
  Vector shift{0};  ///< instead of all that, if nothing turns
};

struct ExactHit {
  Real range_m = std::numeric_limits<Real>::infinity();
  int body = -1;  ///< -1: nothing
  int face = 0;   ///< 0 of round sides; then the sides of a box or the triangles
  Real cosine = 1;
  bool from_behind = false;       ///< of a triangle: its corners run clockwise as the ray sees them
  Vector normal{0}, in_shape{0};  ///< in the world, towards the ray's start; in
                                  ///< the frame of the shape
  Real rounding_m = 0;            ///< of the place of a splat: its file is in float32; 0: it is a surface
};

/// By how much the part of the light that a splat stops may be wrong, relative: its file is in float32.
inline constexpr Real kSplatShare = 1e-4L;

/// A splat on a ray: which part of the light it stops, and where. Parts below 1/255 count as none.
struct SplatHit {
  ExactHit hit;
  Real alpha = 0;
};

/// A scene at one frame. `share` is the share of the time from the frame before: 1 is now. Each joint turns or slides
/// evenly in that time, and each element `pose` goes on a screw of its own.
class ExactWorld {
 public:
  ExactWorld(const CombinedScene& scene, std::size_t frame);

  Frame sensor(std::size_t index, Real share) const;
  Frame body(std::size_t index, Real share) const;
  /// All surfaces along a ray of the world, the nearest first.
  std::vector<ExactHit> hits(const Vector& origin, const Vector& direction, Real share) const;
  /// All Gaussian splats along a ray of the world, the nearest first, without those that surely count as none.
  std::vector<SplatHit> splats(const Vector& origin, const Vector& direction, Real share) const;
  /// The velocity at a point of a body that stands where it is now, in the
  /// world, per frame.
  Vector way_per_frame(std::size_t body, const Vector& point) const;
  /// The turn that leads from a body's pose in the frame before to that of now, as a vector of the world, in radians.
  Vector turn_per_frame(std::size_t body) const;
  /// A bound on the error of products of poses in double, in metres: they round
  /// positions of this size.
  Real pose_rounding_m(std::size_t sensor) const;

 private:
  /// By body.
  const std::vector<Frame>& places(Real share) const;
  Frame place(const Body& body, const Frame& parent, Real share) const;

  const CombinedScene& scene_;
  std::size_t before_, now_;                           // frames
  mutable std::map<Real, std::vector<Frame>> places_;  // by share, as far as they were needed
};

Frame frame_of(const Place& place);
Frame operator*(const Frame& parent, const Frame& child);
Frame inverse(const Frame& frame);
/// A body in FRAME's parent, the world, in a frame of the scene.
Frame world_from_body(const CombinedScene& scene, int body, std::size_t frame);

/// The ray of a place in the picture, in the optical frame, of unit length;
/// empty: the lens sees nothing there.
std::optional<Vector> ray_of_pixel(const SensorDesc& camera, Real x_px, Real y_px);
/// The place of a direction; empty: it has none.
std::optional<glm::vec<2, Real>> pixel_of_ray(const SensorDesc& camera, const Vector& ray);
double focal_px(const SensorDesc& camera);

}  // namespace simvis::combined
