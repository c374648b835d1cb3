// Turns Vulkan's result codes into exceptions.
#pragma once

#include <vulkan/vulkan.h>

#include <string_view>

namespace simvis {

/// "VK_ERROR_DEVICE_LOST", ...; a phrase that says so for a code that is not known here.
const char* result_name(VkResult result);

/// Throws MachineError "CALL: VK_ERROR_... (CODE)" unless the result is VK_SUCCESS; where it is known what the call was
/// for, ": PURPOSE" follows.
void vk_check(VkResult result, const char* call, std::string_view purpose = {});

}  // namespace simvis
