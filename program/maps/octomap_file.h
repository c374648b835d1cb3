// Binary trees of OctoMap (.bt).
#pragma once

#include <string>

#include "program/maps/scene_cells.h"

namespace simvis {

/// The bytes of a .bt file of OctoMap 1.6 or newer, pruned: eight equal leaves are one. Cells outside of the map are
/// unknown. The format is described in import/grid_map/octomap_importer.cpp, which reads it.
/// Throws InputError if a cell lies farther than 32768 cells from the origin, which the format cannot hold.
std::string encode_octomap(const SceneCells& map);

}  // namespace simvis
