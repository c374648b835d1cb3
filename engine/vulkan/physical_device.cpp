#include "engine/vulkan/physical_device.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>

#include <simvis/error.h>
#include "engine/vulkan/formats.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

// The most preferred type comes first.
constexpr const char* kTypes[] = {"discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"};

const char* type_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return kTypes[0];
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return kTypes[1];
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return kTypes[2];
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return kTypes[3];
    default:
      return kTypes[4];
  }
}

std::ptrdiff_t rank(const DeviceInfo& info) {
  return std::find(std::begin(kTypes), std::end(kTypes), info.type) - std::begin(kTypes);
}

std::string version_text(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

// A device with a queue family for graphics has one for graphics and compute (Vulkan 1.2, section 5.1).
std::optional<std::uint32_t> graphics_queue_family(VkPhysicalDevice device) {
  const std::vector<VkQueueFamilyProperties> families = queue_families(device);
  constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    if ((families[i].queueFlags & kNeeded) == kNeeded) return i;
  }
  return std::nullopt;
}

bool can(VkPhysicalDevice device, VkFormat format, VkFormatFeatureFlags needed) {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(device, format, &properties);
  return (properties.optimalTilingFeatures & needed) == needed;
}

std::string why_unusable(VkPhysicalDevice device, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_2) {
    return "it offers Vulkan " + version_text(properties.apiVersion) + ", 1.2 or newer is needed";
  }
  if (!graphics_queue_family(device)) return "it has no queue for graphics and compute";
  if (!can(device, kDepthFormat, VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_FORMAT_FEATURE_TRANSFER_SRC_BIT)) {
    return "it cannot render to and read back a depth image of format D32_SFLOAT";
  }
  if (!can(device, kColorFormat,
           VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT | VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT |
               VK_FORMAT_FEATURE_TRANSFER_SRC_BIT)) {
    return "it cannot blend into and read back a colour image of format R32G32B32A32_SFLOAT";
  }
  if (!can(device, kTextureFormat, VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT)) {
    return "it cannot filter textures of format R8G8B8A8_SRGB";
  }
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(device, &features);
  if (!features.fullDrawIndexUint32) return "it cannot draw with 32-bit indices (fullDrawIndexUint32)";
  if (!features.fragmentStoresAndAtomics || !features.sampleRateShading) {
    return "it cannot keep transparent surfaces apart (fragmentStoresAndAtomics, sampleRateShading)";
  }
  return "";
}

VkSampleCountFlags sample_counts(VkPhysicalDevice device, VkFormat format, VkImageUsageFlags usage) {
  VkImageFormatProperties properties{};
  const VkResult result = vkGetPhysicalDeviceImageFormatProperties(device, format, VK_IMAGE_TYPE_2D,
                                                                   VK_IMAGE_TILING_OPTIMAL, usage, 0, &properties);
  // A driver that is out of memory says nothing about the format.
  if (result != VK_ERROR_FORMAT_NOT_SUPPORTED) vk_check(result, "vkGetPhysicalDeviceImageFormatProperties");
  return result == VK_SUCCESS ? properties.sampleCounts : VkSampleCountFlags{VK_SAMPLE_COUNT_1_BIT};
}

