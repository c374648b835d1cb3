#include "engine/light/surface_shares.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// The reflectance of two faces that each reflect `face`, including all reflections between them.
double both_faces(double face) { return 2 * face / (1 + face); }

}  // namespace

double pane_reflectance(double refractive_index, double cosine) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / refractive_index;
  if (sine >= 1) return 1;
  const double inside = std::sqrt(1 - sine * sine);
  const double across = (cosine - refractive_index * inside) / (cosine + refractive_index * inside);
  const double along = (refractive_index * cosine - inside) / (refractive_index * cosine + inside);
  return (both_faces(across * across) + both_faces(along * along)) / 2;
}

SurfaceShares surface_shares(const Material& material, double reflectance, double cosine) {
  const double mirror = material.mirror, glass = (1 - mirror) * material.transmission;
  const double pane = glass > 0 ? pane_reflectance(material.refractive_index, cosine) : 0;
  return {.matte = (1 - mirror) * (1 - static_cast<double>(material.transmission)),
          .reflected = mirror + glass * pane,
          .passed = glass * (1 - pane) * reflectance};
}

}  // namespace simvis
