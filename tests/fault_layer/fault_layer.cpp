// A Vulkan layer that makes calls fail. README.md says how it is used.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <utility>

#include "tests/fault_layer/history.h"
#include "tests/fault_layer/interception.h"

namespace simvis::faults {
namespace {

constexpr const char* kLayer = "VK_LAYER_SIMVIS_faults";

/// The loader's description of the next layer. Advances the list for that layer.
template <typename Info>
auto* next_link(const void* chain, VkStructureType type) {
  auto* info = static_cast<Info*>(const_cast<void*>(chain));
  while (info != nullptr && !(info->sType == type && info->function == VK_LAYER_LINK_INFO)) {
    info = static_cast<Info*>(const_cast<void*>(info->pNext));
  }
  if (info == nullptr) std::abort();
  return std::exchange(info->u.pLayerInfo, info->u.pLayerInfo->pNext);
}

/// Carries out the outcome of a call that makes an instance or a device. Empty: the driver decides.
std::optional<VkResult> carry_out(const CallCounts::Outcome& outcome) {
  if (outcome.delay.count() > 0) std::this_thread::sleep_for(outcome.delay);
  return outcome.result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* memory,
                                               VkInstance* instance) {
  const auto get = next_link<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO)
                       ->pfnNextGetInstanceProcAddr;
  Settings settings = read_settings();
  if (const auto result = carry_out(next_instance_call(settings))) return *result;
  const VkResult result = as<PFN_vkCreateInstance>(get(nullptr, "vkCreateInstance"))(info, memory, instance);
  if (result != VK_SUCCESS) return result;
  auto scope = std::make_shared<InstanceScope>(std::move(settings));
  scope->get = get;
  const auto function = [&](const char* name) { return get(*instance, name); };
  scope->destroy = as<PFN_vkDestroyInstance>(function("vkDestroyInstance"));
  scope->memory = as<PFN_vkGetPhysicalDeviceMemoryProperties>(function("vkGetPhysicalDeviceMemoryProperties"));
  scope->memory2 = as<PFN_vkGetPhysicalDeviceMemoryProperties2>(function("vkGetPhysicalDeviceMemoryProperties2"));
  scope->properties = as<PFN_vkGetPhysicalDeviceProperties>(function("vkGetPhysicalDeviceProperties"));
  scope->properties2 = as<PFN_vkGetPhysicalDeviceProperties2>(function("vkGetPhysicalDeviceProperties2"));
  for (std::size_t i = 0; i < kCommandCount; ++i) scope->next[i] = function(kCommands[i].name.data());
  add_instance(*instance, std::move(scope));
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* memory) {
  if (instance == VK_NULL_HANDLE) return;
  const std::shared_ptr<InstanceScope> ended = take_instance(instance);
  record_end(static_cast<const Scope&>(*ended));
  ended->destroy(instance, memory);
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* memory, VkDevice* device) {
  const auto* const link = next_link<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  const auto create = as<PFN_vkCreateDevice>(link->pfnNextGetInstanceProcAddr(VK_NULL_HANDLE, "vkCreateDevice"));
  const PFN_vkGetDeviceProcAddr get = link->pfnNextGetDeviceProcAddr;
  const std::shared_ptr<InstanceScope> instance = instance_of(physical);
  if (const auto result = carry_out(instance->calls.next(index_of("vkCreateDevice")))) return *result;
  const VkResult result = create(physical, info, memory, device);
  if (result != VK_SUCCESS) return result;
  auto scope = std::make_shared<DeviceScope>(read_settings());
  scope->get = get;
  scope->destroy = as<PFN_vkDestroyDevice>(get(*device, "vkDestroyDevice"));
  scope->memory = instance->memory_model(physical);
  for (std::size_t i = 0; i < kCommandCount; ++i) scope->next[i] = get(*device, kCommands[i].name.data());
  add_device(*device, std::move(scope));
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* memory) {
  if (device == VK_NULL_HANDLE) return;
  const std::shared_ptr<DeviceScope> ended = take_device(device);
  record_end(*ended);
  ended->destroy(device, memory);
}

// Asked about this layer, it names no extension.
VKAPI_ATTR VkResult VKAPI_CALL device_extensions(VkPhysicalDevice physical, const char* layer, std::uint32_t* count,
                                                 VkExtensionProperties* properties) {
  if (layer != nullptr && std::strcmp(layer, kLayer) == 0) {
    *count = 0;
    return VK_SUCCESS;
  }
  using Counted =
      Interception<index_of("vkEnumerateDeviceExtensionProperties"), PFN_vkEnumerateDeviceExtensionProperties>;
  return Counted::call(physical, layer, count, properties);
}

VKAPI_ATTR void VKAPI_CALL memory_properties(VkPhysicalDevice physical, VkPhysicalDeviceMemoryProperties* properties) {
  *properties = instance_of(physical)->memory_model(physical)->properties();
}

VKAPI_ATTR void VKAPI_CALL memory_properties2(VkPhysicalDevice physical,
                                              VkPhysicalDeviceMemoryProperties2* properties) {
  const auto instance = instance_of(physical);
  instance->memory2(physical, properties);
  properties->memoryProperties = instance->memory_model(physical)->properties();
}

VKAPI_ATTR void VKAPI_CALL device_properties(VkPhysicalDevice physical, VkPhysicalDeviceProperties* properties) {
  const auto instance = instance_of(physical);
  instance->properties(physical, properties);
  set_limits(instance->settings.limits, properties->limits);
}

VKAPI_ATTR void VKAPI_CALL device_properties2(VkPhysicalDevice physical, VkPhysicalDeviceProperties2* properties) {
  const auto instance = instance_of(physical);
  instance->properties2(physical, properties);
  set_limits(instance->settings.limits, properties->properties.limits);
}

// Images of two dimensions are limited as maxImageDimension2D says.
void limit_extent(VkPhysicalDevice physical, VkImageType type, VkImageFormatProperties& format) {
  VkPhysicalDeviceProperties properties;
  device_properties(physical, &properties);
  if (type != VK_IMAGE_TYPE_2D) return;
  format.maxExtent.width = std::min(format.maxExtent.width, properties.limits.maxImageDimension2D);
  format.maxExtent.height = std::min(format.maxExtent.height, properties.limits.maxImageDimension2D);
}

VKAPI_ATTR VkResult VKAPI_CALL image_format(VkPhysicalDevice physical, VkFormat format, VkImageType type,
                                            VkImageTiling tiling, VkImageUsageFlags usage, VkImageCreateFlags flags,
                                            VkImageFormatProperties* properties) {
  using Counted =
      Interception<index_of("vkGetPhysicalDeviceImageFormatProperties"), PFN_vkGetPhysicalDeviceImageFormatProperties>;
  const VkResult result = Counted::call(physical, format, type, tiling, usage, flags, properties);
  if (result == VK_SUCCESS) limit_extent(physical, type, *properties);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL image_format2(VkPhysicalDevice physical, const VkPhysicalDeviceImageFormatInfo2* info,
                                             VkImageFormatProperties2* properties) {
  using Counted = Interception<index_of("vkGetPhysicalDeviceImageFormatProperties2"),
                               PFN_vkGetPhysicalDeviceImageFormatProperties2>;
  const VkResult result = Counted::call(physical, info, properties);
  if (result == VK_SUCCESS) limit_extent(physical, info->type, properties->imageFormatProperties);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice handle, const VkMemoryAllocateInfo* info,
                                               const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
  const auto device = device_of(handle);
  if (const auto refused = device->memory->reserve(*info)) return *refused;
  VkMemoryAllocateInfo driver_info = *info;
  driver_info.memoryTypeIndex = device->memory->driver_type(info->memoryTypeIndex);
  using Counted = Interception<index_of("vkAllocateMemory"), PFN_vkAllocateMemory>;
  const VkResult result = Counted::call(handle, &driver_info, callbacks, memory);
  if (result == VK_SUCCESS) {
    device->memory->note(*memory, *info);
  } else {
    device->memory->give_back(*info);
  }
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL map_memory(VkDevice handle, VkDeviceMemory memory, VkDeviceSize offset,
                                          VkDeviceSize size, VkMemoryMapFlags flags, void** data) {
  if (!device_of(handle)->memory->can_map(memory)) return VK_ERROR_MEMORY_MAP_FAILED;
  return Interception<index_of("vkMapMemory"), PFN_vkMapMemory>::call(handle, memory, offset, size, flags, data);
}

// Functions that say which memory types an object may have. They differ in the types of their parameters.
VkMemoryRequirements& core(VkMemoryRequirements& requirements) { return requirements; }
VkMemoryRequirements& core(VkMemoryRequirements2& requirements) { return requirements.memoryRequirements; }

template <typename Name, typename Function>
struct Requirements;
template <typename Name, typename Of, typename Result>
struct Requirements<Name, void(VKAPI_PTR*)(VkDevice, Of, Result*)> {
  static VKAPI_ATTR void VKAPI_CALL call(VkDevice handle, Of of, Result* requirements) {
    const auto device = device_of(handle);
    as<void(VKAPI_PTR*)(VkDevice, Of, Result*)>(device->get(handle, Name::kText))(handle, of, requirements);
    VkMemoryRequirements& shown = core(*requirements);
    shown.memoryTypeBits = device->memory->shown_types(shown.memoryTypeBits);
  }
};

template <typename Type, typename Function>
struct Destroyer;
template <typename Type, typename Object>
struct Destroyer<Type, void(VKAPI_PTR*)(VkDevice, Object, const VkAllocationCallbacks*)> {
  static VKAPI_ATTR void VKAPI_CALL call(VkDevice handle, Object object, const VkAllocationCallbacks* callbacks) {
    const auto device = device_of(handle);
    const auto next =
        as<void(VKAPI_PTR*)(VkDevice, Object, const VkAllocationCallbacks*)>(device->get(handle, Type::kDestroyer));
    if (object != Object(VK_NULL_HANDLE)) {
      device->objects.remove(Type::kText, reinterpret_cast<std::uint64_t>(object));
      if constexpr (std::is_same_v<Object, VkDeviceMemory>) device->memory->freed(object);
    }
    next(handle, object, callbacks);
  }
};

// Two makers may have one destroyer, so each of these types is local to its row.
#define SIMVIS_OBJECT(type, maker, destroyer)             \
  struct Made_##maker {                                   \
    static constexpr std::string_view kText = #type;      \
    static constexpr const char* kDestroyer = #destroyer; \
  };
#include "tests/fault_layer/objects.inc"
#undef SIMVIS_OBJECT

#define SIMVIS_REQUIREMENTS(X)           \
  X(vkGetBufferMemoryRequirements)       \
  X(vkGetImageMemoryRequirements)        \
  X(vkGetBufferMemoryRequirements2)      \
  X(vkGetImageMemoryRequirements2)       \
  X(vkGetDeviceBufferMemoryRequirements) \
  X(vkGetDeviceImageMemoryRequirements)
#define SIMVIS_NAME(name)                       \
  struct Name_##name {                          \
    static constexpr const char* kText = #name; \
  };
SIMVIS_REQUIREMENTS(SIMVIS_NAME)
#undef SIMVIS_NAME

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name);
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance, const char* name);

