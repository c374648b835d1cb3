// Turns Vulkan's result codes into exceptions.
#pragma once

#include <vulkan/vulkan.h>

#include <string_view>

namespace simvis {

/// The name of a result, such as "VK_ERROR_DEVICE_LOST"; a general phrase for an unknown code.
const char* result_name(VkResult result);

/// Throws MachineError "CALL: VK_ERROR_... (CODE)" unless the result is VK_SUCCESS. If `purpose` is given, ": PURPOSE"
/// follows.
void vk_check(VkResult result, const char* call, std::string_view purpose = {});

}  // namespace simvis
