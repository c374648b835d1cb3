#include "sensors/event_camera/light_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

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
  CurveRefiner(const LightCurveDesc& desc, const LightSource& source, std::vector<LightKnot>& knots)
      : desc_(desc), source_(source), knots_(knots) {}

  /// Appends the knots behind `a` up to `b`.
  void refine(const LightKnot& a, const LightKnot& b) {
    if (is_short(a, b)) return knots_.push_back(b);
    const bool has_edges = source_.has_edges(a.time, b.time);
    if (!has_edges && is_equal(a, b)) return knots_.push_back(b);
    const LightKnot middle = at((a.time + b.time) / 2);
    if (is_equal(a, middle) && is_equal(middle, b)) {
      const auto is_still = [&](const LightKnot& knot) { return is_equal(a, knot); };
      const auto touch = has_edges ? unexpected(std::array{a.time, middle.time, b.time}, is_still) : std::nullopt;
      return touch ? refine_at(a, *touch, b) : knots_.push_back(b);
    }
    const Parabola parabola{a, middle, b};
    const auto is_on_parabola = [&](const LightKnot& knot) {
      return is_small(knot.light - parabola.at(knot.time), a, b);
    };
    const auto time_at = [&](double share) { return a.time + share * (b.time - a.time); };
    const double early = time_at(kOffCentre), late = time_at(1 - kOffCentre);
    if (!is_on_parabola(at(early)) || !is_on_parabola(at(late))) return refine_at(a, middle, b);
    const auto touch =
        has_edges ? unexpected(std::array{a.time, early, middle.time, late, b.time}, is_on_parabola) : std::nullopt;
    return touch ? refine_at(a, *touch, b) : divide(parabola, a, b);
  }

  LightKnot at(double time) const { return {time, source_.light(time)}; }

 private:
  void refine_at(const LightKnot& a, const LightKnot& between, const LightKnot& b) {
    refine(a, between);
    refine(between, b);
  }

  /// The light of the first touch between the times `looked_at` that is not as expected.
  template <class IsExpected>
  std::optional<LightKnot> unexpected(std::span<const double> looked_at, const IsExpected& is_expected) const {
    std::vector<double> times;
    source_.touches(looked_at, times);
    for (const double time : times) {
      const LightKnot knot = at(time);
      if (!is_expected(knot)) return knot;
    }
    return std::nullopt;
  }

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
  const LightSource& source_;
  std::vector<LightKnot>& knots_;
};

}  // namespace

void add_light_curve(const LightCurveDesc& desc, std::uint32_t intervals, const LightSource& source,
                     std::vector<LightKnot>& knots) {
  CurveRefiner refiner(desc, source, knots);
  LightKnot before = refiner.at(0);
  knots.push_back(before);
  for (std::uint32_t i = 1; i <= intervals; ++i) {
    const LightKnot now = refiner.at(static_cast<double>(i) / intervals);
    refiner.refine(before, now);
    before = now;
  }
}

}  // namespace simvis
