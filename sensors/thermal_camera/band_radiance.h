// The radiance of black bodies in the band of thermal cameras, 8 to 14 um.
//
// Model    Planck's law, integrated over the band. With x = h c / (lambda k T) the radiance of all wavelengths below
//          lambda is 2 k^4 T^4 / (h^3 c^2) sum_n e^(-n x) (x^3 / n + 3 x^2 / n^2 + 6 x / n^3 + 6 / n^4), and that of
//          the band is the difference of two such sums (Widger and Woodall, "Integration of the Planck blackbody
//          radiation function", Bulletin of the American Meteorological Society 57(10), 1976). Constants are those of
//          the SI since 2019.
// Inverse  a table of 1 / T over ln L, which is nearly straight, with cubic Hermite interpolation. Its error is at most
//          h^4 / 384 times the fourth derivative: below 1e-6 K up to 1000 K, below 1e-4 K up to 3000 K.
#pragma once

namespace simvis {

inline constexpr double kBandMin_m = 8e-6, kBandMax_m = 14e-6;

/// Radiance of a black body in the band, in W / (m^2 sr); 0 for 0 K. Relative error below 5e-13.
double band_radiance(double temperature_k);

/// Its derivative by the temperature, in W / (m^2 sr K).
double band_radiance_slope(double temperature_k);

/// The temperature of the black body with this radiance: from kColdest_k to kHottest_k, and 0 for what radiates less.
double band_temperature_k(double radiance);

inline constexpr double kColdest_k = 20, kHottest_k = 3500;
/// The step h of the table, in ln L.
inline constexpr double kRadianceStep = 1.0 / 16;

}  // namespace simvis
