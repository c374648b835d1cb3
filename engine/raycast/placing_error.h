// By how much rounding displaces a point of a mesh that is placed in the frame of a sensor.
#pragma once

namespace simvis {

/// For a point `reach_m` away from the origin of its mesh, which is `distance_m` away from the sensor. The rounding of
/// a placed corner, in units of u = 2^-53: each component has an error of up to 7 u (|linear| |p|) + 4 u |offset|: the
/// product of two matrices (3), its product with a point and the sum (4), the difference of two positions and its
/// rotation (4). The shear adds 3 u (|x| + |z|). The direction, whose components are products of cosines, adds the same
/// amount again. The total is 16 u (reach + distance), times sqrt(3).
inline constexpr double kPlacingError = 0x1p-53 * 16 * 1.7320508;
constexpr double placing_error_m(double reach_m, double distance_m) { return kPlacingError * (reach_m + distance_m); }

/// World transforms are products of matrices with entries up to the offset from the world's origin. The number of
/// roundings is the one in VertexRounding. `place_m` and `sensor_m` are the distances of the mesh and of the sensor
/// from the world's origin.
inline constexpr double kWorldError = 0x1p-53 * 3 * 4 * 1.7320508;
constexpr double world_error_m(double place_m, double sensor_m) { return kWorldError * (place_m + sensor_m); }

}  // namespace simvis
