#include "simvis/sharing/serving.h"

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <new>
#include <utility>

#include <simvis/error.h>
#include "engine/base/now_ns.h"

namespace simvis {
namespace {

// Not every client can wake the host: what a Python client says is looked for so often.
constexpr std::int64_t kReadyPoll_ns = 1'000'000;

}  // namespace

Serving::Serving(const ServeDesc& desc, const BuiltScene& scene)
    : desc_(desc), folders_(desc.folders), host_(desc.name, desc.group ? SharedAccess::group : SharedAccess::user) {
  if (!(desc.lockstep_timeout_s > 0)) {
    throw InputError("the time limit of lock-step is " + format_number(desc.lockstep_timeout_s) +
                     " s, expected a number above 0");
  }
  follow_scene(scene);
  host_.publish();
}

// Publishes elements and sensors that were added or removed since the last call.
void Serving::follow_scene(const BuiltScene& scene) {
  follow_elements(scene.parameters);
  follow_sensors(scene);
  const std::vector<std::string>& changes = scene.parameters.changes();
  for (; changes_ < changes.size(); ++changes_) host_.log(SIMVIS_CHANGE, changes[changes_]);
}

void Serving::follow_elements(const Parameters& parameters) {
  const std::vector<ElementDescriptor>& elements = parameters.elements();
  if (changes_ == parameters.changes().size()) return;
  for (std::size_t i = removed_.size(); i < elements.size(); ++i) {
    std::vector<SharedParameter> shared;
    for (std::size_t p = 0; p < elements[i].parameters.size(); ++p) {
      const AttributeSpec& spec = elements[i].parameters[p];
      values_.push_back(parameters.values()[elements[i].first_value + p]);
      shared.push_back({spec.name, spec.unit, spec.min, spec.max, spec.open_min, spec.open_max, values_.back()});
    }
    host_.add_element(elements[i].name, elements[i].type, elements[i].insertion_point, shared);
    removed_.push_back(false);
  }
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i].removed && !removed_[i]) host_.remove_element(i);
    removed_[i] = elements[i].removed;
  }
}

void Serving::follow_sensors(const BuiltScene& scene) {
  std::erase_if(sensors_, [&](const auto& known) {
    const bool removed = std::ranges::count(scene.sensors, known.first, &BuiltSensor::id) == 0;
    if (removed) host_.remove_sensor(known.second);
    return removed;
  });
  for (const BuiltSensor& sensor : scene.sensors) {
    if (!sensors_.contains(sensor.id)) sensors_.emplace(sensor.id, host_.add_sensor(sensor.name, sensor.type));
  }
}

void Serving::execute(const ChangeRequest& request, const BuiltScene& scene, const Execute& execute) {
  const std::string name = "request " + std::to_string(request.number);
  try {
    folders_.carry_out([&] { execute(folders_.parse(request.text, name)); });
    follow_scene(scene);
    host_.log(SIMVIS_REQUEST_DONE, "", request.client, request.number);
  } catch (const Error& error) {  // of the machine too: a client's file that takes too long does not end the run
    host_.log(SIMVIS_REQUEST_REFUSED, without_file_content(error.what(), request.text), request.client, request.number);
  } catch (const std::bad_alloc&) {
    host_.log(SIMVIS_REQUEST_REFUSED, kNoMemoryForRequest, request.client, request.number);
  }
}

// A client that writes nonsense in each frame does not fill the log.
void Serving::refuse_value(const std::string& why, std::uint32_t client) {
  constexpr int kLoggedPerFrame = 16;
  if (++refused_values_ > kLoggedPerFrame) return;
  host_.log(SIMVIS_VALUE_REFUSED, refused_values_ < kLoggedPerFrame ? why : why + "; more of this frame are not logged",
            client);
}

void Serving::set(Parameters& parameters, const WrittenValue& written) {
  if (parameters.is_removed(written.parameter)) return;
  const double before = values_[written.parameter];
  values_[written.parameter] = written.value;
  try {
    parameters.set(written.parameter, written.value);
    take_over(parameters, written.parameter);
  } catch (const InputError& error) {
    refuse_value(error.what(), 0);
    values_[written.parameter] = before;
    host_.set_value(written.parameter, before);
  }
}

// All values of an element, or none.
void Serving::set(Parameters& parameters, const WrittenElement& written) {
  const std::size_t first = parameters.elements()[written.element].first_value;
  for (std::size_t i = 0; i < written.values.size(); ++i) {
    const std::string wrong = check_number(parameters.spec(first + i), written.values[i]);
    if (wrong.empty()) continue;
    return refuse_value(parameters.name(first + i) + ": " + wrong, written.client);
  }
  for (std::size_t i = 0; i < written.values.size(); ++i) {
    parameters.set(first + i, written.values[i]);
    take_over(parameters, first + i);
  }
}

// A value may differ from the one that was written: a joint takes a value beyond its limit by rounding as the limit.
void Serving::take_over(const Parameters& parameters, std::size_t parameter) {
  const double value = parameters.values()[parameter];
  if (value == values_[parameter]) return;
  values_[parameter] = value;
  host_.set_value(parameter, value);
}

void Serving::follow_values(const Parameters& parameters) {
  for (std::size_t i = 0; i < values_.size(); ++i) take_over(parameters, i);
}

void Serving::take(BuiltScene& scene, const Execute& execute_commands) {
  follow_scene(scene);
  follow_values(scene.parameters);
  refused_values_ = 0;
  const ClientInputs inputs = host_.take();
  for (const ChangeRequest& request : inputs.requests) execute(request, scene, execute_commands);
  for (const WrittenValue& written : inputs.values) set(scene.parameters, written);
  for (const WrittenElement& written : inputs.elements) set(scene.parameters, written);
}

void Serving::publish(const PlacedSensor& placed, const FrameTime& time) {
  const BuiltSensor& sensor = placed.sensor;
  const std::vector<NumberOnRequest> on_request = sensor.sensor->on_request();
  std::span<const MeasuredArray> arrays = placed.measurement->arrays;
  std::vector<MeasuredArray> with_requested;
  if (!on_request.empty()) {
    with_requested.assign(arrays.begin(), arrays.end());
    for (const NumberOnRequest& each : on_request) {
      with_requested.push_back({{.name = each.name, .unit = each.unit}, SharedArray<double>{each.compute()}});
    }
    arrays = with_requested;
  }
  host_.publish(sensors_.at(sensor.id), time.index, placed.measurement->time_ns,
                {glm::value_ptr(placed.measurement->world_from_sensor), 16}, arrays);
}

void Serving::frame(const Frame& frame) {
  for (const PlacedSensor& placed : frame.sensors) {
    if (placed.measurement != nullptr) publish(placed, frame.time);
  }
  follow_scene(frame.scene);
  host_.finish_frame(frame.time.index + 1, frame.time.time_ns);
}

void Serving::wait_for_clients(const FrameTime& time) {
  const std::int64_t end_ns = now_ns() + limited_ns(desc_.lockstep_timeout_s);
  for (const std::string& client : desc_.lockstep) {
    for (;;) {
      const std::uint32_t seen = host_.ready_counter();
      if (host_.is_ready(client, time.index)) break;
      const std::int64_t now = now_ns();
      if (now >= end_ns) {
        throw MachineError("client " + in_quotes(client) +
                           (host_.is_connected(client) ? " is not ready" : " is not connected") + " for frame " +
                           std::to_string(time.index) + " after " + format_number(desc_.lockstep_timeout_s) + " s");
      }
      host_.wait_for_ready(seen, std::min(end_ns - now, kReadyPoll_ns));
    }
  }
}

}  // namespace simvis
