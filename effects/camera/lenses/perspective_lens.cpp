// The distortions of perspective lenses of OpenCV (version 4.6, "Camera Calibration and 3D Reconstruction",
// https://docs.opencv.org/4.6.0/d9/d0c/group__calib3d.html). With x' = X / Z, y' = Y / Z, r^2 = x'^2 + y'^2:
//   radial       s = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
//   tangential   x'' = x' s + 2 p1 x' y' + p2 (r^2 + 2 x'^2) + s1 r^2 + s2 r^4
//   thin prism   y'' = y' s + p1 (r^2 + 2 y'^2) + 2 p2 x' y' + s3 r^2 + s4 r^4
//   tilt         of the image sensor by tau_x, then tau_y: (x'', y'', 1) is turned by R = Ry Rx and projected back
//                along the axis; with w = R (x'', y'', 1), the place is (R33 w1 - R13 w3, R33 w2 - R23 w3) / w3
// brown_conrady has k1 to k3, p1 and p2. rational_polynomial has all.
// Sources: D. C. Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32, 1966; D. Claus and A. W.
// Fitzgibbon, "A rational function lens distortion model for general cameras", CVPR 2005; J. Weng, P. Cohen and
// M. Herniou, "Camera calibration with distortion models and accuracy evaluation", PAMI 14, 1992 (thin prism);
// T. Louhichi et al., "Self-calibration of Scheimpflug cameras: an easy protocol", Meas. Sci. Technol. 18, 2007 (tilt).
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "effects/camera/lenses/radial_lens.h"

namespace simvis {
namespace {

constexpr AttributeSpec kBrownConradyRows[] = {{.name = "k1", .text = "of r^2"},
                                               {.name = "k2", .text = "of r^4"},
                                               {.name = "p1", .text = "tangential"},
                                               {.name = "p2", .text = "tangential"},
                                               {.name = "k3", .text = "of r^6"}};

constexpr AttributeSpec kRationalRows[] = {{.name = "k1", .text = "of r^2"},
                                           {.name = "k2", .text = "of r^4"},
                                           {.name = "p1", .text = "tangential"},
                                           {.name = "p2", .text = "tangential"},
                                           {.name = "k3", .text = "of r^6"},
                                           {.name = "k4", .text = "of r^2 in the divisor"},
                                           {.name = "k5", .text = "of r^4 in the divisor"},
                                           {.name = "k6", .text = "of r^6 in the divisor"},
                                           {.name = "s1", .text = "thin prism, of r^2 along x"},
                                           {.name = "s2", .text = "thin prism, of r^4 along x"},
                                           {.name = "s3", .text = "thin prism, of r^2 along y"},
                                           {.name = "s4", .text = "thin prism, of r^4 along y"},
                                           {.name = "tau_x",
                                            .unit = "deg",
                                            .text = "tilt of the image sensor about x",
                                            .min = -90,
                                            .max = 90,
                                            .open_min = true,
                                            .open_max = true},
                                           {.name = "tau_y",
                                            .unit = "deg",
                                            .text = "tilt of the image sensor about y",
                                            .min = -90,
                                            .max = 90,
                                            .open_min = true,
                                            .open_max = true}};

// In the order of calibrations.
enum Coefficient : std::size_t { kK1, kK2, kP1, kP2, kK3, kK4, kK5, kK6, kS1, kS2, kS3, kS4, kTauX, kTauY, kAll };
constexpr std::size_t kRadial = kS1, kWithPrism = kTauX;  // numbers of coefficients that calibrations may have
using Coefficients = std::array<double, kAll>;

// Largest angle from the axis; its tangent is 1e4.
constexpr double kPinholeLimit_rad = std::numbers::pi / 2 - 1e-4;

// The largest error of a place that is found, in focal lengths: 1e-9 pixels at a focal length of 1000 pixels. Most
// rounding errors are a thousandth of it.
constexpr double kResidual = 1e-12;
// Bounds the rounding of a tangent, as a share of it. It rounds once itself, once in its square, three times in the
// products of the square and once in the divisor. Near a pole of the divisor, slopes multiply it.
constexpr double kTangentError = 6 * 0x1p-53;
constexpr int kMaxSteps = 200;

// Directions around the axis in which the Jacobian is looked at, and rings of them up to the fold of the radial part.
constexpr int kAzimuths = 64, kRings = 1024;

// Between two of the azimuths the determinant of the symmetric part of the Jacobian is less than its least value there
// by at most this share of its range: it is a trigonometric polynomial of third degree in the azimuth, so that its
// second derivative is at most 9 times half its range (Bernstein), half a step from the minimum. Twice that.
constexpr double kBetweenAzimuths = 9 * (std::numbers::pi / kAzimuths) * (std::numbers::pi / kAzimuths) / 2;

// The quotient of two polynomials of the square of the tangent of the angle from the axis.
struct RadialQuotient {
  double above[3], below[3];

