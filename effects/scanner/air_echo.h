// The echo of the air itself: fog, haze or dust scatters light back at every range, and the receiver sees the sum as a
// pulse.
//
// Model    A surface at r returns a pulse of the shape p(x) = cos^2(pi x / (2 L)), |x| <= L, over the distance x from
// r,
//          where L is half the base and also the width at half the height. Air between r and r + dr returns
//          pi backscatter exp(-2 extinction r) o(r) / r^2 dr, in the unit of Echo::power; the overlap o of beam and
//          receiver rises from 0 at kAirFrom_m to 1 at kAirWhole_m. The receiver therefore sees
//              P(R) = pi backscatter integral p(r - R) exp(-2 extinction r) o(r) / r^2 dr
//          up to the range where the beam ends, and its echo is the maximum of P, at that R.
// Accuracy The integral is taken by Gauss and Legendre's rule with 16 points on each piece between the ends of the
// pulse,
//          of the overlap and of the beam, on which the integrand is analytic.
// Reference  R. H. Rasshofer, M. Spies, H. Spies, Influences of weather phenomena on automotive laser radar systems,
//          Adv. Radio Sci. 9, 2011; M. Hahner et al., Fog Simulation on Real LiDAR Point Clouds for 3D Object Detection
//          in Adverse Weather, ICCV 2021, for the overlap.
#pragma once

#include <simvis/draw_list.h>

namespace simvis {

/// The receiver sees nothing of the beam at ranges below the first, and all of it beyond the second.
inline constexpr double kAirFrom_m = 0.9, kAirWhole_m = 1;

/// Length of a pulse of 5 ns at half its height: c T / 2.
inline constexpr double kPulse_m = 0.75;

struct AirEcho {
  double range_m = 0, power = 0;  ///< power as Echo::power; 0: the beam ends before the receiver sees it
};

/// P(R) of a beam that ends at `end_m`.
double air_power(const Medium& medium, double end_m, double range_m);

/// The maximum of air_power() over R.
AirEcho air_echo(const Medium& medium, double end_m);

/// An echo of air does not depend on the end of a beam beyond this range.
inline constexpr double kAirEchoEnd_m = kAirWhole_m + 2 * kPulse_m;

}  // namespace simvis
