// Brownian motion between two known values: whether and when it first comes to a level.
//
// The motion from `from` to `to` in the time T, of the variance s^2 in each second, has come to a level with the
// probability exp(-2 a b / (s^2 T)), if both ends are below it by a and b (Karatzas, Shreve, "Brownian Motion and
// Stochastic Calculus", 2.8). By the change of time t = T u / (1 + u) it is, as far as levels are concerned, a motion
// with the drift |b| and the variance s^2 T, whose first times u follow the inverse Gaussian distribution of the mean
// a / |b| and the shape a^2 / (s^2 T). Samples of that are by Michael, Schucany, Haas, The American Statistician 30(2),
// 1976. Any drift is in the ends.
#pragma once

namespace simvis {

/// The ends of a motion as its distances below a level, and its variance over the whole time.
struct BrownianBridge {
  double begin = 0;     ///< above 0
  double end = 0;       ///< at most 0: it ends beyond the level
  double variance = 0;  ///< at least 0
};

/// The probability that it comes to the level.
double chance_of(const BrownianBridge& bridge);

/// The share of its time after which a bridge that comes to the level is there first, from a normal number and a
/// uniform one in [0, 1).
double first_time(const BrownianBridge& bridge, double normal, double uniform);

}  // namespace simvis
