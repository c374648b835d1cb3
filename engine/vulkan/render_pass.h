// The render passes that pipelines and framebuffers are made for.
#pragma once

#include "engine/vulkan/handle.h"

namespace simvis {

/// Passes that differ only in how their targets are used before and after them are compatible.
struct RenderPassKind {
  bool color = false;
  bool items = false;         ///< has a target of items; only without colour
  bool keep_depth = true;     ///< depth is copied afterwards
  bool sampled = false;       ///< fragment shaders of later passes read depth; not compatible with other passes
  bool averaged = false;      ///< ResolvePass reads the colour afterwards; otherwise it is copied
  bool resumed = false;       ///< continues a pass with the same targets, if `sampled` that of an earlier frame
  bool continued = false;     ///< a resumed pass follows before anything is copied
  std::uint32_t samples = 1;  ///< per pixel of the targets

  std::uint32_t bits() const {
    return samples << 6 | (items ? 1024u : 0u) | (sampled ? 32u : 0u) | continued << 4 | resumed << 3 | averaged << 2 |
           keep_depth << 1 | (color ? 1u : 0u);
  }
};

/// Makes a pass of one subpass. It clears its targets unless it is `resumed`, and leaves them in the layout of their
/// next use.
Handle<VkRenderPass> make_render_pass(DeviceImpl& device, const RenderPassKind& kind);

}  // namespace simvis
