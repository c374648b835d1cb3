// Lens models for distorted images: Brown and Conrady, and Kannala and Brandt for fisheye lenses.
//
// Both models follow OpenCV (version 4.6, "Camera Calibration and 3D Reconstruction" and its "Fisheye camera model",
// https://docs.opencv.org/4.6.0/d9/d0c/group__calib3d.html and
// https://docs.opencv.org/4.6.0/db/d58/group__calib3d__fisheye.html). A point (X, Y, Z) of the view frame (x right, y
// down, z forward) is projected to the pixel (fx x'' + cx, fy y'' + cy), with
//   brown_conrady   x' = X / Z, y' = Y / Z, r^2 = x'^2 + y'^2, s = 1 + k1 r^2 + k2 r^4 + k3 r^6
//                   x'' = x' s + 2 p1 x' y' + p2 (r^2 + 2 x'^2), y'' = y' s + p1 (r^2 + 2 y'^2) + 2 p2 x' y'
//   kannala_brandt  theta is the angle from the optical axis, phi the angle around it,
//                   d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8),
//                   (x'', y'') = d (cos phi, sin phi)
// Sources: D. C. Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32, 1966; J. Kannala and S. S.
// Brandt, "A generic camera model and calibration method for conventional, wide-angle, and fish-eye lenses", PAMI 28,
// 2006.
//
// Each model is one to one from the optical axis outwards up to a fold, where a larger angle no longer gives a larger
// distance from the principal point. Only directions before the fold are used.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>

#include <simvis/frame_plan.h>

namespace simvis {

/// The largest angle from the optical axis that a fisheye shows.
inline constexpr double kFisheyeLimit_rad = 110 * std::numbers::pi / 180;

enum class LensKind : std::uint8_t { brown_conrady, kannala_brandt };

struct LensModel {
  LensKind kind = LensKind::brown_conrady;
  Pinhole pinhole;             ///< pixels start at the corner of the first pixel, unlike OpenCV's (its centre)
  double k[4] = {0, 0, 0, 0};  ///< k[3] is used by kannala_brandt only
  double p1 = 0, p2 = 0;       ///< used by brown_conrady only
};

class Lens {
 public:
  explicit Lens(const LensModel& model);

  /// The pixel position of a direction. The direction must lie before the fold and, for brown_conrady, have z > 0.
  glm::dvec2 pixel(const glm::dvec3& direction) const;

  /// Whether pixel() may be called for the direction.
  bool shows(const glm::dvec3& direction) const;

  /// The direction that a pixel shows, a unit vector; pixel() of it gives this pixel to 1e-9 pixels. Zero if the
  /// direction is more than kFisheyeLimit_rad off the axis. Empty if the pixel lies beyond the fold.
  std::optional<glm::dvec3> direction(const glm::dvec2& pixel) const;

  /// The distance from the principal point to the fold, computed without p1 and p2, as a multiple of the focal length.
  double reach() const;

 private:
  glm::dvec2 distorted(const glm::dvec2& tangents) const;
  glm::dmat2 jacobian(const glm::dvec2& tangents) const;
  std::optional<glm::dvec2> undistorted(const glm::dvec2& target) const;
  std::optional<double> angle(double radius) const;
  double radius(double angle_rad) const;
  double slope(double angle_rad) const;

  LensModel model_;
  double limit_rad_;  // the largest angle of the model
  double fold_rad_;   // the angle of the fold, at most limit_rad_
};

/// The lens of a calibration: `distortion_model` is its name in ROS, with the coefficients in the order of ROS. Empty:
/// it is none of LensKind.
std::optional<Lens> lens_of(const Pinhole& pinhole, std::string_view distortion_model,
                            std::span<const double> coefficients);

}  // namespace simvis
