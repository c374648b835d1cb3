// A Vulkan layer that makes calls fail. It stands between a program and the driver:
//
//   VK_ADD_LAYER_PATH=FOLDER VK_INSTANCE_LAYERS=VK_LAYER_SIMVIS_faults SIMVIS_FAULT=vkWaitForFences:3:VK_TIMEOUT
//
// SIMVIS_FAULT is FUNCTION:CALL:RESULT and is read when a device is created. Call CALL of FUNCTION on that device,
// counted from 1, returns RESULT and does not reach the driver; with CALL+ all later calls fail too. Without the
// variable calls are only passed on.
//
// A lost device stays lost: after VK_ERROR_DEVICE_LOST all functions below that may return it do so. What was submitted
// before is still worked on, as by a driver that reports a loss before the device stops; vkDeviceWaitIdle waits for it.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace {

struct Fault {
  std::string function;
  std::uint64_t call = 0;
  bool lasting = false;  // later calls fail too
  VkResult result = VK_SUCCESS;
};

constexpr std::pair<std::string_view, VkResult> kResults[] = {
    {"VK_TIMEOUT", VK_TIMEOUT},
    {"VK_ERROR_DEVICE_LOST", VK_ERROR_DEVICE_LOST},
    {"VK_ERROR_OUT_OF_HOST_MEMORY", VK_ERROR_OUT_OF_HOST_MEMORY},
    {"VK_ERROR_OUT_OF_DEVICE_MEMORY", VK_ERROR_OUT_OF_DEVICE_MEMORY}};

// The fault of the environment. A text that is no fault ends the program: a test without it would test nothing.
std::optional<Fault> wanted_fault() {
  const char* const text = std::getenv("SIMVIS_FAULT");
  if (text == nullptr) return {};
  const std::string_view all = text;
  const std::size_t first = all.find(':'), second = all.find(':', first + 1);
  if (second == std::string_view::npos) std::abort();
  Fault fault{.function = std::string(all.substr(0, first))};
  const std::string_view call = all.substr(first + 1, second - first - 1);
  const auto [end, error] = std::from_chars(call.data(), call.data() + call.size(), fault.call);
  fault.lasting = std::string_view(end, static_cast<std::size_t>(call.data() + call.size() - end)) == "+";
  for (const auto& [name, result] : kResults) {
    if (all.substr(second + 1) == name) fault.result = result;
  }
  if (error != std::errc() || fault.call == 0 || fault.result == VK_SUCCESS) std::abort();
  return fault;
}

/// The functions of the next layer or the loader. They are asked for when the instance is created: later the loader
/// returns those of the first layer.
struct InstanceCalls {
  PFN_vkGetInstanceProcAddr get;
  PFN_vkDestroyInstance destroy;
};

/// The functions of the next layer or the driver.
struct DeviceCalls {
  PFN_vkGetDeviceProcAddr get;
  PFN_vkDestroyDevice destroy;
  PFN_vkQueueSubmit submit;
  PFN_vkWaitForFences wait;
  PFN_vkGetFenceStatus fence_status;
  PFN_vkDeviceWaitIdle wait_idle;
  PFN_vkGetQueryPoolResults query_results;
};

struct LayerDevice {
  DeviceCalls next;
  std::optional<Fault> fault;
  std::atomic<std::uint64_t> calls = 0;  // of the function that is to fail
  std::atomic<bool> lost = false;

  /// What a call of the function returns instead of reaching the driver; empty: it reaches it.
  std::optional<VkResult> failure(std::string_view function) {
    if (fault && fault->function == function) {
      const std::uint64_t call = ++calls;
      if (call == fault->call || (fault->lasting && call > fault->call)) {
        if (fault->result == VK_ERROR_DEVICE_LOST) lost = true;
        return fault->result;
      }
    }
    return lost ? std::optional(VK_ERROR_DEVICE_LOST) : std::nullopt;
  }
};

// The loader's table is the first member of each dispatchable object, and the same for all objects of a device.
using Key = void*;
Key key_of(const void* handle) { return *static_cast<void* const*>(handle); }

std::mutex mutex;  // protects the two maps
std::map<Key, InstanceCalls> instances;
std::map<Key, std::shared_ptr<LayerDevice>> devices;

std::shared_ptr<LayerDevice> device_of(const void* handle) {
  const std::lock_guard lock(mutex);
  return devices.at(key_of(handle));
}