  static double sum(const double (&k)[3], double r2) { return 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])); }
  // Twice the derivative by the square.
  static double slope(const double (&k)[3], double r2) { return 2 * (k[0] + r2 * (2 * k[1] + r2 * 3 * k[2])); }

  double value(double r2) const { return sum(above, r2) / sum(below, r2); }
  double twice_slope(double r2) const {
    const double divisor = sum(below, r2);
    return (slope(above, r2) * divisor - sum(above, r2) * slope(below, r2)) / (divisor * divisor);
  }
  double radius(double tangent) const { return odd_polynomial(tangent, above) / sum(below, tangent * tangent); }
  // The derivative of radius() by the angle. Beyond the pole, where the divisor is 0, nothing is seen.
  double radius_slope(double tangent) const {
    const double r2 = tangent * tangent, divisor = sum(below, r2);
    if (!(divisor > 0)) return -1;
    return (slope_of_odd_polynomial(tangent, above) * divisor - r2 * sum(above, r2) * slope(below, r2)) /
           (divisor * divisor) * (1 + r2);
  }
};

// From (x'', y'', 1) to the place, times its third component.
glm::dmat3 tilt_of(double about_x, double about_y) {
  const double cx = std::cos(about_x), sx = std::sin(about_x), cy = std::cos(about_y), sy = std::sin(about_y);
  // glm takes columns.
  const glm::dmat3 turn =
      glm::dmat3({cy, 0, sy}, {0, 1, 0}, {-sy, 0, cy}) * glm::dmat3({1, 0, 0}, {0, cx, -sx}, {0, sx, cx});
  const glm::dvec3& axis = turn[2];
  return glm::dmat3({axis.z, 0, 0}, {0, axis.z, 0}, {-axis.x, -axis.y, 1}) * turn;
}

class PerspectiveLens : public LensModel {
 public:
  explicit PerspectiveLens(const Coefficients& k)
      : k_(k),
        radial_{{k[kK1], k[kK2], k[kK3]}, {k[kK4], k[kK5], k[kK6]}},
        radius_([radial = radial_](double angle_rad) { return radial.radius(std::tan(angle_rad)); },
                [radial = radial_](double angle_rad) { return radial.radius_slope(std::tan(angle_rad)); },
                kPinholeLimit_rad),
        fold_rad_(is_round() ? radius_.fold()
                             : end_of([this](double angle_rad) { return is_one_to_one_at(angle_rad); }, radius_.fold(),
                                      kRings)) {
    if (k[kTauX] == 0 && k[kTauY] == 0) return;
    tilt_ = tilt_of(k[kTauX], k[kTauY]);
  }

  bool shows(const glm::dvec3& direction) const override {
    if (!(direction.z > 0)) return false;
    if (!(std::atan2(std::hypot(direction.x, direction.y), direction.z) < fold_rad_)) return false;
    return !tilt_ || (*tilt_ * glm::dvec3(distorted(glm::dvec2(direction) / direction.z), 1)).z > 0;
  }

