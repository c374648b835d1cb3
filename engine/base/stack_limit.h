// The stacks that threads need.
#pragma once

namespace simvis {

/// Throws MachineError if the calling thread, or threads that it starts, have less stack than packets of rays, nested
/// parts and the Vulkan driver need. Without this check the process would end by a signal and without a message.
void require_stack();

}  // namespace simvis
