#include "effects/scanner/particle_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace simvis {
namespace {

// Classes with fewer than one particle in this many cubic metres are left out.
constexpr double kRarest_m3 = 1e6;
// No particle is detected farther away.
constexpr double kFarthest_m = 1e5;
// Classes whose cubes would be smaller are left out: no air has so many particles.
constexpr double kSmallestCube_m = 1e-5;
// Which a cube has more of once in 1e13 cubes; its sum may stay below 1 by rounding.
constexpr std::uint32_t kMaxInCube = 12;
// The share of a class in the particles that are at least as large as its smallest ones.
constexpr double kOfClass = 1 - 1 / std::numbers::e;

// Distinct numbers for the cubes of a frame: a bijection of 64 bits (the finaliser of SplitMix64) after each number.
std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9u;
  value = (value ^ value >> 27) * 0x94d049bb133111ebu;
  return value ^ value >> 31;
}
std::uint64_t mixed(std::uint64_t key, std::uint64_t number) { return mixed(key ^ number * 0x9e3779b97f4a7c15u); }
std::uint64_t mixed(std::uint64_t key, std::int64_t number) { return mixed(key, static_cast<std::uint64_t>(number)); }

// From 0 to below 1.
double uniform(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }
double uniform(std::uint32_t bits) { return bits * 0x1p-32; }

// The largest range at which smallest_m() is at most this; 0 if it is larger at `from_m`.
double reach_of(const std::function<double(double)>& smallest_m, double from_m, double diameter_m) {
  if (!(smallest_m(from_m) <= diameter_m)) return 0;
  double low = from_m, high = 2 * from_m;
  while (high < kFarthest_m && smallest_m(high) <= diameter_m) low = std::exchange(high, 2 * high);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (smallest_m(middle) <= diameter_m ? low : high) = middle;
  }
  return high;
}

}  // namespace

/// A beam that meets the particles of a class in a frame.
struct ParticleField::Visit {
  std::uint64_t key;  // of the frame and the class
  LitCylinder beam;
  const std::function<void(double, double)>& met;
};

ParticleField::ParticleField(std::uint64_t seed_of_air, const Medium& medium, double from_m,
                             std::function<double(double)> smallest_m)
    : seed_(mixed(seed_of_air, std::uint64_t{1})),
      mean_diameter_m_(medium.particle_diameter_m),
      smallest_m_(std::move(smallest_m)) {
  if (medium.particles_per_m3 == 0) return;
  const double smallest = smallest_m_(from_m) / mean_diameter_m_;
  const double rarest = std::log(medium.particles_per_m3 * kRarest_m3);
  if (!(smallest < rarest)) return;
  for (auto number = static_cast<std::uint32_t>(smallest); number < rarest; ++number) {
    const double per_m3 = medium.particles_per_m3 * std::exp(-static_cast<double>(number)) * kOfClass;
    const double cube_m = std::cbrt(kInCube / per_m3);
    if (!(cube_m > kSmallestCube_m)) continue;
    classes_.push_back({.number = number,
                        .cube_m = cube_m,
                        .reach_m = reach_of(smallest_m_, from_m, (number + 1.0) * mean_diameter_m_)});
  }
}

void ParticleField::meet(std::uint64_t frame, const LitCylinder& beam,
                         const std::function<void(double, double)>& met) const {
  const std::uint64_t key = mixed(seed_, frame);
  for (const Class& size : classes_) {
    Visit visit{mixed(key, std::uint64_t{size.number}), beam, met};
    visit.beam.to_m = std::min(beam.to_m, size.reach_m);
    if (visit.beam.from_m < visit.beam.to_m) meet_class(size, visit);
  }
}

// Slabs of cubes along the axis that the beam follows most; in each, the cubes around the beam.
void ParticleField::meet_class(const Class& size, Visit& visit) const {
  const LitCylinder& beam = visit.beam;
  const auto cube_of = [&](double place_m) { return static_cast<std::int64_t>(std::floor(place_m / size.cube_m)); };
  const glm::dvec3 along = glm::abs(beam.direction);
  const int k = along.x >= along.y && along.x >= along.z ? 0 : along.y >= along.z ? 1 : 2;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double step = beam.direction[k], radius_m = beam.diameter_at(beam.to_m) / 2;
  const double first_m = beam.origin_m[k] + step * beam.from_m, last_m = beam.origin_m[k] + step * beam.to_m;
  const std::int64_t first = cube_of(std::min(first_m, last_m) - radius_m);
  const std::int64_t last = cube_of(std::max(first_m, last_m) + radius_m);
  for (std::int64_t slab = first; slab <= last; ++slab) {
    const double low_m = static_cast<double>(slab) * size.cube_m - radius_m;
    const double high_m = low_m + size.cube_m + 2 * radius_m;
    const double enter = (low_m - beam.origin_m[k]) / step, leave = (high_m - beam.origin_m[k]) / step;
    const double from_m = std::max(beam.from_m, std::min(enter, leave));
    const double end_m = std::min(beam.to_m, std::max(enter, leave));
    if (from_m > end_m) continue;
    const double wide_m = beam.diameter_at(end_m) / 2;  // in this slab
    const glm::dvec3 a = beam.origin_m + from_m * beam.direction, b = beam.origin_m + end_m * beam.direction;
    const glm::dvec3 low = glm::min(a, b) - wide_m, high = glm::max(a, b) + wide_m;
    glm::i64vec3 cube;
    cube[k] = slab;
    for (cube[i] = cube_of(low[i]); cube[i] <= cube_of(high[i]); ++cube[i]) {
      for (cube[j] = cube_of(low[j]); cube[j] <= cube_of(high[j]); ++cube[j]) meet_cube(size, cube, visit);
    }
  }
}

void ParticleField::meet_cube(const Class& size, const glm::i64vec3& cube, const Visit& visit) const {
  static const double kEmpty = std::exp(-kInCube);
  const std::uint64_t key = mixed(mixed(mixed(visit.key, cube.x), cube.y), cube.z);
  // Poisson's distribution by its inverse: most cubes are empty.
  double left = uniform(mixed(key)), share = kEmpty;
  std::uint32_t count = 0;
  for (; left >= share && count < kMaxInCube; ++count) {
    left -= share;
    share *= kInCube / (count + 1);
  }
  const LitCylinder& beam = visit.beam;
  for (std::uint32_t number = 0; number < count; ++number) {
    const auto bits = philox4x32_10({static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32), number, 0},
                                    {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)});
    const glm::dvec3 place(uniform(bits[0]), uniform(bits[1]), uniform(bits[2]));
    const glm::dvec3 reach_m = size.cube_m * (glm::dvec3(cube) + place) - beam.origin_m;
    const double range_m = glm::dot(reach_m, beam.direction);
    if (range_m < beam.from_m || range_m >= beam.to_m) continue;
    if (glm::length(reach_m - range_m * beam.direction) > beam.diameter_at(range_m) / 2) continue;
    // The exponential distribution, cut off at the class's ends.
    const double diameter_m = mean_diameter_m_ * (size.number - std::log1p(-kOfClass * uniform(bits[3])));
    if (diameter_m >= smallest_m_(range_m)) visit.met(range_m, diameter_m);
  }
}

}  // namespace simvis
