// The World Magnetic Model for 2025.0 to 2030.0: the earth's main field by spherical harmonics to degree 12, with their
// change per year.
//
// Source   coefficients WMM2025 of the US National Centers for Environmental Information and the British Geological
//          Survey, released on 13 November 2024 and in the public domain; the sum is that of the model's technical
//          report: Schmidt semi-normalised functions, reference radius 6371.2 km.
// Limits   the field of the crust, of storms and of iron nearby is not in it: by the report, the true field differs by
//          some 150 nT and, in direction, by some tenths of a degree where it is not near a magnetic pole.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

inline constexpr double kMagneticModelFrom = 2025, kMagneticModelTo = 2030;  ///< years

/// The flux density in tesla at a place, both in the earth's frame of WGS 84: geocentric, z north, x through Greenwich.
glm::dvec3 world_magnetic_model_t(const glm::dvec3& place_m, double year);

}  // namespace simvis
