// The position fix of a receiver of satellite navigation from its pseudoranges, by least squares.
//
// A pseudorange is the distance to a satellite plus an unknown offset of the receiver's clock, plus an error e. Around
// the true place, n pseudoranges are g_i x = e_i with the rows g_i = (-d_i, 1), where d_i is the unit vector to the
// satellite, and x is the error of place and clock (Kaplan and Hegarty, "Understanding GPS", 2006, section 7.3). With
// the mean direction m, the clock drops out:
//
//   x = -Q sum (d_i - m) e_i,   Q = (sum (d_i - m) (d_i - m)^T)^-1
//
// Q is the covariance of the place for independent errors of variance 1, and its diagonal has the squares of the
// dilutions of precision. The equations are linear: for a satellite at the distance R, an error x of the place leaves
// x^2 / 2 R out, 0.2 mm for 100 m and R = 20,000 km.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace simvis {

struct Pseudorange {
  glm::dvec3 direction{0};  ///< to the satellite: E (east, north, up), unit length
  double error_m = 0;       ///< measured minus true
};

struct PositionFix {
  glm::dvec3 error_m{0};    ///< E: the fix minus the true place
  glm::dmat3 cofactors{0};  ///< E: the covariance of the place for pseudoranges of variance 1

  double hdop() const { return std::sqrt(cofactors[0][0] + cofactors[1][1]); }  ///< of east and north
  double vdop() const { return std::sqrt(cofactors[2][2]); }                    ///< of up
  double pdop() const { return std::hypot(hdop(), vdop()); }                    ///< of all three
};

/// The largest dilution of a fix. An eigenvalue of the sum rounds by about n 2^-53, so directions that lie on a cone or
/// in a plane, which give no place, have dilutions of 10^7 and more. Only two different directions give no place
/// either, but two eigenvalues that are both rounding: their dilution can be any.
inline constexpr double kMaxPdop = 1e3;

/// Empty: there are fewer than four, the dilution of their place is above kMaxPdop, or the determinant of the sum is no
/// more than its rounding.
std::optional<PositionFix> fix_position(std::span<const Pseudorange> pseudoranges);

}  // namespace simvis
