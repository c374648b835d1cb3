#include "tests/combinations/scene_checks.h"

#include <bit>
#include <string_view>

#include <simvis/simulation.h>

namespace simvis::combined {
namespace {

/// Whether an output depends by definition on what else the scene has: the number of a mesh on the order of the file.
bool follows_company(std::string_view output) { return output == "true_item"; }

/// The names of arrays whose bytes differ. Arrays of `some` that the other
/// measurement lacks do not count.
std::vector<std::string> differences(const Measurement& some, const Measurement& more) {
  std::vector<std::string> names;
  for (const MeasuredArray& each : some.arrays) {
    const MeasuredArray* const other = more.find(each.name);
    bool same = other != nullptr && other->count() == each.count();
    for (std::size_t i = 0; same && i < each.count(); ++i) {
      same = std::bit_cast<std::uint64_t>(each.number(i)) == std::bit_cast<std::uint64_t>(other->number(i));
    }
    if (!same && !follows_company(each.name)) names.push_back(each.name);
  }
  return names;
}

void same_bytes(const CombinedScene& scene, const Measured& a, const Measured& b, const std::string& check,
                Tally& tally, std::vector<Failure>& failures) {
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    for (std::size_t sensor = 0; sensor < scene.sensors.size(); ++sensor) {
      ++tally.values[check];
      for (const std::string& name : differences(a.frames[frame][sensor], b.frames[frame][sensor])) {
        failures.push_back({check, "frame " + std::to_string(frame) + ", C" + std::to_string(sensor) + ", " + name +
                                       ": " + check + " changes bytes"});
      }
    }
  }
}

/// A factor of two rounds nothing that is cast.
void twice_as_long(const CombinedScene& scene, const Measured& a, const Measured& b, Tally& tally,
                   std::vector<Failure>& failures) {
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    for (std::size_t sensor = 0; sensor < scene.sensors.size(); ++sensor) {
      if (scene.sensors[sensor].kind != SensorKind::scanner || scene.sensors[sensor].method != "raycast") continue;
      const MeasuredArray &one = *a.frames[frame][sensor].find("range_m"),
                          &two = *b.frames[frame][sensor].find("range_m");
      for (std::size_t i = 0; i < one.count(); ++i) {
        ++tally.values["double size"];
        if (two.number(i) == 2 * one.number(i)) continue;
        failures.push_back({"double size", "frame " + std::to_string(frame) + ", C" + std::to_string(sensor) +
                                               ", beam " + std::to_string(i) + ": " + text_of(two.number(i)) +
                                               " is not twice " + text_of(one.number(i))});
      }
    }
  }
}

}  // namespace

Measured measure(const CombinedScene& scene, const std::filesystem::path& folder, const Writing& writing) {
  write_scene(scene, folder, writing);
  SimulationDesc desc;
  desc.rate_hz = kRate_hz;
  desc.frames_when_due = writing.sensors_rate_hz > 0;
  Simulation simulation = Simulation::load(folder / "scene.xml", desc);
  Measured measured;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    const auto due_ns = static_cast<std::int64_t>(frame) * 100'000'000;
    for (std::int64_t time_ns = -1; time_ns < due_ns;) {
      time_ns = simulation.next_frame().time_ns;
      if (time_ns == due_ns) {
        for (const Setting& setting : settings_of(scene, frame)) {
          simulation.set(setting.element, setting.parameter, setting.value);
        }
      }
      simulation.step();
    }
    for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
      measured.frames[frame].push_back(simulation.measurement("C" + std::to_string(i)));
    }
  }
  measured.items = simulation.items();
  return measured;
}

std::vector<Failure> check_scene(const CombinedScene& scene, const std::filesystem::path& folder, Tally& tally) {
  const Measured measured = measure(scene, folder);
  std::vector<Failure> failures = compare_with_geometry(scene, measured, tally);
  if (!failures.empty()) return failures;
  const auto compare = [&](const Measured& usual, const Writing& writing, const std::string& check) {
    same_bytes(scene, usual, measure(scene, folder, writing), check, tally, failures);
  };
  switch (scene.relation) {
    case Relation::shuffled:
      compare(measured, {.order = scene.seed + 1}, "another order");
      break;
    case Relation::company:
      compare(measured, {.more_sensors = true, .more_outputs = true}, "company");
      break;
    case Relation::own_rates:
      // Random numbers are then named by the time, and not by the number of the frame.
      compare(measure(scene, folder, {.sensors_rate_hz = kRate_hz}),
              {.more_sensors = true, .sensors_rate_hz = kRate_hz}, "company with rates");
      break;
    case Relation::doubled:
    case Relation::moved:
    case Relation::mirrored:
    case Relation::split: {
      const CombinedScene other = related(scene);
      const Measured of_other = measure(other, folder);
      failures = compare_with_geometry(other, of_other, tally);
      if (scene.relation == Relation::doubled) twice_as_long(scene, measured, of_other, tally, failures);
      break;
    }
  }
  return failures;
}

}  // namespace simvis::combined