  glm::dvec2 place(const glm::dvec3& direction) const override {
    const glm::dvec2 straight = distorted(glm::dvec2(direction) / direction.z);
    if (!tilt_) return straight;
    const glm::dvec3 tilted = *tilt_ * glm::dvec3(straight, 1);
    return glm::dvec2(tilted) / tilted.z;
  }

  std::optional<glm::dvec3> direction(const glm::dvec2& place) const override {
    glm::dvec2 straight = place;
    if (tilt_) {
      const glm::dvec3 back = glm::inverse(*tilt_) * glm::dvec3(place, 1);
      if (!(back.z > 0)) return {};
      straight = glm::dvec2(back) / back.z;
    }
    const std::optional<glm::dvec2> tangents = undistorted(straight);
    if (!tangents) return {};
    return glm::normalize(glm::dvec3(*tangents, 1));
  }

  double reach() const override { return radius_(fold_rad_); }

 private:
  // Returns whether the distortion before the tilt depends on the radius alone.
  bool is_round() const {
    return std::ranges::all_of(std::array{kP1, kP2, kS1, kS2, kS3, kS4}, [&](std::size_t i) { return k_[i] == 0; });
  }
  bool is_one_to_one_at(double angle_rad) const;
  glm::dvec2 distorted(const glm::dvec2& tangents) const;
  glm::dmat2 jacobian(const glm::dvec2& tangents) const;
  std::optional<glm::dvec2> undistorted(const glm::dvec2& target) const;
  std::optional<glm::dvec2> undistorted_from(glm::dvec2 tangents, const glm::dvec2& target) const;

  Coefficients k_;
  RadialQuotient radial_;
  RisingFunction radius_;  // of the angle, without the tangential part, thin prism and tilt
  double fold_rad_;
  std::optional<glm::dmat3> tilt_{};  // empty: none
};

glm::dvec2 PerspectiveLens::distorted(const glm::dvec2& tangents) const {
  const auto [x, y] = std::array{tangents.x, tangents.y};
  const double r2 = x * x + y * y, p1 = k_[kP1], p2 = k_[kP2];
  const double s = radial_.value(r2);
  return {x * s + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + r2 * (k_[kS1] + r2 * k_[kS2]),
          y * s + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + r2 * (k_[kS3] + r2 * k_[kS4])};
}

// [column][row] as in glm: the derivatives by x, then by y.
glm::dmat2 PerspectiveLens::jacobian(const glm::dvec2& tangents) const {
  const auto [x, y] = std::array{tangents.x, tangents.y};
  const double r2 = x * x + y * y, p1 = k_[kP1], p2 = k_[kP2];
  const double s = radial_.value(r2), ds = radial_.twice_slope(r2);
  const double across = x * y * ds + 2 * p1 * x + 2 * p2 * y;
  const glm::dvec2 prism(2 * (k_[kS1] + 2 * r2 * k_[kS2]), 2 * (k_[kS3] + 2 * r2 * k_[kS4]));
  return {glm::dvec2(s + x * x * ds + 2 * p1 * y + 6 * p2 * x, across) + x * prism,
          glm::dvec2(across, s + y * y * ds + 6 * p1 * y + 2 * p2 * x) + y * prism};
}

// The lens is one to one in a disc about the axis in which the symmetric part of the Jacobian is positive definite:
// with the points, their places then move in directions less than 90 degrees apart. On the axis it is the unit matrix,
// and where it ceases to be positive definite its determinant is 0.
bool PerspectiveLens::is_one_to_one_at(double angle_rad) const {
  const double tangent = std::tan(angle_rad);
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (int i = 0; i < kAzimuths; ++i) {
    const double around_rad = 2 * std::numbers::pi * i / kAzimuths;
    const glm::dmat2 slopes = jacobian(tangent * glm::dvec2(std::cos(around_rad), std::sin(around_rad)));
    const double across = (slopes[0][1] + slopes[1][0]) / 2;
    const double determinant = slopes[0][0] * slopes[1][1] - across * across;
    least = std::min(least, determinant);
    most = std::max(most, determinant);
  }
  return least > kBetweenAzimuths * (most - least);
}

