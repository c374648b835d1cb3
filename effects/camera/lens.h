// How a lens bends what a pinhole would see: Brown and Conrady's model, and that of Kannala and Brandt for fisheyes.
//
// Both as OpenCV defines them (version 4.6, "Camera Calibration and 3D Reconstruction" and its "Fisheye camera model",
// https://docs.opencv.org/4.6.0/d9/d0c/group__calib3d.html and https://docs.opencv.org/4.6.0/db/d58/
// group__calib3d__fisheye.html). A point (X, Y, Z) of the view frame (x right, y down, z forward) is seen at pixel
// (fx x'' + cx, fy y'' + cy), with
//   brown_conrady   x' = X / Z, y' = Y / Z, r^2 = x'^2 + y'^2, s = 1 + k1 r^2 + k2 r^4 + k3 r^6
//                   x'' = x' s + 2 p1 x' y' + p2 (r^2 + 2 x'^2), y'' = y' s + p1 (r^2 + 2 y'^2) + 2 p2 x' y'
//   kannala_brandt  theta the angle from the optical axis, phi that around it,
//                   d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), (x'', y'') = d (cos phi, sin
//                   phi)
// Sources: D. C. Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32, 1966; J. Kannala and S. S.
// Brandt, "A generic camera model and calibration method for conventional, wide-angle, and fish-eye lenses", PAMI 28,
// 2006.
//
// From the optical axis outwards each model is one to one up to a fold, where a larger angle comes no farther from the
// middle of the image. Only what lies before it counts.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>

#include <simvis/frame_plan.h>

namespace simvis {

/// A fisheye sees nothing beyond this angle from its axis.
inline constexpr double kFisheyeLimit_rad = 110 * std::numbers::pi / 180;

enum class LensKind : std::uint8_t { brown_conrady, kannala_brandt };

struct LensModel {
  LensKind kind = LensKind::brown_conrady;
  Pinhole pinhole;  ///< fx, fy, cx, cy; pixels counted from the corner of the first one, not from its centre as OpenCV
  double k[4] = {0, 0, 0, 0};  ///< k[3] of the fisheye only
  double p1 = 0, p2 = 0;       ///< of brown_conrady only
};

class Lens {
 public:
  explicit Lens(const LensModel& model);

  /// The pixel at which a direction is seen that lies before the fold; brown_conrady: with z > 0.
  glm::dvec2 pixel(const glm::dvec3& direction) const;

  /// The direction, of unit length, that is seen at a pixel, so that pixel() of it is there to 1e-9 pixels. Zero: more
  /// than kFisheyeLimit_rad off the axis. Empty: beyond the fold.
  std::optional<glm::dvec3> direction(const glm::dvec2& pixel) const;

  /// How far from the principal point the image ends at the fold, without p1 and p2, as a multiple of the focal length.
  double reach() const;

 private:
  glm::dvec2 distorted(const glm::dvec2& tangents) const;
  glm::dmat2 jacobian(const glm::dvec2& tangents) const;
  std::optional<glm::dvec2> undistorted(const glm::dvec2& target) const;
  std::optional<double> angle(double radius) const;
  double radius(double angle_rad) const;
  double slope(double angle_rad) const;

  LensModel model_;
  double limit_rad_;  // of the model
  double fold_rad_;   // at most that
};

}  // namespace simvis
