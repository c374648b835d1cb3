// The costs of methods on a device, for sensors that choose one.
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include <simvis/cost_model.h>
#include <simvis/sensor_type.h>
#include "simvis/lazy_device.h"

namespace simvis {

class DeviceCosts {
 public:
  /// `cache` is a folder; empty: nothing is cached. The device outlives this object.
  DeviceCosts(LazyDevice& device, std::filesystem::path cache) : device_(device), cache_(std::move(cache)) {}

  /// Read from the cache, or measured, at the first call.
  const CostModel& of(const SensorType& type);

 private:
  LazyDevice& device_;
  std::filesystem::path cache_;
  std::optional<CostModel> costs_;
};

}  // namespace simvis
