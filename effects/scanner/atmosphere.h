// The effect `atmosphere`: what fog, rain and dust (DrawList::medium) do to the echoes of a laser scanner.
//
// Weaker   light is lost on the way out and back: power x exp(-2 extinction range), Beer and Lambert.
// Lost     an echo below the least power that the scanner detects.
// False    (a) Of the air as a whole, which sends light back everywhere. In the unit of Echo::power a pulse of the
//          length l returns pi l backscatter exp(-2 extinction r) / r^2; that falls with r, and nearer than kAirFrom_m
//          the receiver does not see the beam, so the air's echo stands there (as in Rasshofer, Spies and Spies,
//          "Influences of weather phenomena on automotive laser radar systems", Adv. Radio Sci. 9, 2011).
//          (b) Of single drops. A drop of diameter D in a beam of diameter w returns
//          kDropReflectance (D / w)^2 exp(-2 extinction r) / r^2, and nothing if it is wider than the beam's share of
//          it; so it is detected if D is at least D_min(r), where that is as much as the least power. Drops lie in the
//          beam as a Poisson process, of rate N pi w^2 / 4 per metre, and their diameters are distributed exponentially
//          with mean D0; so those that are detected are a Poisson process, too, of rate
//          N pi w^2 / 4 exp(-D_min(r) / D0), and their diameters are D_min + D0 times a unit exponential.
// Where    along the beam's path up to the farthest surface that returned something; to range_max where none did.
//
// A false echo competes with those of surfaces as they do with each other: by default the strongest is reported.
#pragma once

#include <simvis/draw_list.h>

namespace simvis {

/// Nearer than this the receiver does not see the beam, and no echo of the air.
inline constexpr double kAirFrom_m = 1;

/// The way that light goes there and back during a pulse of 5 ns.
inline constexpr double kPulse_m = 0.75;

/// The reflectance of a matte disc that sends as much back as a drop of water of its diameter. In geometric optics the
/// front reflects R, the back R (1 - R)^2 (n / (2 - n))^2 of what a mirroring sphere does (paraxial rays; R of normal
/// incidence, n = 1.33), and a matte disc of reflectance p sends back 4 p times what a mirroring sphere does.
inline constexpr double kDropReflectance = 0.0240;

/// How a scanner sees drops.
struct DropSight {
  double least_power = 0;      ///< as Echo::power, 1/m^2
  double beam_diameter_m = 0;  ///< w

  /// +infinity where no drop that fits into the beam is detected.
  double min_diameter_m(const Medium& medium, double range_m) const;

  /// Detected drops per metre of beam.
  double rate_per_m(const Medium& medium, double range_m) const;
};

}  // namespace simvis