TargetLimits target_limits(VkPhysicalDevice device, const VkPhysicalDeviceLimits& limits) {
  TargetLimits targets{.width_px = std::min(limits.maxFramebufferWidth, limits.maxImageDimension2D),
                       .height_px = std::min(limits.maxFramebufferHeight, limits.maxImageDimension2D),
                       .msaa = {1}};
  if (limits.standardSampleLocations == VK_FALSE) return targets;
  const VkSampleCountFlags counts =
      sample_counts(device, kColorFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT) &
      sample_counts(device, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
  // The value of each flag is its sample count.
  for (const std::uint32_t count : {2u, 4u, 8u}) {
    if (counts & count) targets.msaa.push_back(count);
  }
  return targets;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The devices that `select` matches. It is an index into the list or, if it is not, a part of the name.
std::vector<std::size_t> matches(const std::vector<DeviceInfo>& devices, const std::string& select) {
  const bool digits = !select.empty() && select.find_first_not_of("0123456789") == std::string::npos;
  if (digits && select.size() < 10 && std::stoul(select) < devices.size()) return {std::stoul(select)};
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (lower(devices[i].name).find(lower(select)) != std::string::npos) found.push_back(i);
  }
  return found;
}

// The device must support Vulkan 1.1 or newer.
template <typename Properties>
Properties properties_of(VkPhysicalDevice device, VkStructureType type) {
  Properties found{};
  found.sType = type;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &found;
  vkGetPhysicalDeviceProperties2(device, &properties);
  return found;
}

// Largest number of draws in one command.
std::uint32_t max_draws(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  const bool offered = std::ranges::any_of(extensions, [](const VkExtensionProperties& extension) {
    return std::string_view(extension.extensionName) == VK_EXT_MULTI_DRAW_EXTENSION_NAME;
  });
  if (!offered) return 1;
  VkPhysicalDeviceMultiDrawFeaturesEXT multi_draw{};
  multi_draw.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTI_DRAW_FEATURES_EXT;
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.pNext = &multi_draw;
  vkGetPhysicalDeviceFeatures2(device, &features);
  if (multi_draw.multiDraw == VK_FALSE) return 1;
  return properties_of<VkPhysicalDeviceMultiDrawPropertiesEXT>(
             device, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTI_DRAW_PROPERTIES_EXT)
      .maxMultiDrawCount;
}

}  // namespace

PhysicalDevice examine(VkPhysicalDevice handle) {
  PhysicalDevice device;
  device.handle = handle;
  vkGetPhysicalDeviceProperties(handle, &device.properties);
  device.info.name = device.properties.deviceName;
  device.info.type = type_name(device.properties.deviceType);
  device.info.api_version = version_text(device.properties.apiVersion);
  device.info.unusable = why_unusable(handle, device.properties);
  device.targets = target_limits(handle, device.properties.limits);
  device.queue_family = graphics_queue_family(handle).value_or(0);
  device.timestamp_bits = queue_families(handle).at(device.queue_family).timestampValidBits;
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(handle, &features);
  device.counts_invocations = features.pipelineStatisticsQuery == VK_TRUE;
  device.has_large_points = features.largePoints == VK_TRUE;
  if (device.has_large_points) device.max_point_px = device.properties.limits.pointSizeRange[1];
  device.point_step_px = device.properties.limits.pointSizeGranularity;
  device.snap_px = std::ldexp(1.0, -static_cast<int>(device.properties.limits.subPixelPrecisionBits));
  device.depth_snap_px = device.snap_px;
  if (device.properties.apiVersion >= VK_API_VERSION_1_2) {
    const auto driver =
        properties_of<VkPhysicalDeviceDriverProperties>(handle, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
    device.info.driver = std::string(driver.driverName) + " " + driver.driverInfo;
    device.max_draws = max_draws(handle);
    // llvmpipe computes coverage from snapped vertices, but planes from the original vertices (Mesa, lp_state_setup.c).
    if (driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE) device.depth_snap_px = 0;
  } else {
    device.info.driver = "driver version " + std::to_string(device.properties.driverVersion);
  }
  return device;
}

std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select) {
  const std::vector<std::size_t> candidates = matches(devices, select);
  if (candidates.empty()) {
    std::string message = "no Vulkan device matches \"" + select + "\", expected an index or a part of a name:";
    for (std::size_t i = 0; i < devices.size(); ++i) {
      message += (i ? ", " : " ") + std::to_string(i) + " (" + devices[i].name + ")";
    }
    throw InputError(message);
  }
  std::optional<std::size_t> best;
  for (const std::size_t i : candidates) {
    if (!devices[i].unusable.empty()) continue;
    if (!best || rank(devices[i]) < rank(devices[*best])) best = i;
  }
  if (best) return *best;
  std::string message = "no Vulkan device fits:";
  for (const std::size_t i : candidates) message += "\n  " + devices[i].name + ": " + devices[i].unusable;
  throw MachineError(message);
}

}  // namespace simvis
