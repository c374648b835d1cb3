#include "simvis/device_costs.h"

#include <memory>
#include <mutex>

#include <simvis/ray_caster.h>
#include <simvis/version.h>

namespace simvis {

const CostModel& DeviceCosts::of(const SensorType& type) {
  if (!costs_) {
    // Simulations that measure at the same time would disturb each other. With a cache, one measurement serves all.
    Device& device = device_.open();
    static std::mutex measuring;
    const std::lock_guard lock(measuring);
    const std::filesystem::path file = cost_model_file(device, cache_, version());
    costs_ = load_cost_model(file);
    const std::unique_ptr<RayCaster> rays = make_ray_caster(device);
    if (!costs_) costs_ = save_cost_model(file, type.measure_costs(device, *rays));
  }
  return *costs_;
}

}  // namespace simvis
