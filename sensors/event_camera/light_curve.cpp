#include "sensors/event_camera/light_curve.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

/// The parabola through the ends and the middle of an interval.
struct Parabola {
  LightKnot a, middle, b;

  double at(double time) const {
    const double u = (time - a.time) / (b.time - a.time);
    return a.light + u * (b.light - a.light) + 2 * u * (1 - u) * (2 * middle.light - a.light - b.light);
  }
};

class CurveRefiner {
 public:
  CurveRefiner(const LightCurveDesc& desc, const std::function<double(double)>& light, std::vector<LightKnot>& knots)
      : desc_(desc), light_(light), knots_(knots) {}

  /// Appends the knots behind `a` up to `b`.
  void refine(const LightKnot& a, const LightKnot& b) {
    if (is_short(a, b)) return knots_.push_back(b);
    const LightKnot middle = at((a.time + b.time) / 2);
    if (is_equal(a, middle) && is_equal(middle, b)) return knots_.push_back(b);
    const Parabola parabola{a, middle, b};
    const auto is_on_parabola = [&](double share) {
      const LightKnot knot = at(a.time + share * (b.time - a.time));
      return is_small(knot.light - parabola.at(knot.time), a, b);
    };
    if (is_on_parabola(kOffCentre) && is_on_parabola(1 - kOffCentre)) return divide(parabola, a, b);
    refine(a, middle);
    refine(middle, b);
  }

  LightKnot at(double time) const { return {time, light_(time)}; }

 private:
  /// Appends knots of the parabola between which its chords are close enough.
  void divide(const Parabola& parabola, const LightKnot& a, const LightKnot& b) {
    const double time = (a.time + b.time) / 2;
    const LightKnot middle{time, parabola.at(time)};
    if (is_short(a, b) || is_small(middle.light - (a.light + b.light) / 2, a, b)) return knots_.push_back(b);
    divide(parabola, a, middle);
    divide(parabola, middle, b);
  }

  double length_s(const LightKnot& a, const LightKnot& b) const { return (b.time - a.time) * desc_.duration_s; }
  bool is_short(const LightKnot& a, const LightKnot& b) const { return length_s(a, b) <= desc_.time_error_s; }

  bool is_equal(const LightKnot& a, const LightKnot& b) const {
    return std::abs(a.light - b.light) <= kLightError / 2 * (std::min(a.light, b.light) + desc_.darkness);
  }

  /// Whether an error of the light displaces crossings by at most half of what is allowed, for each of two errors.
  bool is_small(double error, const LightKnot& a, const LightKnot& b) const {
    return std::abs(error) <= kLightError * (std::min(a.light, b.light) + desc_.darkness) ||
           std::abs(error) * length_s(a, b) <= desc_.time_error_s / 2 * std::abs(b.light - a.light);
  }

  const LightCurveDesc& desc_;
  const std::function<double(double)>& light_;
  std::vector<LightKnot>& knots_;
};

}  // namespace

void add_light_curve(const LightCurveDesc& desc, std::uint32_t intervals, const std::function<double(double)>& light,
                     std::vector<LightKnot>& knots) {
  CurveRefiner refiner(desc, light, knots);
  LightKnot before = refiner.at(0);
  knots.push_back(before);
  for (std::uint32_t i = 1; i <= intervals; ++i) {
    const LightKnot now = refiner.at(static_cast<double>(i) / intervals);
    refiner.refine(before, now);
    before = now;
  }
}

}  // namespace simvis
