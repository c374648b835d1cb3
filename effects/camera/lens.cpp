#include "effects/camera/lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace simvis {

namespace {

// Largest angle from the axis for brown_conrady; its tangent is 1e4.
constexpr double kPinholeLimit_rad = std::numbers::pi / 2 - 1e-4;

// In focal lengths: 1e-9 pixels at a focal length of 1000 pixels. Rounding errors are a thousandth of it.
constexpr double kResidual = 1e-12;
constexpr int kMaxSteps = 200;

double odd_polynomial(double x, std::span<const double> k) {
  const double s = x * x;
  double sum = 0;
  for (auto it = k.rbegin(); it != k.rend(); ++it) sum = (sum + *it) * s;
  return x * (1 + sum);
}

double slope_of_odd_polynomial(double x, std::span<const double> k) {
  const double s = x * x;
  double sum = 0;
  for (std::size_t i = k.size(); i-- > 0;) sum = (sum + static_cast<double>(2 * i + 3) * k[i]) * s;
  return 1 + sum;
}

}  // namespace

Lens::Lens(const LensModel& model)
    : model_(model),
      limit_rad_(model.kind == LensKind::kannala_brandt ? kFisheyeLimit_rad : kPinholeLimit_rad),
      fold_rad_(limit_rad_) {
  // Finds the first step in which the slope changes its sign, then bisects it.
  constexpr int kSteps = 4096;
  for (int i = 1; i <= kSteps; ++i) {
    double after = limit_rad_ * i / kSteps;
    if (slope(after) > 0) continue;
    double before = limit_rad_ * (i - 1) / kSteps;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = (before + after) / 2;
      (slope(middle) > 0 ? before : after) = middle;
    }
    fold_rad_ = before;
    return;
  }
}

double Lens::radius(double angle_rad) const {
  if (model_.kind == LensKind::kannala_brandt) return odd_polynomial(angle_rad, model_.k);
  return odd_polynomial(std::tan(angle_rad), std::span(model_.k).first(3));
}

// The derivative of radius() by the angle or, for brown_conrady, by its tangent; both have the same sign.
double Lens::slope(double angle_rad) const {
  if (model_.kind == LensKind::kannala_brandt) return slope_of_odd_polynomial(angle_rad, model_.k);
  return slope_of_odd_polynomial(std::tan(angle_rad), std::span(model_.k).first(3));
}

double Lens::reach() const { return radius(fold_rad_); }

glm::dvec2 Lens::distorted(const glm::dvec2& tangents) const {
  const auto [x, y] = std::array{tangents.x, tangents.y};
  const double r2 = x * x + y * y;
  const double s = 1 + r2 * (model_.k[0] + r2 * (model_.k[1] + r2 * model_.k[2]));
  return {x * s + 2 * model_.p1 * x * y + model_.p2 * (r2 + 2 * x * x),
          y * s + model_.p1 * (r2 + 2 * y * y) + 2 * model_.p2 * x * y};
}

// [column][row] as in glm: the derivatives by x, then by y.
glm::dmat2 Lens::jacobian(const glm::dvec2& tangents) const {
  const auto [x, y] = std::array{tangents.x, tangents.y};
  const double r2 = x * x + y * y, p1 = model_.p1, p2 = model_.p2;
  const double s = 1 + r2 * (model_.k[0] + r2 * (model_.k[1] + r2 * model_.k[2]));
  const double ds = 2 * (model_.k[0] + r2 * (2 * model_.k[1] + r2 * 3 * model_.k[2]));  // twice the derivative by r2
  const double across = x * y * ds + 2 * p1 * x + 2 * p2 * y;
  return {{s + x * x * ds + 2 * p1 * y + 6 * p2 * x, across}, {across, s + y * y * ds + 6 * p1 * y + 2 * p2 * x}};
}

// Newton's method. A step is shortened until it reduces the error and stays before the fold.
std::optional<glm::dvec2> Lens::undistorted(const glm::dvec2& target) const {
  const double farthest = std::tan(fold_rad_);
  glm::dvec2 tangents = target * std::min(1.0, 0.9 * farthest / std::max(glm::length(target), 1e-300));
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
  const bool found = glm::length(off) <= kResidual && glm::determinant(jacobian(tangents)) > 0;
  return found ? std::optional(tangents) : std::nullopt;
}

// The angle before the fold with this radius, by Newton's method within a bracket of two angles.
std::optional<double> Lens::angle(double target) const {
  double low = 0, high = fold_rad_, angle_rad = std::min(target, fold_rad_ / 2);
  if (target > radius(high)) return {};
  for (int i = 0; i < kMaxSteps; ++i) {
    const double off = radius(angle_rad) - target;
    (off > 0 ? high : low) = angle_rad;
    const double next = angle_rad - off / slope(angle_rad);
    const double inside = next > low && next < high ? next : (low + high) / 2;
    if (off == 0 || inside == angle_rad) break;
    angle_rad = inside;
  }
  return angle_rad;
}

glm::dvec2 Lens::pixel(const glm::dvec3& direction) const {
  const auto place = [&](const glm::dvec2& d) {
    const Pinhole& p = model_.pinhole;
    return glm::dvec2(p.cx_px + p.fx_px * d.x, p.cy_px + p.fy_px * d.y);
  };
  if (model_.kind == LensKind::brown_conrady) return place(distorted(glm::dvec2(direction) / direction.z));
  const double across = std::hypot(direction.x, direction.y);
  if (across == 0) return place({0, 0});
  return place(radius(std::atan2(across, direction.z)) / across * glm::dvec2(direction));
}

bool Lens::shows(const glm::dvec3& direction) const {
  if (model_.kind == LensKind::brown_conrady && direction.z <= 0) return false;
  return std::atan2(std::hypot(direction.x, direction.y), direction.z) < fold_rad_;
}

std::optional<glm::dvec3> Lens::direction(const glm::dvec2& pixel) const {
  const Pinhole& p = model_.pinhole;
  const glm::dvec2 d((pixel.x - p.cx_px) / p.fx_px, (pixel.y - p.cy_px) / p.fy_px);
  if (model_.kind == LensKind::brown_conrady) {
    const std::optional<glm::dvec2> tangents = undistorted(d);
    if (!tangents) return {};
    return glm::normalize(glm::dvec3(*tangents, 1));
  }
  const double across = glm::length(d);
  if (across == 0) return glm::dvec3(0, 0, 1);
  const std::optional<double> angle_rad = angle(across);
  if (angle_rad) return glm::dvec3(d / across * std::sin(*angle_rad), std::cos(*angle_rad));
  if (fold_rad_ < limit_rad_) return {};
  return glm::dvec3(0);
}

std::optional<Lens> lens_of(const Pinhole& pinhole, std::string_view distortion_model, std::span<const double> c) {
  if (distortion_model == "equidistant" && c.size() == 4) {
    return Lens({.kind = LensKind::kannala_brandt, .pinhole = pinhole, .k = {c[0], c[1], c[2], c[3]}});
  }
  if (distortion_model == "plumb_bob" && c.size() == 5) {
    return Lens(
        {.kind = LensKind::brown_conrady, .pinhole = pinhole, .k = {c[0], c[1], c[4], 0}, .p1 = c[2], .p2 = c[3]});
  }
  return std::nullopt;
}

}  // namespace simvis
