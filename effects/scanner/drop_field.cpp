#include "effects/scanner/drop_field.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// Drops end at the range from which on fewer than one drop in this many cubic metres is detected.
constexpr double kRarest_m3 = 1e6;

// Distinct numbers for the cubes of a frame: a bijection of 64 bits (the finaliser of SplitMix64) after each
// coordinate.
std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9u;
  value = (value ^ value >> 27) * 0x94d049bb133111ebu;
  return value ^ value >> 31;
}

struct CubeKey {
  std::uint64_t frame;
  std::uint32_t element;
};

CubeKey key_of(std::uint64_t frame, const glm::i64vec3& cell) {
  std::uint64_t key = mixed(frame + 0x9e3779b97f4a7c15u);
  for (int axis = 0; axis < 3; ++axis) key = mixed(key ^ static_cast<std::uint64_t>(cell[axis]) * 0x9e3779b97f4a7c15u);
  return {key, static_cast<std::uint32_t>(mixed(key) >> 32)};
}

std::int64_t cube_of(double place_m) { return static_cast<std::int64_t>(std::floor(place_m / DropField::kCell_m)); }

}  // namespace

void DropField::meet(const LitCylinder& beam, const std::function<double(double)>& smallest_m,
                     const std::function<void(double, double)>& met) const {
  const double rarest_m = medium_.particle_diameter_m * std::log(medium_.particles_per_m3 * kRarest_m3);
  // The range from which on drops are too rare; smallest_m() does not fall.
  double to_m = beam.to_m;
  if (!(smallest_m(to_m) <= rarest_m)) {
    double low = beam.from_m;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + to_m) / 2;
      (smallest_m(middle) <= rarest_m ? low : to_m) = middle;
    }
  }
  if (!(to_m > beam.from_m)) return;
  LitCylinder lit = beam;
  lit.to_m = to_m;
  // Slabs of cubes along the axis that the beam follows most; in each, the cubes around the beam.
  const glm::dvec3 along = glm::abs(beam.direction);
  const int k = along.x >= along.y && along.x >= along.z ? 0 : along.y >= along.z ? 1 : 2;
  const double step = beam.direction[k], radius_m = beam.diameter_at(to_m) / 2;
  const double first_m = beam.origin_m[k] + step * beam.from_m, last_m = beam.origin_m[k] + step * to_m;
  const std::int64_t first = cube_of(std::min(first_m, last_m) - radius_m);
  const std::int64_t last = cube_of(std::max(first_m, last_m) + radius_m);
  for (std::int64_t slab = first; slab <= last; ++slab) {
    const double low_m = static_cast<double>(slab) * kCell_m - radius_m, high_m = low_m + kCell_m + 2 * radius_m;
    const double enter = (low_m - beam.origin_m[k]) / step, leave = (high_m - beam.origin_m[k]) / step;
    const double from_m = std::max(beam.from_m, std::min(enter, leave)), end_m = std::min(to_m, std::max(enter, leave));
    if (from_m > end_m) continue;
    const glm::dvec3 a = beam.origin_m + from_m * beam.direction, b = beam.origin_m + end_m * beam.direction;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    glm::i64vec3 cell;
    cell[k] = slab;
    for (cell[i] = cube_of(std::min(a[i], b[i]) - radius_m); cell[i] <= cube_of(std::max(a[i], b[i]) + radius_m);
         ++cell[i]) {
      for (cell[j] = cube_of(std::min(a[j], b[j]) - radius_m); cell[j] <= cube_of(std::max(a[j], b[j]) + radius_m);
           ++cell[j]) {
        meet_cell(cell, lit, smallest_m, met);
      }
    }
  }
}

void DropField::meet_cell(const glm::i64vec3& cell, const LitCylinder& beam,
                          const std::function<double(double)>& smallest_m,
                          const std::function<void(double, double)>& met) const {
  const CubeKey key = key_of(frame_, cell);
  const glm::dvec3 corner_m = glm::dvec3(cell) * kCell_m;
  // The beam may first meet the cube here, so that the drops it detects are at least `least_m` large.
  const double middle_m = glm::dot(corner_m + kCell_m / 2 - beam.origin_m, beam.direction);
  const double nearest_m = std::max(beam.from_m, middle_m - kCell_m);  // half its diagonal is shorter
  const double least_m = smallest_m(nearest_m), drops = medium_.particles_per_m3 * kCell_m * kCell_m * kCell_m;
  std::uint32_t draws = 0;
  const auto uniform = [&] { return random_.uniform(key.frame, key.element, draws++); };
  for (double arrived = 0;;) {
    arrived -= std::log1p(-uniform());
    const double diameter_m = arrived > 0 ? medium_.particle_diameter_m * std::log(drops / arrived) : 0;
    if (!(diameter_m >= least_m) || diameter_m <= 0) return;
    const double x = uniform(), y = uniform(), z = uniform();
    const glm::dvec3 reach_m = corner_m + kCell_m * glm::dvec3(x, y, z) - beam.origin_m;
    const double range_m = glm::dot(reach_m, beam.direction);
    if (range_m < beam.from_m || range_m >= beam.to_m) continue;
    if (glm::length(reach_m - range_m * beam.direction) > beam.diameter_at(range_m) / 2) continue;
    if (diameter_m >= smallest_m(range_m)) met(range_m, diameter_m);
  }
}

}  // namespace simvis
