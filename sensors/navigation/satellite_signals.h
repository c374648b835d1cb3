// Which signals of satellites reach a receiver in a scene: direct ones, and those that a wall reflects once.
//
// Direct   A ray from the antenna to the satellite hits no surface.
// Reflected  At a flat surface with the normal n, the ray to a satellite in the direction s begins along
//          r = s - 2 (s n) n, by the law of reflection. It must hit a surface with this normal, at the distance d, and
//          from there nothing may stand in front of the satellite. Compared with the direct path, it is longer by
//          d (1 - r s) = 2 h (s n), where h is the distance of the plane: the path of the image of the antenna behind
//          the wall. The shortest one counts. The normals are those of the surfaces that kSurveyRays rays in even
//          directions hit: walls that fill less than about 6 degrees of the view may be missed. At 20 m, a smaller wall
//          is no mirror for radio: the radius of its first Fresnel zone is sqrt(0.19 m 20 m) = 1.9 m.
// Antenna  receives the half space above the xy plane of the sensor: nothing comes from below.
// Frames   S = sensor; E = east, north, up.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/ray_caster.h>
#include "sensors/navigation/satellites.h"

namespace simvis {

/// The signal of a satellite above the elevation mask.
struct SatelliteSignal {
  Satellite satellite;
  bool direct = false;                                             ///< its direct signal is received
  double extra_path_m = std::numeric_limits<double>::quiet_NaN();  ///< of the reflected signal; NaN: there is none

  bool reflected() const { return extra_path_m == extra_path_m; }
  bool received() const { return direct || reflected(); }
  /// The error that reflection adds to the pseudorange, as multipath_error_m(); without the direct signal the whole
  /// extra path. NaN: it is not received.
  double error_m(double reflection) const;
};

/// The error of a pseudorange by a reflected signal beside the direct one. A receiver aligns two correlators, early and
/// late by half the spacing b = 0.1 chips of 293 m, until they are equal (Braasch, "Multipath effects", in Parkinson
/// and Spilker, "GPS: Theory and Applications", 1996; b is that of the narrow correlator of van Dierendonck, Fenton and
/// Ford, Navigation 39, 1992). Reflection reverses the phase: the amplitude that is in phase is
/// a = -reflection cos(2 pi extra / wavelength), with the wavelength 0.19 m of L1. Then the error is
/// a extra / (1 + a), at most |a| b / 2, and it falls to 0 where the extra path reaches 1 + b / 2 chips.
double multipath_error_m(double reflection, double extra_path_m);

/// The signals of satellites that a sensor can receive at its pose.
class SatelliteSignals {
 public:
  SatelliteSignals(const SatellitesDesc& desc, const GeodeticOrigin& origin) : desc_(desc), origin_(origin) {}

  /// Adds the rays to the plan. `sensor` names it for people: "gnss receiver GPS".
  void plan(const std::string& name, const std::string& sensor, FramePlan& plan) const;
  /// In the order of the numbers of satellites.
  std::vector<SatelliteSignal> find(RayCaster& rays, const DrawList& list, const glm::dmat4& world_from_sensor,
                                    double time_s) const;

 private:
  void find_direct(RayCaster& rays, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> ways,
                   std::span<SatelliteSignal> signals) const;
  void find_reflected(RayCaster& rays, const DrawList& list, const glm::dmat4& world_from_sensor,
                      std::span<const glm::dvec3> ways, std::span<SatelliteSignal> signals) const;

  SatellitesDesc desc_;
  GeodeticOrigin origin_;
};

}  // namespace simvis
