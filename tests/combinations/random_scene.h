// Random scenes, in which each feature is drawn independently of the others.
#pragma once

#include <cstdint>

#include "tests/combinations/combined_scene.h"

namespace simvis::combined {

/// The scene of this number, the same on every machine.
CombinedScene random_scene(std::uint64_t seed);

}  // namespace simvis::combined
