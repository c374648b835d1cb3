#include "sensors/navigation/world_magnetic_model.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace simvis {
namespace {

constexpr int kDegree = 12;
constexpr double kReferenceRadius_m = 6371.2e3;

struct Coefficients {
  double g_nt, h_nt, g_nt_per_year, h_nt_per_year;
};
// By degree n from 1, and order m from 0 to n.
constexpr Coefficients kWmm2025[] = {{-29351.8, 0, 12, 0},
                                     {-1410.8, 4545.4, 9.7, -21.5},
                                     {-2556.6, 0, -11.6, 0},
                                     {2951.1, -3133.6, -5.2, -27.7},
                                     {1649.3, -815.1, -8, -12.1},
                                     {1361, 0, -1.3, 0},
                                     {-2404.1, -56.6, -4.2, 4},
                                     {1243.8, 237.5, 0.4, -0.3},
                                     {453.6, -549.5, -15.6, -4.1},
                                     {895, 0, -1.6, 0},
                                     {799.5, 278.6, -2.4, -1.1},
                                     {55.7, -133.9, -6, 4.1},
                                     {-281.1, 212, 5.6, 1.6},
                                     {12.1, -375.6, -7, -4.4},
                                     {-233.2, 0, 0.6, 0},
                                     {368.9, 45.4, 1.4, -0.5},
                                     {187.2, 220.2, 0, 2.2},
                                     {-138.7, -122.9, 0.6, 0.4},
                                     {-142, 43, 2.2, 1.7},
                                     {20.9, 106.1, 0.9, 1.9},
                                     {64.4, 0, -0.2, 0},
                                     {63.8, -18.4, -0.4, 0.3},
                                     {76.9, 16.8, 0.9, -1.6},
                                     {-115.7, 48.8, 1.2, -0.4},
                                     {-40.9, -59.8, -0.9, 0.9},
                                     {14.9, 10.9, 0.3, 0.7},
                                     {-60.7, 72.7, 0.9, 0.9},
                                     {79.5, 0, -0, 0},
                                     {-77, -48.9, -0.1, 0.6},
                                     {-8.8, -14.4, -0.1, 0.5},
                                     {59.3, -1, 0.5, -0.8},
                                     {15.8, 23.4, -0.1, 0},
                                     {2.5, -7.4, -0.8, -1},
                                     {-11.1, -25.1, -0.8, 0.6},
                                     {14.2, -2.3, 0.8, -0.2},
                                     {23.2, 0, -0.1, 0},
                                     {10.8, 7.1, 0.2, -0.2},
                                     {-17.5, -12.6, 0, 0.5},
                                     {2, 11.4, 0.5, -0.4},
                                     {-21.7, -9.7, -0.1, 0.4},
                                     {16.9, 12.7, 0.3, -0.5},
                                     {15, 0.7, 0.2, -0.6},
                                     {-16.8, -5.2, -0, 0.3},
                                     {0.9, 3.9, 0.2, 0.2},
                                     {4.6, 0, -0, 0},
                                     {7.8, -24.8, -0.1, -0.3},
                                     {3, 12.2, 0.1, 0.3},
                                     {-0.2, 8.3, 0.3, -0.3},
                                     {-2.5, -3.3, -0.3, 0.3},
                                     {-13.1, -5.2, 0, 0.2},
                                     {2.4, 7.2, 0.3, -0.1},
                                     {8.6, -0.6, -0.1, -0.2},
                                     {-8.7, 0.8, 0.1, 0.4},
                                     {-12.9, 10, -0.1, 0.1},
                                     {-1.3, 0, 0.1, 0},
                                     {-6.4, 3.3, 0, 0},
                                     {0.2, 0, 0.1, -0},
                                     {2, 2.4, 0.1, -0.2},
                                     {-1, 5.3, -0, 0.1},
                                     {-0.6, -9.1, -0.3, -0.1},
                                     {-0.9, 0.4, 0, 0.1},
                                     {1.5, -4.2, -0.1, 0},
                                     {0.9, -3.8, -0.1, -0.1},
                                     {-2.7, 0.9, -0, 0.2},
                                     {-3.9, -9.1, -0, -0},
                                     {2.9, 0, 0, 0},
                                     {-1.5, 0, -0, -0},
                                     {-2.5, 2.9, 0, 0.1},
                                     {2.4, -0.6, 0, -0},
                                     {-0.6, 0.2, 0, 0.1},
                                     {-0.1, 0.5, -0.1, -0},
                                     {-0.6, -0.3, 0, -0},
                                     {-0.1, -1.2, -0, 0.1},
                                     {1.1, -1.7, -0.1, -0},
                                     {-1, -2.9, -0.1, 0},
                                     {-0.2, -1.8, -0.1, 0},
                                     {2.6, -2.3, -0.1, 0},
                                     {-2, 0, 0, 0},
                                     {-0.2, -1.3, 0, -0},
                                     {0.3, 0.7, -0, 0},
                                     {1.2, 1, -0, -0.1},
                                     {-1.3, -1.4, -0, 0.1},
                                     {0.6, -0, -0, -0},
                                     {0.6, 0.6, 0.1, -0},
                                     {0.5, -0.1, -0, -0},
                                     {-0.1, 0.8, 0, 0},
                                     {-0.4, 0.1, 0, -0},
                                     {-0.2, -1, -0.1, -0},
                                     {-1.3, 0.1, -0, 0},
                                     {-0.7, 0.2, -0.1, -0.1}};
static_assert(std::size(kWmm2025) == kDegree * (kDegree + 3) / 2);

// Schmidt semi-normalised Legendre functions of the colatitude, and their derivatives by it.
struct Legendre {
  double value[kDegree + 1][kDegree + 1] = {}, slope[kDegree + 1][kDegree + 1] = {};

