// The state of a simulation between two frames, as bytes.
#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <simvis/location.h>
#include <simvis/sensor_type.h>
#include <simvis/state_archive.h>
#include <simvis/version.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/fnv1a.h"
#include "sensors/sensor_state.h"
#include "simvis/change_log.h"
#include "simvis/simulation_impl.h"

namespace simvis {
namespace {

// A saved state begins with these letters, the number of the format and the version of SimVis, then the size and the
// hash of the rest.
constexpr std::string_view kMagic = "SimVis state\n";
constexpr std::uint32_t kFormat = 1;

std::string to_saved_state(std::string_view content) {
  std::string bytes(kMagic);
  append_binary(bytes, kFormat);
  append_binary(bytes, static_cast<std::uint32_t>(version().size()));
  bytes += version();
  append_binary(bytes, std::uint64_t{content.size()});
  append_binary(bytes, fnv1a(content));
  return bytes.append(content);
}

// Takes a number off the front of the bytes.
template <typename Number>
Number take(std::string_view& bytes) {
  if (bytes.size() < sizeof(Number)) throw InputError("the state is cut off, expected a whole one");
  const auto number = binary_at<Number>(bytes, 0);
  bytes.remove_prefix(sizeof(Number));
  return number;
}

std::string_view content_of(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) {
    throw InputError("these bytes are no state of a simulation, expected those of save_state() or --save-state");
  }
  bytes.remove_prefix(kMagic.size());
  const auto format = take<std::uint32_t>(bytes);
  const auto letters = take<std::uint32_t>(bytes);
  if (bytes.size() < letters) throw InputError("the state is cut off, expected a whole one");
  const std::string_view saved_by = bytes.substr(0, letters);
  if (format != kFormat || saved_by != version()) {
    throw InputError("the state is of format " + std::to_string(format) + " of SimVis " + std::string(saved_by) +
                     ", expected format " + std::to_string(kFormat) + " of SimVis " + std::string(version()));
  }
  bytes.remove_prefix(letters);
  const auto size = take<std::uint64_t>(bytes), hash = take<std::uint64_t>(bytes);
  if (bytes.size() < size) throw InputError("the state is cut off, expected a whole one");
  if (bytes.size() > size || fnv1a(bytes) != hash)
    throw InputError("the state is damaged, expected it as it was saved");
  return bytes;
}

void archive_frame(StateArchive& state, FrameTime& frame) {
  state(frame.index, frame.time_ns, frame.period_ns, frame.when_due);
  state.require(frame.time_ns >= 0 && frame.period_ns >= 0);
}

std::uint64_t hash_of(const SimulationDesc& desc) {
  std::uint64_t hash = fnv1a_step(fnv1a(&desc.rate_hz, sizeof desc.rate_hz), desc.seed);
  hash = fnv1a_step(fnv1a_step(hash, desc.frames_when_due ? 1 : 0), desc.elements_move ? 1 : 0);
  for (const AttributeOverride& each : desc.overrides) {
    const std::string value = each.value ? "=" + *each.value : "";  // none: the attribute is removed
    hash = fnv1a_step(hash, fnv1a(each.sensor_type + "." + each.attribute + value));
  }
  return hash;
}

// Scenes whose objects are of the same commands have the same objects, in the same order.
void archive_commands(StateArchive& state, const std::vector<std::string>& log) {
  const std::vector<std::size_t> standing = standing_commands(log);
  std::vector<std::uint64_t> hashes;
  hashes.reserve(standing.size());
  for (const std::size_t command : standing) hashes.push_back(fnv1a(log[command]));
  std::vector<std::uint64_t> saved = hashes;
  state(saved);
  const auto [here, there] = std::ranges::mismatch(hashes, saved);
  if (here == hashes.end() && there == saved.end()) return;
  const auto first = static_cast<std::size_t>(here - hashes.begin());
  throw InputError(
      "the state is of another scene: command " + std::to_string(first + 1) +
      (first < standing.size() ? " here is " + log[standing[first]] : " is missing here") +
      ", expected a scene of the same commands and requests in the same order, apart from what was removed");
}

void archive_scene(StateArchive& state, const SimulationDesc& desc, const std::vector<std::string>& log) {
  state.object("the scene", [&] {
    std::uint64_t settings = hash_of(desc);
    state(settings);
    if (settings != hash_of(desc)) {
      throw InputError(
          "the state is of a simulation with another seed, rate or override of attributes, expected the "
          "same settings");
    }
    archive_commands(state, log);
  });
}

void update_all(BuiltScene& built) {
  const Parameters& parameters = built.parameters;
  for (std::size_t i = 0; i < built.elements.size(); ++i) {
    const ElementDescriptor& each = parameters.elements()[i];
    if (built.elements[i] == nullptr) continue;
    built.elements[i]->update(parameters.values().subspan(each.first_value, each.parameters.size()));
  }
}

void read_postponed_shapes(Scene& scene, const std::string& sensor) {
  try {
    scene.read_shapes("the state of sensor " + in_quotes(sensor));
  } catch (...) {
    scene.undo().roll_back();
    throw;
  }
  scene.undo().commit();
}

}  // namespace

