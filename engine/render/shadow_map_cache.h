// Which shadow maps are still on the device as the previous frame left them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/render/view_draw_list.h"

namespace simvis {

/// Compares what a view of a shadow atlas draws with what was drawn there last: place, projection, instances and draws.
/// Equal commands on equal meshes, materials and textures give the same texels, so they need not be recorded again. A
/// lamp whose surroundings stand still thus keeps the sides of its cube while the camera moves.
///
/// If only some casters of a view differ, only the texels that they cover, or covered before, are drawn again, by all
/// casters that may reach these. A texel holds the depth of the caster nearest to the light, in whatever order they are
/// drawn, so the result is the same as that of drawing the whole view.
class ShadowMapCache {
 public:
  /// `target`: the number of the atlas, see RenderTarget. `views` are the draws of maps.views; their numbers refer to
  /// `runs` and `instances`. `uploaded`: a mesh, a material or a texture has been written since the previous call.
  void update(std::uint64_t target, const Pass& maps, std::span<const ViewDraws> views, std::span<const DrawRun> runs,
              std::span<const shader::Instance> instances, bool uploaded);

  /// After update(): whether the atlas has no content yet, so that all of it has to be cleared.
  bool is_new() const { return new_; }
  /// After update(): the pixels of view `i` that have to be drawn, relative to the view. Empty if there are none.
  const PixelRect& due(std::size_t i) const { return due_[i].pixels; }
  /// After update(): the draws that may reach these pixels.
  std::span<const DrawRun> due_runs(std::size_t i) const;
  bool any_due() const;

  /// Nothing is on the device any more.
  void clear() { *this = ShadowMapCache(); }

 private:
  // One instance of a draw: all that determines its texels, but the content of buffers and textures.
  struct Caster {
    std::array<std::uint64_t, 5> draw{};  // numbers of the run
    shader::Instance instance{};
    glm::vec3 low{0}, high{0};  // box of the mesh, in its frame
  };
  struct Drawn {
    std::uint32_t x_px = 0, y_px = 0, width_px = 0, height_px = 0;
    shader::ViewBlock block{};
    std::vector<Caster> casters;
    bool comparable = false;
  };
  struct Due {
    PixelRect pixels;
    std::size_t first_run = 0, end_run = 0;  // in due_runs_
  };
  static Drawn drawn(const View& view, const ViewDraws& draws, std::span<const DrawRun> runs,
                     std::span<const shader::Instance> instances);
  static bool same_place(const Drawn& a, const Drawn& b);
  static int compare(const Caster& a, const Caster& b);
  static PixelRect covered(const Caster& caster, const View& view);
  static PixelRect changed(const Drawn& a, const Drawn& b, const View& view);
  void add_due(const PixelRect& pixels, const View& view, const Drawn& now, std::span<const DrawRun> runs);

  std::uint64_t target_ = 0;
  std::vector<Drawn> drawn_;
  std::vector<Due> due_;
  std::vector<DrawRun> due_runs_;
  bool new_ = true;
};

}  // namespace simvis
