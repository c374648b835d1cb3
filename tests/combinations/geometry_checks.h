// Compares every value that the sensors of a scene measured with the test's own geometry and with the stated bounds.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <simvis/measurement.h>
#include <simvis/scan.h>
#include "tests/combinations/combined_scene.h"
#include "tests/combinations/exact_world.h"

namespace simvis::combined {

/// What the sensors of a scene measured, by frame and sensor.
struct Measured {
  std::array<std::vector<Measurement>, kFrames> frames{};
  std::vector<SceneItem> items{};
};

/// A value that is wrong: by which check, and where.
struct Failure {
  std::string check, text;
};

/// What was checked.
struct Tally {
  std::map<std::string, std::size_t> values;  ///< by check
  std::size_t at_edges = 0;                   ///< values that belong to another surface within the stated distance
  std::size_t narrow = 0;                     ///< of surfaces that are narrower than a bound covers
  std::size_t unbounded = 0;                  ///< without a finite bound
};

/// A number for a message.
std::string text_of(Real value);

/// The values that differ from the test's own geometry.
std::vector<Failure> compare_with_geometry(const CombinedScene& scene, const Measured& measured, Tally& tally);

}  // namespace simvis::combined
