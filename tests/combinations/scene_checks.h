// Measures a scene, and compares it with geometry and with the same scene in another form: shuffled, in company,
// doubled, moved, mirrored or divided.
#pragma once

#include <filesystem>
#include <vector>

#include "tests/combinations/comparison.h"

namespace simvis::combined {

/// Writes the scene to this folder and runs it.
Measured measure(const CombinedScene& scene, const std::filesystem::path& folder, const Writing& writing = {});

/// Measures the scene and its relation in this folder, and compares all.
std::vector<Failure> check_scene(const CombinedScene& scene, const std::filesystem::path& folder, Tally& tally);

}  // namespace simvis::combined
