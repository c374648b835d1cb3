// The drops of rain in the air, each at its own place in the world.
//
// Model    Drops are a Poisson process in space with N drops per cubic metre, whose diameters have an exponential
//          distribution with mean D0. Space is divided into cubes of kCell_m. In a cube of volume V the numbers
//          N V exp(-D / D0) of its drops, from the largest on, are the arrival times of a Poisson process of rate 1.
//          Drops are drawn in this order until one is too small to be detected, so that a scanner's sensitivity does
//          not move any drop, and small ones cost nothing.
// Seeds    a cube's numbers depend on the seed of the run, the frame and the cube. All scanners of a scene meet the
//          same drops. Each frame has other drops, because drops fall by many cubes between two frames.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>

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

class DropField {
 public:
  /// Much longer than a beam is wide, and short enough for few drops.
  static constexpr double kCell_m = 0.25;

  DropField(std::uint64_t seed_of_air, const Medium& medium, std::uint64_t frame)
      : random_(seed_of_air, "air/drops"), medium_(medium), frame_(frame) {}

  /// Calls met(range, diameter) for each drop whose centre lies in the beam and whose diameter is at least
  /// smallest_m(range), which must not fall with the range. In no particular order.
  void meet(const LitCylinder& beam, const std::function<double(double)>& smallest_m,
            const std::function<void(double, double)>& met) const;

 private:
  void meet_cell(const glm::i64vec3& cell, const LitCylinder& beam, const std::function<double(double)>& smallest_m,
                 const std::function<void(double, double)>& met) const;

  SensorRandom random_;
  Medium medium_;
  std::uint64_t frame_;
};

}  // namespace simvis
