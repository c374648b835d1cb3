#include "simvis/lazy_device.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/base/cache_file.h"

namespace simvis {
namespace {

// A folder that does not exist or cannot be read has none.
bool has_name_with(const std::filesystem::path& folder, std::string_view prefix) {
  std::error_code none;
  const std::filesystem::directory_iterator entries(folder, none);
  return std::any_of(begin(entries), end(entries), [prefix](const std::filesystem::directory_entry& entry) {
    return entry.path().filename().string().starts_with(prefix);
  });
}

}  // namespace

bool has_gpu_node(const std::filesystem::path& dev) {
  return has_name_with(dev / "dri", "renderD") || has_name_with(dev, "nvidia") || has_name_with(dev, "nvhost") ||
         has_name_with(dev, "dxg");
}

LazyDevice::LazyDevice(DeviceDesc desc, unsigned threads) : desc_(std::move(desc)), threads_(threads) {
  if (!desc_.select.empty() || desc_.instrumented) open();
}

Device& LazyDevice::open() {
  if (!device_) device_.emplace(desc_, threads_);
  return *device_;
}

std::unique_ptr<RayCaster> LazyDevice::host_caster() const {
  return make_host_ray_caster(cache_folder(desc_.cache_dir), threads_);
}

std::unique_ptr<RayCaster> LazyDevice::caster() {
  return device_ || has_gpu_node() ? make_ray_caster(open()) : host_caster();
}

}  // namespace simvis
