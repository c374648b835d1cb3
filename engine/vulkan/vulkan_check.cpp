#include "engine/vulkan/vulkan_check.h"

#include <simvis/error.h>

namespace simvis {

const char* result_name(VkResult result) {
  switch (result) {
#define SIMVIS_RESULT(name) \
  case name:                \
    return #name;
    SIMVIS_RESULT(VK_SUCCESS)
    SIMVIS_RESULT(VK_NOT_READY)
    SIMVIS_RESULT(VK_TIMEOUT)
    SIMVIS_RESULT(VK_INCOMPLETE)
    SIMVIS_RESULT(VK_ERROR_OUT_OF_HOST_MEMORY)
    SIMVIS_RESULT(VK_ERROR_OUT_OF_DEVICE_MEMORY)
    SIMVIS_RESULT(VK_ERROR_INITIALIZATION_FAILED)
    SIMVIS_RESULT(VK_ERROR_DEVICE_LOST)
    SIMVIS_RESULT(VK_ERROR_MEMORY_MAP_FAILED)
    SIMVIS_RESULT(VK_ERROR_LAYER_NOT_PRESENT)
    SIMVIS_RESULT(VK_ERROR_EXTENSION_NOT_PRESENT)
    SIMVIS_RESULT(VK_ERROR_FEATURE_NOT_PRESENT)
    SIMVIS_RESULT(VK_ERROR_INCOMPATIBLE_DRIVER)
    SIMVIS_RESULT(VK_ERROR_TOO_MANY_OBJECTS)
    SIMVIS_RESULT(VK_ERROR_FORMAT_NOT_SUPPORTED)
    SIMVIS_RESULT(VK_ERROR_FRAGMENTED_POOL)
    SIMVIS_RESULT(VK_ERROR_OUT_OF_POOL_MEMORY)
    SIMVIS_RESULT(VK_ERROR_FRAGMENTATION)
    SIMVIS_RESULT(VK_ERROR_UNKNOWN)
    SIMVIS_RESULT(VK_ERROR_INVALID_EXTERNAL_HANDLE)
    SIMVIS_RESULT(VK_ERROR_INVALID_OPAQUE_CAPTURE_ADDRESS)
#undef SIMVIS_RESULT
    default:
      return "a Vulkan error without a known name";
  }
}

std::string result_message(VkResult result, const char* call, std::string_view purpose) {
  std::string message = std::string(call) + ": " + result_name(result) + " (" + std::to_string(result) + ")";
  if (!purpose.empty()) message.append(": ").append(purpose);
  return message;
}

void vk_check(VkResult result, const char* call, std::string_view purpose) {
  if (result != VK_SUCCESS) throw MachineError(result_message(result, call, purpose));
}

}  // namespace simvis