template <typename Function>
Function as(PFN_vkVoidFunction function) {
  return reinterpret_cast<Function>(function);
}

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

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* memory,
                                               VkInstance* instance) {
  const auto get = next_link<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO)
                       ->pfnNextGetInstanceProcAddr;
  const VkResult result = as<PFN_vkCreateInstance>(get(nullptr, "vkCreateInstance"))(info, memory, instance);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(mutex);
  instances[key_of(*instance)] = {.get = get,
                                  .destroy = as<PFN_vkDestroyInstance>(get(*instance, "vkDestroyInstance"))};
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* memory) {
  if (instance == VK_NULL_HANDLE) return;
  PFN_vkDestroyInstance destroy = nullptr;
  {
    const std::lock_guard lock(mutex);
    destroy = instances.extract(key_of(instance)).mapped().destroy;
  }
  destroy(instance, memory);
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* memory, VkDevice* device) {
  const auto* const link = next_link<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  const auto create = as<PFN_vkCreateDevice>(link->pfnNextGetInstanceProcAddr(VK_NULL_HANDLE, "vkCreateDevice"));
  const PFN_vkGetDeviceProcAddr get = link->pfnNextGetDeviceProcAddr;
  const VkResult result = create(physical, info, memory, device);
  if (result != VK_SUCCESS) return result;
  auto made = std::make_shared<LayerDevice>();
  made->next = {.get = get,
                .destroy = as<PFN_vkDestroyDevice>(get(*device, "vkDestroyDevice")),
                .submit = as<PFN_vkQueueSubmit>(get(*device, "vkQueueSubmit")),
                .wait = as<PFN_vkWaitForFences>(get(*device, "vkWaitForFences")),
                .fence_status = as<PFN_vkGetFenceStatus>(get(*device, "vkGetFenceStatus")),
                .wait_idle = as<PFN_vkDeviceWaitIdle>(get(*device, "vkDeviceWaitIdle")),
                .query_results = as<PFN_vkGetQueryPoolResults>(get(*device, "vkGetQueryPoolResults"))};
  made->fault = wanted_fault();
  const std::lock_guard lock(mutex);
  devices[key_of(*device)] = std::move(made);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* memory) {
  if (device == VK_NULL_HANDLE) return;
  std::shared_ptr<LayerDevice> ended;
  {
    const std::lock_guard lock(mutex);
    ended = devices.extract(key_of(device)).mapped();
  }
  ended->next.destroy(device, memory);
}

VKAPI_ATTR VkResult VKAPI_CALL queue_submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* infos,
                                            VkFence fence) {
  const auto device = device_of(queue);
  if (const auto failure = device->failure("vkQueueSubmit")) return *failure;
  return device->next.submit(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_for_fences(VkDevice handle, std::uint32_t count, const VkFence* fences,
                                               VkBool32 all, std::uint64_t timeout_ns) {
  const auto device = device_of(handle);
  if (const auto failure = device->failure("vkWaitForFences")) return *failure;
  return device->next.wait(handle, count, fences, all, timeout_ns);
}

VKAPI_ATTR VkResult VKAPI_CALL get_fence_status(VkDevice handle, VkFence fence) {
  const auto device = device_of(handle);
  if (const auto failure = device->failure("vkGetFenceStatus")) return *failure;
  return device->next.fence_status(handle, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL device_wait_idle(VkDevice handle) {
  const auto device = device_of(handle);
  const auto failure = device->failure("vkDeviceWaitIdle");
  const VkResult waited = device->next.wait_idle(handle);
  return failure.value_or(waited);
}

VKAPI_ATTR VkResult VKAPI_CALL get_query_pool_results(VkDevice handle, VkQueryPool pool, std::uint32_t first,
                                                      std::uint32_t count, std::size_t bytes, void* data,
                                                      VkDeviceSize stride, VkQueryResultFlags flags) {
  const auto device = device_of(handle);
  if (const auto failure = device->failure("vkGetQueryPoolResults")) return *failure;
  return device->next.query_results(handle, pool, first, count, bytes, data, stride, flags);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name);
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance, const char* name);

template <typename Function>
PFN_vkVoidFunction plain(Function function) {
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}

PFN_vkVoidFunction own_function(std::string_view name) {
  const std::pair<std::string_view, PFN_vkVoidFunction> kOwn[] = {
      {"vkGetInstanceProcAddr", plain(get_instance_function)},
      {"vkGetDeviceProcAddr", plain(get_device_function)},
      {"vkCreateInstance", plain(create_instance)},
      {"vkDestroyInstance", plain(destroy_instance)},
      {"vkCreateDevice", plain(create_device)},
      {"vkDestroyDevice", plain(destroy_device)},
      {"vkQueueSubmit", plain(queue_submit)},
      {"vkWaitForFences", plain(wait_for_fences)},
      {"vkGetFenceStatus", plain(get_fence_status)},
      {"vkDeviceWaitIdle", plain(device_wait_idle)},
      {"vkGetQueryPoolResults", plain(get_query_pool_results)}};
  for (const auto& [own, function] : kOwn) {
    if (own == name) return function;
  }
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name) {
  if (const PFN_vkVoidFunction own = own_function(name)) return own;
  return device_of(device)->next.get(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance, const char* name) {
  if (const PFN_vkVoidFunction own = own_function(name)) return own;
  if (instance == VK_NULL_HANDLE) return nullptr;
  PFN_vkGetInstanceProcAddr get = nullptr;
  {
    const std::lock_guard lock(mutex);
    get = instances.at(key_of(instance)).get;
  }
  return get(instance, name);
}

}  // namespace

extern "C" {

__attribute__((visibility("default"))) VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = get_instance_function;
  version->pfnGetDeviceProcAddr = get_device_function;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}

/// The number of devices that exist, for tests in the same process.
__attribute__((visibility("default"))) std::size_t simvis_faults_devices() {
  const std::lock_guard lock(mutex);
  return devices.size();
}
}
