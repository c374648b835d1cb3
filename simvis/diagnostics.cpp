#include <simvis/diagnostics.h>

#include "simvis/simulation_impl.h"

namespace simvis {

const Command& Diagnostics::command(std::string_view sensor) const { return impl_->sensor(sensor).command; }

const DeviceInfo* Diagnostics::device() const {
  const Device* const device = impl_->device.opened();
  return device == nullptr ? nullptr : &device->info();
}

std::span<const std::filesystem::path> Diagnostics::inputs() const { return impl_->inputs.files; }

const std::map<std::string, std::optional<std::string>>& Diagnostics::environment() const {
  return impl_->inputs.environment;
}
const FrameCounters& Diagnostics::counters() const { return impl_->idle().sensing.counters(); }
RayCounters Diagnostics::ray_counters() const { return impl_->idle().sensing.caster->counters(); }
std::uint64_t Diagnostics::motions_followed() const { return impl_->idle().sensed.motions(); }
const DrawList& Diagnostics::draw_list() const { return *impl_->idle().sensing.list; }
const FramePlan& Diagnostics::frame_plan() const { return impl_->idle().sensing.complete_plan(); }
std::vector<PlannedSensor> Diagnostics::planned_sensors() const {
  return impl_->idle().sensing.planned_sensors(impl_->scene.built.sensors);
}
const FrameCosts* Diagnostics::frame_costs() const { return impl_->idle().sensing.costs(); }

const FramePlan* Diagnostics::visualization_plan() const {
  return impl_->idle().visualization ? &impl_->visualization->complete_plan() : nullptr;
}

std::vector<PlannedSensor> Diagnostics::visualization_sensors() const {
  if (!impl_->idle().visualization) return {};
  return impl_->visualization->planned_sensors(impl_->scene.built.sensors);
}

const FrameCounters* Diagnostics::visualization_counters() const {
  return impl_->idle().visualization ? &impl_->visualization->counters() : nullptr;
}

const FrameCosts* Diagnostics::visualization_costs() const {
  return impl_->idle().visualization ? impl_->visualization->costs() : nullptr;
}

std::span<const SensorCost> Diagnostics::sensor_costs() const { return impl_->idle().sensors.costs; }
std::uint64_t Diagnostics::device_memory_bytes() const {
  const Device* const device = impl_->idle().device.opened();
  return device == nullptr ? 0 : device->memory_bytes();
}

std::span<const StageTime> Diagnostics::stages() const { return impl_->idle().stages.times(); }
std::uint64_t Diagnostics::validation_messages() const {
  const Device* const device = impl_->device.opened();
  return device == nullptr ? 0 : device->validation_messages();
}

}  // namespace simvis
