// The image formats that SimVis renders to and samples from.
#pragma once

#include <cstdint>

#include <vulkan/vulkan.h>

namespace simvis {

inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
inline constexpr VkFormat kColorFormat = VK_FORMAT_R32G32B32A32_SFLOAT;  ///< linear
inline constexpr VkDeviceSize kColorTexelBytes = 4 * sizeof(float);
inline constexpr VkFormat kItemFormat = VK_FORMAT_R32_UINT;  ///< indices of items
inline constexpr VkDeviceSize kItemTexelBytes = sizeof(std::uint32_t);
inline constexpr VkFormat kTextureFormat = VK_FORMAT_R8G8B8A8_SRGB;  ///< colour textures
inline constexpr VkFormat kMapFormat = VK_FORMAT_R8G8B8A8_UNORM;     ///< textures that do not hold colours

/// Bytes of a texel of a format other than kDepthFormat.
constexpr VkDeviceSize texel_bytes(VkFormat format) {
  return format == kColorFormat ? kColorTexelBytes : kItemTexelBytes;
}

}  // namespace simvis
