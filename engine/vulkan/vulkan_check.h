// Turns Vulkan's result codes into exceptions.
#pragma once

#include <vulkan/vulkan.h>

#include <string>
#include <string_view>

namespace simvis {

/// The name of a result, such as "VK_ERROR_DEVICE_LOST"; a general phrase for an unknown code.
const char* result_name(VkResult result);

/// "CALL: VK_ERROR_... (CODE)". If `purpose` is given, ": PURPOSE" follows.
std::string result_message(VkResult result, const char* call, std::string_view purpose = {});

/// Throws MachineError with result_message() unless the result is VK_SUCCESS.
void vk_check(VkResult result, const char* call, std::string_view purpose = {});

}  // namespace simvis
