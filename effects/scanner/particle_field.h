// The particles in the air that return echoes of their own, each at its own place in the world: drops of rain, flakes
// of snow, grains of dust.
//
// Model    Particles are a Poisson process in space with N per cubic metre, whose diameters have an exponential
//          distribution with mean D0. Class k has those from k D0 to (k + 1) D0, which are N exp(-k) (1 - 1 / e) per
//          cubic metre. Each class has a grid of cubes of its own, with a mean of kInCube particles in a cube.
// Cost     A beam visits the cubes of a class only as far as the scanner detects its largest particles, so that small
//          ones cost nothing where they are not detected, and rare ones little.
// Seeds    A cube's numbers depend on the seed of the run, the frame, the class and the cube, so that a scanner's
//          sensitivity does not move any particle. All scanners of a scene meet the same particles. Each frame has
//          others, because they move by many cubes between two frames.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/philox.h>

namespace simvis {

/// A beam of light, in the frame of the world. Its diameter is diameter_m + spread r at the range r.
struct LitCylinder {
  glm::dvec3 origin_m{0}, direction{1, 0, 0};  ///< unit length
  double from_m = 0, to_m = 0;                 ///< ranges along the axis
  double diameter_m = 0, spread = 0;

  double diameter_at(double range_m) const { return diameter_m + spread * range_m; }
};

class ParticleField {
 public:
  /// The mean number of particles in a cube. Fewer would mean more cubes, and more of them more particles beside the
  /// beam.
  static constexpr double kInCube = 0.5;

  /// `smallest_m(r)` is the diameter of the smallest particle that is detected at the range r; it must not fall with
  /// the range. It may be infinite. Particles are met from `from_m` on.
  ParticleField(std::uint64_t seed_of_air, const Medium& medium, double from_m,
                std::function<double(double)> smallest_m);

  /// Calls met(range, diameter) for each particle of the frame whose centre lies in the beam and that is detected. In
  /// no particular order.
  void meet(std::uint64_t frame, const LitCylinder& beam, const std::function<void(double, double)>& met) const;

 private:
  struct Class {
    std::uint32_t number = 0;
    double cube_m = 0;   // edge
    double reach_m = 0;  // the range up to which its largest particles are detected
  };
  struct Visit;

  void meet_class(const Class& size, Visit& visit) const;
  void meet_cube(const Class& size, const glm::i64vec3& cube, const Visit& visit) const;

  std::uint64_t seed_;
  double mean_diameter_m_;
  std::function<double(double)> smallest_m_;
  std::vector<Class> classes_;
};

}  // namespace simvis
