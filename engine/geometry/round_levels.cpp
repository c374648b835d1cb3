#include "engine/geometry/round_levels.h"

#include <algorithm>

#include "engine/draw/round_mesh.h"

namespace simvis {
namespace {

// A sphere of so many sides has 14,160 triangles.
constexpr int kMaxSidesOfSphere = 120;

// By level.
std::array<double, kRoundSides.size()> deviations_of(SurfaceKind kind) {
  std::array<double, kRoundSides.size()> deviations{};
  for (std::size_t i = 0; i < kRoundSides.size(); ++i) deviations[i] = deviation_at_radius_1(kind, kRoundSides[i]);
  return deviations;
}

bool has_circle(SurfaceKind kind) { return kind == SurfaceKind::cylinder || kind == SurfaceKind::cone; }

}  // namespace

std::size_t round_levels_of(const ExactSurface& shape) {
  if (has_circle(shape.kind)) return kRoundSides.size();
  return static_cast<std::size_t>(std::ranges::upper_bound(kRoundSides, kMaxSidesOfSphere) - kRoundSides.begin());
}

RoundLevel choose_round_level(const ExactSurface& shape, const ProjectedError& error, double limit_px) {
  static const auto of_circle = deviations_of(SurfaceKind::cylinder), of_sphere = deviations_of(SurfaceKind::sphere);
  const auto& at_radius_1 = has_circle(shape.kind) ? of_circle : of_sphere;
  const std::size_t finest = round_levels_of(shape) - 1;
  for (std::size_t number = 0;; ++number) {
    const double error_m = deviation_of_round_mesh(shape, at_radius_1[number]);
    const double error_px = error.px(error_m);
    if (error_px < limit_px || number == finest) return {number, error.world_m(error_m), error_px};
  }
}

}  // namespace simvis
