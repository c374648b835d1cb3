#include "effects/camera/lenses/radial_lens.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace simvis {
namespace {

constexpr int kMaxNewtonSteps = 200;

}  // namespace

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

double end_of(const std::function<bool(double)>& holds, double limit, int steps) {
  for (int i = 1; i <= steps; ++i) {
    double after = limit * i / steps;
    if (holds(after)) continue;
    double before = limit * (i - 1) / steps;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = (before + after) / 2;
      (holds(middle) ? before : after) = middle;
    }
    return before;
  }
  return limit;
}

RisingFunction::RisingFunction(Formula value, Formula slope, double limit)
    : value_(std::move(value)),
      slope_(std::move(slope)),
      fold_(end_of([this](double x) { return slope_(x) > 0; }, limit, 4096)) {}

// Newton's method within a bracket of two arguments. It ends where no double in the bracket is nearer, so that its
// error is the rounding of the formula.
std::optional<double> RisingFunction::inverse(double target) const {
  double low = 0, high = fold_, x = std::min(target, fold_ / 2);
  if (target > value_(high)) return {};
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const double off = value_(x) - target;
    (off > 0 ? high : low) = x;
    const double next = x - off / slope_(x);
    const double inside = next > low && next < high ? next : (low + high) / 2;
    if (off == 0 || inside == x) break;
    x = inside;
  }
  return x;
}

RadialLens::RadialLens(Gives gives, RisingFunction function)
    : gives_(gives),
      function_(std::move(function)),
      shown_rad_(gives == Gives::radius ? function_.fold() : std::min(function_(function_.fold()), kFisheyeLimit_rad)) {
}

double RadialLens::radius(double angle_rad) const {
  return gives_ == Gives::radius ? function_(angle_rad) : function_.inverse(angle_rad).value_or(function_.fold());
}

std::optional<double> RadialLens::angle(double radius) const {
  if (gives_ == Gives::radius) return function_.inverse(radius);
  return radius <= function_.fold() ? std::optional(function_(radius)) : std::nullopt;
}

double RadialLens::reach() const { return gives_ == Gives::radius ? function_(function_.fold()) : function_.fold(); }

bool RadialLens::shows(const glm::dvec3& direction) const {
  return std::atan2(std::hypot(direction.x, direction.y), direction.z) < shown_rad_;
}

glm::dvec2 RadialLens::place(const glm::dvec3& direction) const {
  const double across = std::hypot(direction.x, direction.y);
  if (across == 0) return {0, 0};
  return radius(std::atan2(across, direction.z)) / across * glm::dvec2(direction);
}

std::optional<glm::dvec3> RadialLens::direction(const glm::dvec2& place) const {
  const double across = glm::length(place);
  if (across == 0) return glm::dvec3(0, 0, 1);
  const std::optional<double> angle_rad = angle(across);
  if (angle_rad && *angle_rad <= kFisheyeLimit_rad) {
    return glm::dvec3(place / across * std::sin(*angle_rad), std::cos(*angle_rad));
  }
  if (!angle_rad && shown_rad_ < kFisheyeLimit_rad) return {};
  return glm::dvec3(0);
}

}  // namespace simvis
