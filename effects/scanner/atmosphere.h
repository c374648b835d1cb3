// The effect `atmosphere`: fog, rain, snow and dust (DrawList::medium) weaken, remove and add echoes of a laser
// scanner.
//
// Weaker   light is lost on the way out and back: power x exp(-2 extinction range), the Beer-Lambert law.
// Lost     an echo below the smallest power that the scanner detects is removed.
// False    (a) The air as a whole scatters light back at every range: its echo is the maximum of the integral over the
//          pulse, see effects/scanner/air_echo.h.
//          (b) Single particles return echoes, each from its own place in the world, see
//          effects/scanner/particle_field.h. A particle of diameter D in a beam of diameter w(r) returns
//          p min(D / w, 1)^2 exp(-2 extinction r) / r^2, with the reflectance p of particle_reflectance(). It is
//          detected if D is at least D_min(r), the diameter whose echo has the smallest detected power; no particle is
//          detected where D_min(r) would be larger than w. The beam has the diameter `beam_diameter` where it leaves,
//          and grows by its `divergence`. Its axis is the mean direction of its rays.
// Either   A particle counts for (b) from the diameter single_from_m() on, and for (a) below it. As diameters are
//          distributed exponentially, the small ones have the share soft_share() of the backscatter.
// Where    false echoes lie along the beam up to the farthest surface that returned an echo, or up to range_max if no
//          surface returned one.
//
// A false echo competes with the echoes of surfaces as those compete with each other: by default the strongest echo is
// reported.
#pragma once

#include <simvis/draw_list.h>
#include "effects/scanner/air_echo.h"

namespace simvis {

/// Particles are met from here on, where the receiver sees the whole beam.
inline constexpr double kParticlesFrom_m = kAirWhole_m;

/// The largest mean number of particles with echoes of their own in a pulse, where they are met first. More echoes
/// would overlap anyway.
inline constexpr double kManyInPulse = 16;

/// The reflectance of a matte disc that returns as much light as a particle of the same diameter. The particles of the
/// medium, of which the mean square of the diameter is 2 D0^2, return its whole backscatter N pi D0^2 / 2 p / pi. 0
/// without particles.
double particle_reflectance(const Medium& medium);

/// The scanner's sensitivity to particles.
struct ParticleSight {
  double least_power = 0;      ///< smallest detected power, 1/m^2 as in Echo::power
  double beam_diameter_m = 0;  ///< diameter of the beam where it leaves
  double spread = 0;           ///< by which the diameter grows with the range

  double diameter_m(double range_m) const { return beam_diameter_m + spread * range_m; }

  /// The smallest diameter of a particle that is detected at this range; +infinity if no particle that fits into the
  /// beam is detected. It does not fall with the range.
  double min_diameter_m(const Medium& medium, double range_m) const;
  /// The smallest diameter of particles with echoes of their own: they are detected where they are met first, and on
  /// average at most kManyInPulse of them lie in a pulse there. +infinity if there are none.
  double single_from_m(const Medium& medium) const;
};

/// The share of the backscatter that comes from particles smaller than this; 1 without particles.
double soft_share(const Medium& medium, double diameter_m);

}  // namespace simvis