template <typename Function>
PFN_vkVoidFunction plain(Function function) {
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}

using Functions = std::unordered_map<std::string_view, PFN_vkVoidFunction>;

Functions make_own_functions() {
  Functions own;
#define SIMVIS_COMMAND(name, ...) own[#name] = plain(Interception<index_of(#name), PFN_##name>::call);
#include "tests/fault_layer/commands.inc"
#undef SIMVIS_COMMAND
#define SIMVIS_OBJECT(type, maker, destroyer) own[#destroyer] = plain(Destroyer<Made_##maker, PFN_##destroyer>::call);
#include "tests/fault_layer/objects.inc"
#undef SIMVIS_OBJECT
#define SIMVIS_ENTRY(name) own[#name] = plain(Requirements<Name_##name, PFN_##name>::call);
  SIMVIS_REQUIREMENTS(SIMVIS_ENTRY)
#undef SIMVIS_ENTRY
  for (const auto& [name, function] : {std::pair{"vkGetInstanceProcAddr", plain(get_instance_function)},
                                       {"vkGetDeviceProcAddr", plain(get_device_function)},
                                       {"vkCreateInstance", plain(create_instance)},
                                       {"vkDestroyInstance", plain(destroy_instance)},
                                       {"vkCreateDevice", plain(create_device)},
                                       {"vkDestroyDevice", plain(destroy_device)},
                                       {"vkEnumerateDeviceExtensionProperties", plain(device_extensions)},
                                       {"vkGetPhysicalDeviceMemoryProperties", plain(memory_properties)},
                                       {"vkGetPhysicalDeviceMemoryProperties2", plain(memory_properties2)},
                                       {"vkGetPhysicalDeviceProperties", plain(device_properties)},
                                       {"vkGetPhysicalDeviceProperties2", plain(device_properties2)},
                                       {"vkGetPhysicalDeviceImageFormatProperties", plain(image_format)},
                                       {"vkGetPhysicalDeviceImageFormatProperties2", plain(image_format2)},
                                       {"vkAllocateMemory", plain(allocate_memory)},
                                       {"vkMapMemory", plain(map_memory)}}) {
    own[name] = function;
  }
  return own;
}

