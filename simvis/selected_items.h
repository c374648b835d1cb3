// Which of several selections of shapes each item of a draw list belongs to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "elements/shape_selection.h"
#include "scenegraph/flattener.h"

namespace simvis {

/// By item of the flattener's last update(): 0 if none of the selections has it, otherwise 1 more than the place of the
/// one that has, by the rank of shape_selection.h.
std::vector<std::uint32_t> selections_of_items(std::span<const ShapeSelection* const> selections,
                                               const Flattener& flattener);

}  // namespace simvis