// Starts near the target, where most lenses leave it, else from the inverse of the radial part.
std::optional<glm::dvec2> PerspectiveLens::undistorted(const glm::dvec2& target) const {
  const double farthest = std::tan(fold_rad_), length = std::max(glm::length(target), 1e-300);
  const std::optional<glm::dvec2> found = undistorted_from(target * std::min(1.0, 0.9 * farthest / length), target);
  const std::optional<double> angle_rad = found ? std::nullopt : radius_.inverse(length);
  return angle_rad ? undistorted_from(target / length * std::tan(*angle_rad), target) : found;
}

// Newton's method. A step is shortened until it reduces the error and stays before the fold. It ends where no step
// does, so that its error is rounding.
std::optional<glm::dvec2> PerspectiveLens::undistorted_from(glm::dvec2 tangents, const glm::dvec2& target) const {
  const double farthest = std::tan(fold_rad_);
  glm::dvec2 off = distorted(tangents) - target;
  for (int i = 0; i < kMaxSteps && glm::length(off) > 0; ++i) {
    const glm::dvec2 step = glm::inverse(jacobian(tangents)) * off;
    bool nearer = false;
    for (double share = 1; share > 1e-6 && !nearer; share /= 2) {
      const glm::dvec2 next = tangents - share * step, next_off = distorted(next) - target;
      nearer = glm::length(next) < farthest && glm::length(next_off) < glm::length(off);
      if (nearer) {
        tangents = next;
        off = next_off;
      }
    }
    if (!nearer) break;
  }
  const glm::dmat2 slopes = jacobian(tangents);
  const double steepest = std::hypot(glm::length(slopes[0]), glm::length(slopes[1]));
  const double rounding = kTangentError * glm::length(tangents) * steepest;
  return glm::length(off) <= kResidual + rounding ? std::optional(tangents) : std::nullopt;
}

std::shared_ptr<const LensModel> perspective(std::span<const double> coefficients) {
  Coefficients all{};
  std::ranges::copy(coefficients, all.begin());
  return std::make_shared<PerspectiveLens>(all);
}

std::shared_ptr<const LensModel> brown_conrady(std::span<const double> coefficients) {
  return coefficients.size() == std::size(kBrownConradyRows) ? perspective(coefficients) : nullptr;
}

std::shared_ptr<const LensModel> rational_polynomial(std::span<const double> coefficients) {
  const std::size_t size = coefficients.size();
  return size == kRadial || size == kWithPrism || size == kAll ? perspective(coefficients) : nullptr;
}

// As few coefficients as OpenCV and ROS know for the lens: 8, 12 with a thin prism, 14 with a tilt.
std::vector<double> read_rational_polynomial(const AttributeValues& attributes) {
  std::vector<double> k = numbers_of(kRationalRows, attributes);
  for (const std::size_t tilt : {kTauX, kTauY}) k[tilt] = glm::radians(k[tilt]);
  const auto is_zero = [&](std::size_t first) {
    return std::all_of(k.begin() + static_cast<std::ptrdiff_t>(first), k.end(), [](double each) { return each == 0; });
  };
  k.resize(is_zero(kS1) ? kRadial : is_zero(kTauX) ? kWithPrism : kAll);
  return k;
}

}  // namespace

extern const LensType kBrownConrady;
constinit const LensType kBrownConrady{
    .name = "brown_conrady",
    .ros_name = "plumb_bob",
    .coefficients = kBrownConradyRows,
    .read = [](const AttributeValues& attributes) { return numbers_of(kBrownConradyRows, attributes); },
    .create = brown_conrady};

extern const LensType kRationalPolynomial;
constinit const LensType kRationalPolynomial{.name = "rational_polynomial",
                                             .ros_name = "rational_polynomial",
                                             .coefficients = kRationalRows,
                                             .read = read_rational_polynomial,
                                             .create = rational_polynomial};

}  // namespace simvis
