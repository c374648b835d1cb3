// Finds what is probably a mistake in a scene, for `simvis-run --check`.
#pragma once

#include <string>
#include <vector>

#include "simvis/scene_builder.h"

namespace simvis {

inline constexpr double kMaxPartSize_m = 1000;  ///< a larger part is taken for one in another unit

/// One line "FILE:LINE:COLUMN: WHAT" for each problem of a scene as it stands:
///   a part whose own shapes reach over kMaxPartSize_m or more along x, y or z
///   a sensor within a solid: where the winding number of a visible, opaque mesh is 1. A camera whose near distance
///   leaves out the whole solid is none.
/// The warnings of the scene are not among them. `threads` as SimulationDesc::threads.
std::vector<std::string> check_scene(const BuiltScene& built, unsigned threads = 0);

}  // namespace simvis