std::string SimulationImpl::save_state() {
  finish();
  measure_skipped();
  StateArchive state;
  archive_scene(state, desc, scene.built.parameters.changes());
  archive(state);
  return to_saved_state(state.bytes());
}

// All or nothing: what has been read in part is replaced by what was there.
void SimulationImpl::restore_state(std::string_view bytes) {
  finish();
  measure_skipped();
  StateArchive state(content_of(bytes));
  archive_scene(state, desc, scene.built.parameters.changes());
  StateArchive present;
  present.keep_all();
  archive(present);
  try {
    archive(state);
  } catch (...) {
    StateArchive before(present.bytes());
    before.keep_all();
    archive(before);
    try {
      throw;
    } catch (const std::bad_alloc&) {
      throw InputError("the state needs more memory than there is, expected one of this scene");
    } catch (const std::length_error&) {
      throw InputError("the state has a number of values that is not possible, expected one of this scene");
    }
  }
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
    if (scene.built.sensors[i].delayed != nullptr) sensors.all[i].measurement.reset();
  }
  sensors.begin_frame();
}

void SimulationImpl::archive(StateArchive& state) {
  state.object("the clock", [&] {
    timeline.archive(state);
    archive_frame(state, frame);
    bool has_made = made.has_value();
    state(has_made, moved_to_ns);
    if (!has_made) made.reset();
    if (has_made && !made) made.emplace();
    if (made) archive_frame(state, *made);
    state.require(moved_to_ns >= 0);
  });
  // Physics measures what sensors that are on need.
  state.object("the switches of sensors", [&] {
    for (std::size_t i = 0; i < sensors.all.size(); ++i) {
      bool enabled = sensors.all[i].enabled;
      state(enabled);
      if (enabled != sensors.all[i].enabled) enable(scene.built.sensors[i].name, enabled);
    }
  });
  // Only times that are read from a saved state are compared with the next frame, which the end of the clock has not.
  const bool needs_next = state.is_reading() && !state.keeps_all();
  state.set_frames(timeline.last_ns(), needs_next ? next_frame().time_ns : timeline.last_ns());
  state.set_graph(*scene.built.scene.root());
  archive_elements(state);
  archive_sensors(state);
}

void SimulationImpl::archive_elements(StateArchive& state) {
  BuiltScene& built = scene.built;
  state.object("the parameters", [&] { built.parameters.archive(state); });
  if (state.is_reading()) update_all(built);
  for (std::size_t i = 0; i < built.elements.size(); ++i) {
    auto* const own = dynamic_cast<Stateful*>(built.elements[i].get());
    if (own == nullptr) continue;
    state.object("element " + in_quotes(built.parameters.elements()[i].name), [&] { own->archive(state); });
  }
}

void SimulationImpl::archive_sensors(StateArchive& state) {
  const bool lacks_shapes = state.is_reading() && !state.keeps_all() && scene.built.scene.has_postponed_shapes();
  for (std::size_t i = 0; i < sensors.all.size(); ++i) {
    SensorState& own = sensors.all[i];
    const BuiltSensor& sensor = scene.built.sensors[i];
    state.object("sensor " + in_quotes(sensor.name), [&] {
      state(own.frames, own.world_from_sensor);
      state.set_on(own.enabled);
      // The state names shapes that the sensor has seen by their numbers, also if it has always been off here.
      const bool sees_shapes = find_sensor_type(sensor.type)->sees_shapes || sensor.sensor->needs().shapes;
      if (lacks_shapes && own.frames > 0 && sees_shapes) {
        const InputLog log;
        read_postponed_shapes(scene.built.scene, sensor.name);
        inputs.add(log);
      }
      archive_state(state, *sensor.sensor);
    });
  }
  if (visualization) state.object("the scans that are shown", [&] { sensors.archive_scans(state); });
  state.object("the motion that sensors follow", [&] { sensed.archive(state); });
}

}  // namespace simvis
