#include "effects/scene/shadow_atlas.h"

#include <algorithm>
#include <cmath>

#include <simvis/error.h>

namespace simvis {

ShadowAtlas::Map ShadowAtlas::add(std::vector<View> views, std::uint32_t side_px, const std::string& light,
                                  const std::string& reason) {
  const auto first = static_cast<std::uint32_t>(views_.size()), count = static_cast<std::uint32_t>(views.size());
  blocks_.push_back({.first_view = first,
                     .end_view = first + count,
                     .width_px = count > 1 ? 3 * side_px : side_px,
                     .height_px = count > 1 ? 2 * side_px : side_px});
  for (std::uint32_t i = 0; i < count; ++i) {
    View& view = views_.emplace_back(std::move(views[i]));
    view.name = count > 1 ? light + ", side " + std::to_string(i) : light;
    view.reason = reason;
  }
  return {first, count};
}

// Places the blocks in rows, each as high as its first block; returns the total height.
std::uint32_t ShadowAtlas::place(const std::vector<Block>& highest_first, std::uint32_t width_px) {
  corners_.resize(views_.size());
  std::uint64_t x = 0, y = 0, row = 0;
  for (const Block& block : highest_first) {
    if (x + block.width_px > width_px) {
      y += row;
      x = row = 0;
    }
    for (std::uint32_t i = block.first_view; i < block.end_view; ++i) corners_[i] = {x, y};
    x += block.width_px;
    row = std::max<std::uint64_t>(row, block.height_px);
  }
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(y + row, UINT32_MAX));
}

Pass ShadowAtlas::pass(const TargetLimits& limits) {
  std::vector<Block> highest_first = blocks_;
  std::ranges::stable_sort(highest_first, std::ranges::greater{}, &Block::height_px);
  double area = 0;
  std::uint32_t widest = 0;
  for (const Block& block : blocks_) {
    area += static_cast<double>(block.width_px) * block.height_px;
    widest = std::max(widest, block.width_px);
  }
  // Tries a nearly square atlas first, then the full width.
  std::uint32_t width = std::max(widest, static_cast<std::uint32_t>(std::ceil(std::sqrt(area))));
  std::uint32_t height = place(highest_first, width);
  if (height > limits.height_px && width < limits.width_px) height = place(highest_first, width = limits.width_px);
  if (width > limits.width_px || height > limits.height_px) {
    throw InputError("the shadow maps of " + std::to_string(blocks_.size()) + " lights take " + std::to_string(width) +
                     " x " + std::to_string(height) + " texels, more than the " + std::to_string(limits.width_px) +
                     " x " + std::to_string(limits.height_px) + " of this device, expected a lower shadow_resolution");
  }
  Pass pass{.name = "shadow maps", .width_px = width, .height_px = height, .views = views_, .shadow_maps = true};
  for (std::size_t i = 0; i < views_.size(); ++i) {
    pass.views[i].x_px += corners_[i].x;
    pass.views[i].y_px += corners_[i].y;
  }
  return pass;
}

}  // namespace simvis
