// The effect `atmosphere`: fog, rain and dust (DrawList::medium) weaken, remove and add echoes of a laser scanner.
//
// Weaker   light is lost on the way out and back: power x exp(-2 extinction range), the Beer-Lambert law.
// Lost     an echo below the smallest power that the scanner detects is removed.
// False    (a) The air as a whole scatters light back at every range: its echo is the maximum of the integral over the
//          pulse, see effects/scanner/air_echo.h.
//          (b) Single drops return echoes, each from its own place in the world, see effects/scanner/drop_field.h. A
//          drop of diameter D in a beam of diameter w(r) returns
//          kDropReflectance min(D / w, 1)^2 exp(-2 extinction r) / r^2. It is detected if D is at least D_min(r), the
//          diameter whose echo has the smallest detected power; no drop is detected where D_min(r) would be larger than
//          w. The beam has the diameter `beam_diameter` where it leaves, and grows by its `divergence`. Its axis is the
//          mean direction of its rays.
// Where    false echoes lie along the beam up to the farthest surface that returned an echo, or up to range_max if no
//          surface returned one.
//
// A false echo competes with the echoes of surfaces as those compete with each other: by default the strongest echo is
// reported.
#pragma once

#include <simvis/draw_list.h>
#include "effects/scanner/air_echo.h"

namespace simvis {

/// Drops are met from here on, where the receiver sees the whole beam.
inline constexpr double kDropsFrom_m = kAirWhole_m;

/// The reflectance of a matte disc that returns as much light as a water drop of the same diameter. In geometric optics
/// the front of the drop reflects R and the back R (1 - R)^2 (n / (2 - n))^2 of what a mirroring sphere reflects
/// (paraxial rays; R at normal incidence, n = 1.33). A matte disc of reflectance p returns 4 p times the light of a
/// mirroring sphere.
inline constexpr double kDropReflectance = 0.0240;

/// The scanner's sensitivity to drops.
struct DropSight {
  double least_power = 0;      ///< smallest detected power, 1/m^2 as in Echo::power
  double beam_diameter_m = 0;  ///< diameter of the beam where it leaves
  double spread = 0;           ///< by which the diameter grows with the range

  double diameter_m(double range_m) const { return beam_diameter_m + spread * range_m; }

  /// The smallest diameter of a drop that is detected at this range; +infinity if no drop that fits into the beam is
  /// detected.
  double min_diameter_m(const Medium& medium, double range_m) const;
};

}  // namespace simvis
