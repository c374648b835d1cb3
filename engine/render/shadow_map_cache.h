// Which shadow maps are still on the device as the previous frame left them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/render/view_draw_list.h"

namespace simvis {

/// Compares what a view of a shadow atlas draws with what was drawn there last: place, projection, instances and draws.
/// Equal commands on equal meshes, materials and textures give the same texels, so they need not be recorded again. A
/// lamp whose surroundings stand still thus keeps the sides of its cube while the camera moves.
class ShadowMapCache {
 public:
  /// `target`: the number of the atlas, see RenderTarget. `views` are the draws of maps.views; their numbers refer to
  /// `runs` and `instances`. `uploaded`: a mesh, a material or a texture has been written since the previous call.
  void update(std::uint64_t target, const Pass& maps, std::span<const ViewDraws> views, std::span<const DrawRun> runs,
              std::span<const shader::Instance> instances, bool uploaded);

  /// After update(): whether the atlas has no content yet, so that all of it has to be cleared.
  bool is_new() const { return new_; }
  /// After update(): whether view `i` has to be drawn.
  bool is_due(std::size_t i) const { return due_[i]; }
  bool any_due() const;

  /// Nothing is on the device any more.
  void clear() { *this = ShadowMapCache(); }

 private:
  // All that determines the texels of a view, but the content of buffers and textures.
  struct Drawn {
    std::uint32_t x_px = 0, y_px = 0, width_px = 0, height_px = 0;
    shader::ViewBlock block{};
    std::vector<std::uint64_t> runs;  // the numbers of each run, one after the other
    std::vector<shader::Instance> instances;
    bool comparable = false;
  };
  static Drawn drawn(const View& view, const ViewDraws& draws, std::span<const DrawRun> runs,
                     std::span<const shader::Instance> instances);
  static bool same(const Drawn& a, const Drawn& b);

  std::uint64_t target_ = 0;
  std::vector<Drawn> drawn_;
  std::vector<bool> due_;
  bool new_ = true;
};

}  // namespace simvis
