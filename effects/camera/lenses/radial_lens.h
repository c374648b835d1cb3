// Lenses that are round about the optical axis: the distance from the principal point depends on the angle from the
// axis alone.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>

#include "effects/camera/lens.h"

namespace simvis {

/// Where a condition that holds at 0 ceases to hold: the first of so many even steps up to the limit in which it does,
/// bisected. The limit: it holds at every step.
double end_of(const std::function<bool(double)>& holds, double limit, int steps);

/// A function of numbers from 0 on, 0 at 0, that rises up to its fold.
class RisingFunction {
 public:
  using Formula = std::function<double(double)>;

  /// `slope` has the sign of the derivative of `value`, and is the derivative within [0, limit] before the fold. It is
  /// above 0 at 0.
  RisingFunction(Formula value, Formula slope, double limit);

  double operator()(double x) const { return value_(x); }
  /// Where the slope ceases to be above 0, at most the limit.
  double fold() const { return fold_; }

  /// Where the function has this value, at least 0, to rounding. Empty: nowhere before the fold.
  std::optional<double> inverse(double value) const;

 private:
  Formula value_, slope_;
  double fold_;
};

/// The odd polynomial x (1 + k[0] x^2 + k[1] x^4 + ...).
double odd_polynomial(double x, std::span<const double> k);
/// Its derivative.
double slope_of_odd_polynomial(double x, std::span<const double> k);

class RadialLens : public LensModel {
 public:
  /// Which of angle (from the axis, rad) and radius (of places) the function gives for the other one.
  enum class Gives : std::uint8_t { radius, angle };

  RadialLens(Gives gives, RisingFunction function);

  bool shows(const glm::dvec3& direction) const override;
  glm::dvec2 place(const glm::dvec3& direction) const override;
  std::optional<glm::dvec3> direction(const glm::dvec2& place) const override;
  double reach() const override;

 private:
  double radius(double angle_rad) const;
  std::optional<double> angle(double radius) const;

  Gives gives_;
  RisingFunction function_;
  double shown_rad_;  // the largest angle that the lens shows
};

}  // namespace simvis
