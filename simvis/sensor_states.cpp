#include "simvis/sensor_states.h"

#include <algorithm>
#include <utility>

#include <simvis/error.h>
#include <simvis/location.h>
#include "sensors/output_check.h"
#include "sensors/sensor_state.h"

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
  const auto is_gone = [&](const auto& each) { return std::ranges::count(built, each.first, &BuiltSensor::id) == 0; };
  std::erase_if(shown, is_gone);
  std::erase_if(restored, is_gone);
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
  const std::string different =
      measurement_difference(*built[i].sensor, now, built[i].outputs, state.frames > 0 && state.has_measured);
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
  return own_scan(i);
}

ObservedScan SensorStates::own_scan(std::size_t i) const {
  if (all[i].frames == 0) return {};
  const auto found = restored.find(all[i].sensor);
  const bool is_restored = found != restored.end() && found->second.frames == all[i].frames;
  const Scan* const scan = is_restored ? &found->second.scan : built[i].sensor->scan();
  return {scan, scan == nullptr ? all[i].world_from_sensor : scan->world_from_sensor, all[i].frames};
}

void SensorStates::archive_scans(StateArchive& state) {
  if (state.is_reading()) restored.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool has_scan = built[i].sensor->scan() != nullptr && all[i].frames > 0;
    if (!has_scan || built[i].delayed != nullptr) continue;  // what has arrived is a part of the sensor's own state
    Measurement measurement = *own_scan(i).scan;
    archive_measurement(state, measurement);
    if (!state.is_reading()) continue;
    std::optional<Scan> scan = to_scan(std::move(measurement));
    state.require(scan.has_value());
    require_scan(state, *scan);
    restored.emplace(all[i].sensor, RestoredScan{*std::move(scan), all[i].frames});
  }
}

void SensorStates::begin_frame() {
  measured.clear();
  costs.clear();
}

void SensorStates::add_measured(std::size_t i) {
  ++all[i].frames;
  all[i].has_measured = true;
  measured.push_back(built[i].name);
}

void SensorStates::discard_frame() {
  for (const std::string& sensor : measured) --all[index(sensor)].frames;
  begin_frame();
}

}  // namespace simvis
