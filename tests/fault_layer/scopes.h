// The instances and devices that exist, each with the functions of the next layer or the driver.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <memory>

#include "tests/fault_layer/call_counts.h"
#include "tests/fault_layer/memory_model.h"
#include "tests/fault_layer/object_table.h"
#include "tests/fault_layer/settings.h"

namespace simvis::faults {

template <typename Function>
Function as(PFN_vkVoidFunction function) {
  return reinterpret_cast<Function>(function);
}

/// What instances and devices have in common.
struct Scope {
  explicit Scope(Settings wanted) : settings(std::move(wanted)), calls(settings.faults) {}
  const Settings settings;
  CallCounts calls;
  std::array<PFN_vkVoidFunction, kCommandCount> next{};  // of kCommands; null: not there
};

/// Physical devices are of the scope of their instance.
struct InstanceScope : Scope {
  using Scope::Scope;
  // They are asked for when the instance is created: later the loader returns those of the first layer.
  PFN_vkGetInstanceProcAddr get = nullptr;
  PFN_vkDestroyInstance destroy = nullptr;
  PFN_vkGetPhysicalDeviceMemoryProperties memory = nullptr;
  PFN_vkGetPhysicalDeviceProperties properties = nullptr;
  PFN_vkGetPhysicalDeviceMemoryProperties2 memory2 = nullptr;
  PFN_vkGetPhysicalDeviceProperties2 properties2 = nullptr;

  /// What the program sees of the device.
  std::unique_ptr<MemoryModel> memory_model(VkPhysicalDevice device) const;
};

struct DeviceScope : Scope {
  using Scope::Scope;
  PFN_vkGetDeviceProcAddr get = nullptr;
  PFN_vkDestroyDevice destroy = nullptr;
  std::unique_ptr<MemoryModel> memory;
  ObjectTable objects;
};

// The loader's table is the first member of each dispatchable object, and the same for all objects of an instance or a
// device.
std::shared_ptr<InstanceScope> instance_of(const void* handle);
std::shared_ptr<DeviceScope> device_of(const void* handle);
void add_instance(const void* handle, std::shared_ptr<InstanceScope> scope);
void add_device(const void* handle, std::shared_ptr<DeviceScope> scope);
std::shared_ptr<InstanceScope> take_instance(const void* handle);
std::shared_ptr<DeviceScope> take_device(const void* handle);
std::size_t device_count();

/// The scope that counts calls with this first parameter.
inline std::shared_ptr<InstanceScope> scope_of(VkInstance handle) { return instance_of(handle); }
inline std::shared_ptr<InstanceScope> scope_of(VkPhysicalDevice handle) { return instance_of(handle); }
inline std::shared_ptr<DeviceScope> scope_of(VkDevice handle) { return device_of(handle); }
inline std::shared_ptr<DeviceScope> scope_of(VkQueue handle) { return device_of(handle); }
inline std::shared_ptr<DeviceScope> scope_of(VkCommandBuffer handle) { return device_of(handle); }

}  // namespace simvis::faults
