// A value that follows its target as dx/dt = (target - x) / time constant: the speed or the thrust of a motor.
#pragma once

#include <cmath>
#include <optional>

#include <simvis/state_archive.h>

namespace simvis {

class FirstOrderLag {
 public:
  /// Forgets the value: the next step begins at its target.
  void restart() { value_.reset(); }
  void archive(StateArchive& state) { state(value_); }

  /// The means of the value and of its square over a step.
  struct Means {
    double value = 0, square = 0;
  };
  /// Advances by a step of constant target, exactly. A time constant of 0 follows the target at once.
  Means advance(double target, double time_constant_s, double step_s) {
    const double away = value_.value_or(target) - target, steps = step_s / time_constant_s;
    if (away == 0 || !(time_constant_s > 0)) {
      value_ = target;
      return {target, target * target};
    }
    const double once = -std::expm1(-steps) / steps, twice = -std::expm1(-2 * steps) / (2 * steps);
    value_ = target + away * std::exp(-steps);
    return {target + away * once, target * target + 2 * target * away * once + away * away * twice};
  }

 private:
  std::optional<double> value_;  // empty: no step yet
};

}  // namespace simvis
