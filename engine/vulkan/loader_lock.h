// A lock around the lists of the Vulkan loader.
#pragma once

#include <shared_mutex>

namespace simvis {

/// The loader looks through all instances and devices of the process when an object gets a name, without a lock of its
/// own (seen in version 1.3.239, terminator of vkSetDebugUtilsObjectNameEXT). Whoever creates or destroys an instance
/// or a device holds this mutex; whoever names an object shares it.
std::shared_mutex& loader_lists();

}  // namespace simvis
