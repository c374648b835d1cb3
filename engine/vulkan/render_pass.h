// The render passes that pipelines and framebuffers are made for.
#pragma once

#include "engine/vulkan/handle.h"

namespace simvis {

/// Passes that differ only in what comes before and after them are compatible.
struct RenderPassKind {
  bool color = false;
  bool keep_depth = true;     ///< depth is copied afterwards
  bool sampled = false;       ///< depth is read by the fragments of later passes; such passes are a kind of their own
  bool averaged = false;      ///< the colour is read by ResolvePass afterwards; otherwise it is copied
  bool resumed = false;       ///< goes on where a pass of the same targets stopped
  bool continued = false;     ///< such a pass comes next, before anything is copied
  std::uint32_t samples = 1;  ///< of each pixel of the targets

  std::uint32_t bits() const {
    return samples << 6 | (sampled ? 32u : 0u) | continued << 4 | resumed << 3 | averaged << 2 | keep_depth << 1 |
           (color ? 1u : 0u);
  }
};

/// One subpass that clears its targets, unless it goes on in them, and leaves them ready for what comes after.
Handle<VkRenderPass> make_render_pass(Device::Impl& device, const RenderPassKind& kind);

}  // namespace simvis
