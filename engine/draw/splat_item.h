// Items of a draw list that are clouds of Gaussian splats.
#pragma once

#include <cstdint>

#include <simvis/draw_list.h>

namespace simvis {

/// Whether the item, which may be hidden, is a cloud of splats.
inline bool is_splat_item(const DrawList& list, std::uint32_t item) {
  return list.meshes[list.items[item].mesh]->splats != nullptr;
}

}  // namespace simvis
