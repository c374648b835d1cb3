// What a step warns of: data that is complete and yet not what its user expects.
#include <algorithm>
#include <cmath>
#include <optional>

#include <simvis/attributes.h>
#include <simvis/effect.h>
#include "engine/splats/seen_splats.h"
#include "simvis/simulation_impl.h"
#include "simvis/time/frame_rates.h"

namespace simvis {
namespace {

Location place_of(const BuiltSensor& sensor, std::string_view attribute) {
  const CommandAttribute* const written = sensor.command.find(attribute);
  return written == nullptr ? sensor.command.where : written->where;
}

std::string rate_warning(const std::string& sensor, double rate_hz, double frames_hz, std::span<const double> rates) {
  const std::string frames = format_number(frames_hz), rate = format_number(rate_hz);
  const std::optional<double> fitting = common_multiple(rates);
  return "sensor " + in_quotes(sensor) + " is due " + rate + " times a second, but frames come " + frames +
         (rate_hz > frames_hz ? " times, so it measures once in each frame"
                              : " times, so it measures at the next frame and its intervals differ") +
         "; expected " + (fitting ? "--rate " + format_number(*fitting) + " or " : "") + "--rate auto";
}

// The first image of depth; empty if the sensor gives none.
std::optional<SharedArray<float>> depths_of(const Measurement& measurement) {
  const auto depth = std::ranges::find(measurement.arrays, ImageContent::depth, &MeasuredArray::content);
  if (depth == measurement.arrays.end()) return std::nullopt;
  return std::get<SharedArray<float>>(depth->numbers);
}

bool all_infinite(std::span<const float> values) {
  return std::ranges::all_of(values, [](float value) { return std::isinf(value); });
}

// Whether beams end before the smallest range, and none measures.
bool all_blocked(std::span<const float> ranges_m) {
  return std::ranges::any_of(ranges_m, [](float range_m) { return range_m <= 0; }) &&
         std::ranges::all_of(ranges_m, [](float range_m) { return range_m <= 0 || std::isinf(range_m); });
}

}  // namespace

// Warnings belong to no command, so that no command takes them back.
void SimulationImpl::warn(const std::string& warning) {
  scene.built.scene.warn(warning);
  scene.built.scene.undo().commit();
}

void SimulationImpl::warn_before_measuring() {
  if (sensors.all.empty())
    warn(scene.built.name + ": the scene has no sensor, so nothing is measured; expected a sensor command");
  if (desc.frames_when_due || timeline.is_stretched()) return;
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
    const BuiltSensor& sensor = scene.built.sensors[i];
    if (!sensors.all[i].enabled || sensors.all[i].rate_checked) continue;
    sensors.all[i].rate_checked = true;
    const double rate = sensor.sensor->rate_hz;
    if (rate == 0 || is_multiple(desc.rate_hz, rate)) continue;
    warn(to_string(place_of(sensor, kRateAttribute.name)) + ": " +
         rate_warning(sensor.name, rate, desc.rate_hz, sensors.rates()));
  }
}

// Once for each sensor that draws or casts.
void SimulationImpl::warn_of_unseen_splats(const ViewLayer& layer) {
  for (const ViewLayer::Entry& entry : layer.entries) {
    if (entry.due_state != DueState::due || sensors.all[entry.sensor].frames > 1) continue;
    const BuiltSensor& sensor = scene.built.sensors[entry.sensor];
    if (entry.end_pass == entry.first_pass && entry.end_cast == entry.first_cast) continue;
    if ((find_sensor_type(sensor.type)->capabilities & kSeesSplats) != 0 || !has_splats(*layer.list)) continue;
    warn(to_string(sensor.command.where) + ": sensor " + in_quotes(sensor.name) +
         " does not see the Gaussian splats of the scene; cameras, stereo, RGB-D and time-of-flight cameras, laser "
         "scanners, range and distance sensors, sonars and radars do");
  }
}

// What blocks a scanner is most often its own housing or robot.
void SimulationImpl::warn_of_blocked_scan(const BuiltSensor& sensor) {
  const Scan* const scan = sensor.sensor->scan();
  if (scan == nullptr || !all_blocked(scan->range_m)) return;
  const auto blocked = std::ranges::count_if(scan->range_m, [](float range_m) { return range_m <= 0; });
  warn(to_string(sensor.command.where) + ": sensor " + in_quotes(sensor.name) +
       " measures nothing in its first frame: " + std::to_string(blocked) + " of " +
       std::to_string(scan->range_m.size()) +
       " ranges are 0, because a surface lies nearer than \"range_min\", and no other one hits anything; its attribute "
       "\"ignore\" names what it is not to see");
}

// A sensor sees nothing if all its ranges or depths are infinite, or, without both, if none of its views draws
// anything; and if it shows no splats.
void SimulationImpl::warn_of_empty_views(const ViewLayer& layer, std::span<const PassResult> results) {
  for (const ViewLayer::Entry& entry : layer.entries) {
    if (entry.due_state != DueState::due || sensors.all[entry.sensor].frames > 1) continue;
    const BuiltSensor& sensor = scene.built.sensors[entry.sensor];
    warn_of_blocked_scan(sensor);
    if (sensor.sensor->shows_splats()) continue;
    bool empty = false;
    if (const Scan* const scan = sensor.sensor->scan()) {
      empty = all_infinite(scan->range_m);
    } else if (const std::optional<SharedArray<float>> depths_m = depths_of(sensors.measurement(entry.sensor))) {
      empty = all_infinite(*depths_m);
    } else if (entry.end_pass > entry.first_pass) {
      empty = std::ranges::all_of(
          results.subspan(entry.first_pass, entry.end_pass - entry.first_pass), [](const PassResult& result) {
            return std::ranges::all_of(result.views, [](const ViewCounts& view) { return view.draws == 0; });
          });
    }
    if (!empty) continue;
    warn(to_string(sensor.command.where) + ": sensor " + in_quotes(sensor.name) +
         " sees nothing in its first frame: no surface lies within its range and field of view");
  }
}

}  // namespace simvis
