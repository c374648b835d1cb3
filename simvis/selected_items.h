// Which of several selections of shapes each item of a draw list belongs to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "elements/shape_selection.h"
#include "scenegraph/flattener.h"

namespace simvis {

/// Where a selection has an item.
struct SelectedItem {
  std::uint32_t selection = 0;  ///< 0: none has it; otherwise 1 more than the place of the one that has
  ShapeName name{};             ///< of the selection's names, the one that is the item's; empty: the selection has none
};

/// By item of the flattener's last update(), by the rank of shape_selection.h. Names are valid as long as the nodes.
std::vector<SelectedItem> selections_of_items(std::span<const ShapeSelection* const> selections,
                                              const Flattener& flattener);

}  // namespace simvis
