#include <simvis/device.h>

#include "engine/vulkan/device_impl.h"
#include "engine/vulkan/found_device.h"

namespace simvis {

std::vector<DeviceInfo> list_devices() { return infos(find_devices(wants_validation({}), bundled_driver())); }

Device::Device(const DeviceDesc& desc, unsigned threads) : impl_(std::make_unique<DeviceImpl>(desc, threads)) {}
Device::~Device() = default;
const DeviceInfo& Device::info() const { return impl_->physical.info; }
bool Device::is_cpu() const { return impl_->physical.is_cpu(); }
const TargetLimits& Device::target_limits() const { return impl_->physical.targets; }
std::uint64_t Device::memory_bytes() const { return impl_->memory_bytes; }
std::uint64_t Device::validation_messages() const {
  return impl_->shared->instance().messages() - impl_->messages_before;
}

}  // namespace simvis
