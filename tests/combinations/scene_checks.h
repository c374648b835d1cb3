// Measures a scene and compares every value with the test's own geometry, with
// the stated bounds, and with the same scene in another form.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <simvis/measurement.h>
#include <simvis/scan.h>
#include "tests/combinations/combined_scene.h"

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

Measured measure(const CombinedScene& scene, const std::filesystem::path& folder, const Writing& writing = {});

/// The values that differ from the test's own geometry.
std::vector<Failure> compare_with_geometry(const CombinedScene& scene, const Measured& measured, Tally& tally);

/// Measures the scene and its relation in this folder, and compares all.
std::vector<Failure> check_scene(const CombinedScene& scene, const std::filesystem::path& folder, Tally& tally);

}  // namespace simvis::combined