/// This layer's function; null: it passes the function on.
PFN_vkVoidFunction own_function(std::string_view name) {
  static const Functions own = make_own_functions();
  const auto found = own.find(name);
  return found == own.end() ? nullptr : found->second;
}

// A function that the driver does not have is not there.
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name) {
  const PFN_vkVoidFunction next = device_of(device)->get(device, name);
  const PFN_vkVoidFunction own = own_function(name);
  return next != nullptr && own != nullptr ? own : next;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction own = own_function(name);
  if (instance == VK_NULL_HANDLE) return own;
  const PFN_vkVoidFunction next = instance_of(instance)->get(instance, name);
  return next != nullptr && own != nullptr ? own : next;
}

}  // namespace
}  // namespace simvis::faults

extern "C" {

#define SIMVIS_EXPORTED __attribute__((visibility("default")))

SIMVIS_EXPORTED VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = simvis::faults::get_instance_function;
  version->pfnGetDeviceProcAddr = simvis::faults::get_device_function;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}

// For tests in the same process.

/// The number of devices that exist.
SIMVIS_EXPORTED std::size_t simvis_faults_devices() { return simvis::faults::device_count(); }

/// What has happened to the instances and devices that have ended since simvis_faults_forget().
SIMVIS_EXPORTED std::uint64_t simvis_faults_calls(std::size_t command) {
  return simvis::faults::history().calls[command];
}
SIMVIS_EXPORTED std::uint64_t simvis_faults_failed() { return simvis::faults::history().failed; }
SIMVIS_EXPORTED std::uint64_t simvis_faults_left() { return simvis::faults::history().left; }
SIMVIS_EXPORTED std::uint64_t simvis_faults_unknown() { return simvis::faults::history().unknown; }
SIMVIS_EXPORTED void simvis_faults_forget() { simvis::faults::forget_history(); }
}
