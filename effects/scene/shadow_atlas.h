// Places shadow maps side by side in one pass.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

class ShadowAtlas {
 public:
  struct Map {
    std::uint32_t first_view = 0, views = 1;  ///< views of the pass
  };

  /// Adds a map: one view within a square of `side_px`, or the six views of a cube in 3 x 2 such squares. The
  /// rectangles of the views are relative to the map's corner.
  Map add(std::vector<View> views, std::uint32_t side_px, const std::string& light, const std::string& reason);

  bool empty() const { return views_.empty(); }

  /// Throws InputError if the device's largest target does not hold all maps.
  Pass pass(const TargetLimits& limits);

 private:
  struct Block {
    std::uint32_t first_view = 0, end_view = 0, width_px = 0, height_px = 0;
  };
  std::uint32_t place(const std::vector<Block>& highest_first, std::uint32_t width_px);

  std::vector<View> views_;  // relative to the corners of their blocks
  std::vector<Block> blocks_;
  std::vector<glm::uvec2> corners_;  // of the block of each view
};

}  // namespace simvis
