#include "simvis/sensor_states.h"

#include <algorithm>
#include <utility>

#include <simvis/error.h>
#include <simvis/location.h>
#include "sensors/output_check.h"

namespace simvis {

bool SensorStates::follow(const std::function<void(const BuiltSensor&)>& added) {
  std::vector<SensorState> before = std::exchange(all, {});
  auto known = before.begin();  // both are in the order of ids
  bool removed = false;
  for (const BuiltSensor& sensor : built) {
    for (; known != before.end() && known->sensor < sensor.id; ++known) removed = true;
    if (known != before.end() && known->sensor == sensor.id) {
      all.push_back(std::move(*known++));
    } else {
      all.emplace_back().sensor = sensor.id;
      added(sensor);
    }
  }
  if (!removed && known == before.end()) return false;
  std::erase_if(shown, [&](const auto& each) { return std::ranges::count(built, each.first, &BuiltSensor::id) == 0; });
  return true;
}

std::size_t SensorStates::index(std::string_view name) const {
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < built.size(); ++i) {
    if (built[i].name == name) return i;
    known.push_back(built[i].name);
  }
  throw InputError("there is no sensor \"" + std::string(name) + "\"" + suggestion(name, known));
}

std::vector<double> SensorStates::rates() const {
  std::vector<double> rates;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double rate = built[i].sensor->rate_hz;
    if (all[i].enabled && rate > 0) rates.push_back(rate);
  }
  return rates;
}

const Measurement& SensorStates::measurement(std::size_t i) {
  SensorState& state = all[i];
  if (state.measurement) return *state.measurement;
  Measurement now = built[i].sensor->measurement();
  const std::string different = measurement_difference(*built[i].sensor, now, built[i].outputs, state.frames > 0);
  if (!different.empty()) {
    fail_at(built[i].command.where, "sensor " + in_quotes(built[i].name) + ": " + different);
  }
  describe(now, built[i].outputs);
  return state.measurement.emplace(std::move(now));
}

ObservedScan SensorStates::scan(std::string_view name) const {
  const std::size_t i = index(name);
  const auto found = shown.find(all[i].sensor);
  if (found != shown.end()) {
    return {&found->second.scan, found->second.scan.world_from_sensor, found->second.count};
  }
  if (all[i].frames == 0) return {};
  const Scan* const scan = built[i].sensor->scan();
  return {scan, scan == nullptr ? all[i].world_from_sensor : scan->world_from_sensor, all[i].frames};
}

void SensorStates::begin_frame() {
  measured.clear();
  costs.clear();
}

void SensorStates::add_measured(std::size_t i) {
  ++all[i].frames;
  measured.push_back(built[i].name);
}

void SensorStates::discard_frame() {
  for (const std::string& sensor : measured) --all[index(sensor)].frames;
  begin_frame();
}

}  // namespace simvis
