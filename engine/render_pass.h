// The render passes that pipelines and framebuffers are made for.
#pragma once

#include "engine/handle.h"

namespace simvis {

/// One subpass that clears its targets. Afterwards they are ready to be copied from; depth only if `keep_depth`.
/// Passes that differ in `keep_depth` alone are compatible.
Handle<VkRenderPass> make_render_pass(Device::Impl& device, bool color, bool keep_depth);

}  // namespace simvis
