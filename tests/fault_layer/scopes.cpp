#include "tests/fault_layer/scopes.h"

#include <map>
#include <mutex>
#include <utility>

namespace simvis::faults {
namespace {

using Key = void*;
Key key_of(const void* handle) { return *static_cast<void* const*>(handle); }

template <typename Held>
class Scopes {
 public:
  std::shared_ptr<Held> of(const void* handle) const {
    const std::lock_guard lock(mutex_);
    return held_.at(key_of(handle));
  }
  void add(const void* handle, std::shared_ptr<Held> scope) {
    const std::lock_guard lock(mutex_);
    held_[key_of(handle)] = std::move(scope);
  }
  std::shared_ptr<Held> take(const void* handle) {
    const std::lock_guard lock(mutex_);
    return held_.extract(key_of(handle)).mapped();
  }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return held_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::map<Key, std::shared_ptr<Held>> held_;
};

Scopes<InstanceScope> instances;
Scopes<DeviceScope> devices;

}  // namespace

std::unique_ptr<MemoryModel> InstanceScope::memory_model(VkPhysicalDevice device) const {
  VkPhysicalDeviceMemoryProperties driver_memory;
  memory(device, &driver_memory);
  VkPhysicalDeviceProperties driver;
  properties(device, &driver);
  return std::make_unique<MemoryModel>(settings, driver_memory, driver.limits);
}

std::shared_ptr<InstanceScope> instance_of(const void* handle) { return instances.of(handle); }
std::shared_ptr<DeviceScope> device_of(const void* handle) { return devices.of(handle); }
void add_instance(const void* handle, std::shared_ptr<InstanceScope> scope) { instances.add(handle, std::move(scope)); }
void add_device(const void* handle, std::shared_ptr<DeviceScope> scope) { devices.add(handle, std::move(scope)); }
std::shared_ptr<InstanceScope> take_instance(const void* handle) { return instances.take(handle); }
std::shared_ptr<DeviceScope> take_device(const void* handle) { return devices.take(handle); }
std::size_t device_count() { return devices.size(); }

}  // namespace simvis::faults
