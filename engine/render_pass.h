// The render passes that pipelines and framebuffers are made for.
#pragma once

#include "engine/handle.h"

namespace simvis {

/// Passes that differ only in what comes after them (`keep_depth`, `averaged`) are compatible.
struct RenderPassKind {
  bool color = false;
  bool keep_depth = true;     ///< depth is copied afterwards
  bool sampled = false;       ///< depth is read by the fragments of later passes; such passes are a kind of their own
  bool averaged = false;      ///< the colour is read by SampleAverage afterwards; otherwise it is copied
  std::uint32_t samples = 1;  ///< of each pixel of the targets

  std::uint32_t bits() const {
    return samples << 4 | (sampled ? 8u : 0u) | averaged << 2 | keep_depth << 1 | (color ? 1u : 0u);
  }
};

/// One subpass that clears its targets and leaves them ready for what comes after.
Handle<VkRenderPass> make_render_pass(Device::Impl& device, const RenderPassKind& kind);

}  // namespace simvis