  Legendre(double cosine, double sine) {
    value[0][0] = 1;
    for (int n = 1; n <= kDegree; ++n) {
      for (int m = 0; m < n; ++m) {
        const double norm = std::sqrt(n * n - m * m), twice = 2 * n - 1;
        const double before = n > 1 ? std::sqrt(std::max((n - 1) * (n - 1) - m * m, 0)) : 0;
        const int back = std::max(n - 2, 0);
        value[n][m] = (twice * cosine * value[n - 1][m] - before * value[back][m]) / norm;
        slope[n][m] = (twice * (cosine * slope[n - 1][m] - sine * value[n - 1][m]) - before * slope[back][m]) / norm;
      }
      const double factor = n == 1 ? 1 : std::sqrt((2.0 * n - 1) / (2.0 * n));
      value[n][n] = factor * sine * value[n - 1][n - 1];
      slope[n][n] = factor * (sine * slope[n - 1][n - 1] + cosine * value[n - 1][n - 1]);
    }
  }
};

}  // namespace

glm::dvec3 world_magnetic_model_t(const glm::dvec3& place_m, double year) {
  // At a pole the meridian is any one; the field along it is that of a place a micrometre away.
  const double radius_m = glm::length(place_m), level_m = std::max(std::hypot(place_m.x, place_m.y), 1e-6);
  const double longitude = std::atan2(place_m.y, place_m.x), cosine = place_m.z / radius_m, sine = level_m / radius_m;
  const Legendre legendre(cosine, sine);
  double up = 0, south = 0, east = 0, share = kReferenceRadius_m / radius_m;
  share *= share;
  const Coefficients* row = kWmm2025;
  for (int n = 1; n <= kDegree; ++n) {
    share *= kReferenceRadius_m / radius_m;
    for (int m = 0; m <= n; ++m, ++row) {
      const double g = row->g_nt + (year - kMagneticModelFrom) * row->g_nt_per_year,
                   h = row->h_nt + (year - kMagneticModelFrom) * row->h_nt_per_year;
      const double along = g * std::cos(m * longitude) + h * std::sin(m * longitude),
                   across = g * std::sin(m * longitude) - h * std::cos(m * longitude);
      up += share * (n + 1) * along * legendre.value[n][m];
      south -= share * along * legendre.slope[n][m];
      east += share * m * across * legendre.value[n][m] / sine;
    }
  }
  const double c = std::cos(longitude), s = std::sin(longitude);
  const glm::dvec3 field_nt = up * glm::dvec3(sine * c, sine * s, cosine) +
                              south * glm::dvec3(cosine * c, cosine * s, -sine) + east * glm::dvec3(-s, c, 0);
  return 1e-9 * field_nt;
}

}  // namespace simvis
