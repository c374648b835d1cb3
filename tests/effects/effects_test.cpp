// All effects of the catalogue: each in every scene where it is shown, where it is not shown, and where it is named but
// off.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/effect.h>
#include <simvis/sensor.h>
#include <simvis/simulation.h>
#include "scenes/showcase/effect_examples.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;

namespace {

namespace fs = std::filesystem;

/// A scene, and the place of the test's own sensors in it.
struct EffectScene {
  std::string_view name, pose_offset;
};
constexpr EffectScene kYard{"showcase", "-4 -0.6 0.9 0 4 0"};
// Pictures are about ten times slower under sanitizers.
const std::vector<EffectScene> kScenes =
    sanitized() ? std::vector{kYard} : std::vector{kYard, {"marvin", "1 1 0.6 0 0 30"}};

/// A sensor that shows one kind of output, as small as possible while it still shows every effect.
struct Watcher {
  std::string_view type, attributes;
  std::uint8_t shows;
};
constexpr Watcher kColor{"camera", R"(width="48" height="36" outputs="color")", kShownInColor};
constexpr Watcher kDepth{"camera", R"(width="48" height="36" outputs="depth")", kShownInDepth};
constexpr Watcher kStereo{"stereo_camera", R"(width="32" height="24" baseline="0.1")", kShownInColor};
constexpr Watcher kRanges{"laser_scanner", R"(samples="61" min_angle="-40" max_angle="40" method="raycast")",
                          kShownInRanges};
const std::vector<const Watcher*> kWatchers =
    sanitized() ? std::vector{&kColor, &kRanges} : std::vector{&kColor, &kDepth, &kStereo, &kRanges};

std::string sensor(const Watcher& watcher, const EffectScene& scene, std::string_view name,
                   std::string_view attributes) {
  return "<sensor type=\"" + std::string(watcher.type) + "\" name=\"" + std::string(name) +
         "\" insert_at=\"ROOT\" pose_offset=\"" + std::string(scene.pose_offset) + "\" " +
         std::string(watcher.attributes) + ' ' + std::string(attributes) + "/>\n";
}

const EffectExample& example_of(const EffectType& effect) {
  const EffectExample* const example = find_effect_example(effect.name);
  if (example == nullptr) FAIL("no example in scenes/showcase/effect_examples.h: " << effect.name);
  return *example;
}

/// The outputs that show the source of an effect. Two effects may have the same source, for example fog in pictures and
/// in scans.
std::uint8_t shown_source(const EffectType& effect) {
  std::uint8_t outputs = effect.outputs;
  for (const EffectType* other : effect_types()) {
    const std::string_view commands = example_of(effect).commands;
    if (!commands.empty() && example_of(*other).commands == commands) {
      outputs |= other->outputs;
    }
  }
  return outputs;
}

void enable_only(Simulation& simulation, std::string_view sensor) {
  for (const SensorInfo& each : simulation.sensors()) simulation.enable(each.name, each.name == sensor);
}

/// The scene with more commands at its end. Only its sensor WATCH is on.
Simulation with(const EffectScene& scene, const std::string& commands) {
  const fs::path file = fs::path(SIMVIS_SOURCE_DIR) / "scenes" / scene.name / (std::string(scene.name) + ".xml");
  std::string xml = read_text(file);
  xml.insert(xml.rfind("</simvis>"), commands);
  SimulationDesc desc;
  desc.seed = 3;
  Simulation simulation = Simulation::from_string(xml, desc, file.parent_path(), file.string());
  enable_only(simulation, "WATCH");
  return simulation;
}

/// The output of a sensor and its cost.
struct Seen {
  std::vector<char> bytes;
  FrameCounters counters;
  bool operator==(const Seen&) const = default;
};

template <typename Value>
void append(std::vector<char>& bytes, const SharedNumbers<Value>& values) {
  const std::size_t size = bytes.size();
  bytes.resize(size + values.size() * sizeof(Value));
  if (!values.empty()) std::memcpy(bytes.data() + size, values.data(), values.size() * sizeof(Value));
}

/// Two frames: the first one uploads, the second one is like all later ones.
std::vector<Seen> look(Simulation& simulation, const Watcher& watcher, const std::string& name = "WATCH") {
  std::vector<Seen> frames;
  for (int frame = 0; frame < 2; ++frame) {
    drive_examples(simulation, frame);
    simulation.step();
    Seen& seen = frames.emplace_back();
    seen.counters = simulation.diagnostics().counters();
    if (watcher.shows == kShownInRanges) {
      const Scan& scan = simulation.scan(name);
      append(seen.bytes, scan.range_m);
      append(seen.bytes, scan.error_bound_m);
      for (const MeasuredArray& each : scan.channels()) append(seen.bytes, scan.channel(each.name));
    } else if (watcher.shows == kShownInDepth) {
      append(seen.bytes, simulation.depth(name).pixels);
    } else {
      append(seen.bytes, simulation.color(name).pixels);
      if (watcher.type == kStereo.type) append(seen.bytes, simulation.picture(name, "right").pixels);
    }
  }
  return frames;
}

std::vector<Seen> look_at(const EffectScene& scene, const Watcher& watcher, const std::string& commands,
                          std::string_view attributes) {
  Simulation simulation = with(scene, commands + sensor(watcher, scene, "WATCH", attributes));
  return look(simulation, watcher);
}

/// What one watcher saw, and the effects that the plan named for it.
struct Watched {
  std::vector<Seen> frames;
  std::vector<std::string> effects;
};

std::string name_of(std::size_t watcher) { return "WATCH_" + std::to_string(watcher); }

/// What each of kWatchers sees while the others are off. The scene has one of each, with the names of name_of().
std::vector<Watched> look_in_turn(const EffectScene& scene, const std::string& commands) {
  Simulation simulation = with(scene, commands);
  std::vector<Watched> all;
  for (std::size_t i = 0; i < kWatchers.size(); ++i) {
    enable_only(simulation, name_of(i));
    Watched& watched = all.emplace_back();
    watched.frames = look(simulation, *kWatchers[i], name_of(i));
    for (const PlannedEffect& each : simulation.diagnostics().frame_plan().effects) {
      if (each.sensor == name_of(i)) watched.effects.push_back(each.effect);
    }
  }
  return all;
}

bool same_bytes(const std::vector<Seen>& a, const std::vector<Seen>& b) {
  return std::ranges::equal(a, b, {}, &Seen::bytes, &Seen::bytes);
}

}  // namespace

TEST_CASE("the generator of the showcase scenes makes the committed files") {
  const std::string command = "python3 \"" SIMVIS_SOURCE_DIR "/scenes/showcase/generate.py\" --check";
  CHECK(std::system(command.c_str()) == 0);
}

TEST_CASE("every effect has a description, a caller, a reference for its truth, and an example") {
  REQUIRE_FALSE(effect_types().empty());
  for (const EffectType* effect : effect_types()) {
    CAPTURE(effect->name);
    CHECK_FALSE(effect->summary.empty());
    CHECK_FALSE(effect->source.empty());
    CHECK_FALSE(effect->reference.empty());
    CHECK(effect->outputs != 0);
    const EffectExample& example = example_of(*effect);
    CHECK_FALSE((example.attributes.empty() && example.commands.empty()));
    CHECK(example.attributes.empty() == example.off_attributes.empty());
    CHECK(example.commands.empty() == example.off_commands.empty());
    CHECK(effect->knob.empty() == example.knob_values.empty());
    CHECK((effect->attributes.empty() || effect->needs != 0));
    const std::string text = std::string(example.attributes) + std::string(example.commands);
    CHECK((effect->knob.empty() || text.find(std::string(effect->knob) + "=\"") != std::string::npos));
  }
  for (const EffectExample& example : kEffectExamples) {
    CAPTURE(example.effect);
    CHECK(find_effect_type(example.effect) != nullptr);
    CHECK(find_effect_example(example.effect) == &example);
  }
}

TEST_CASE("an effect costs nothing and changes no byte where no due sensor can show it") {
  for (const EffectScene& scene : kScenes) {
    CAPTURE(scene.name);
    for (const Watcher* watcher : kWatchers) {
      CAPTURE(watcher->attributes);
      std::string plain, commands;
      for (const EffectType* effect : effect_types()) {
        // Sensors that have the effect, but are off.
        for (const Watcher* other : kWatchers) {
          if (!may_have(other->type, *effect)) continue;
          const std::string name = "OFF_" + std::string(effect->name) +
                                   std::to_string(std::ranges::find(kWatchers, other) - std::begin(kWatchers));
          plain += sensor(*other, scene, name, "");
          commands += sensor(*other, scene, name, example_of(*effect).attributes);
        }
        if ((shown_source(*effect) & watcher->shows) != 0) continue;
        plain += example_commands(example_of(*effect), example_of(*effect).plain_commands);
        commands += example_commands(example_of(*effect), example_of(*effect).commands);
      }
      CHECK(look_at(scene, *watcher, plain, "") == look_at(scene, *watcher, commands, ""));
    }
  }
}

TEST_CASE("an effect that is named but off changes no byte and costs nothing") {
  for (const EffectScene& scene : kScenes) {
    CAPTURE(scene.name);
    std::string plain, off;
    for (const EffectType* effect : effect_types()) {
      plain += example_commands(example_of(*effect), example_of(*effect).plain_commands);
      off += example_commands(example_of(*effect), example_of(*effect).off_commands);
    }
    for (std::size_t i = 0; i < kWatchers.size(); ++i) {
      std::string attributes;
      for (const EffectType* effect : effect_types()) {
        if (may_have(kWatchers[i]->type, *effect))
          attributes = join_attributes(attributes, example_of(*effect).off_attributes);
      }
      plain += sensor(*kWatchers[i], scene, name_of(i), "");
      off += sensor(*kWatchers[i], scene, name_of(i), attributes);
    }
    const std::vector<Watched> without = look_in_turn(scene, plain), named = look_in_turn(scene, off);
    for (std::size_t i = 0; i < kWatchers.size(); ++i) {
      CAPTURE(kWatchers[i]->attributes);
      CHECK(without[i].frames == named[i].frames);
    }
  }
}

TEST_CASE("the plan names each effect where it is shown, and the bytes of other sensors stay the same") {
  std::map<std::string, std::vector<Watched>> seen_without;  // by the plain commands
  for (const EffectType* effect : effect_types()) {
    CAPTURE(effect->name);
    std::string plain = example_commands(example_of(*effect), example_of(*effect).plain_commands);
    std::string commands = example_commands(example_of(*effect), example_of(*effect).commands);
    for (std::size_t i = 0; i < kWatchers.size(); ++i) {
      const bool carries = may_have(kWatchers[i]->type, *effect);
      plain += sensor(*kWatchers[i], kYard, name_of(i), "");
      commands += sensor(*kWatchers[i], kYard, name_of(i), carries ? example_of(*effect).attributes : "");
    }
    std::vector<Watched>& without = seen_without[plain];
    if (without.empty()) without = look_in_turn(kYard, plain);
    const std::vector<Watched> with_effect = look_in_turn(kYard, commands);
    bool shown = false;
    for (std::size_t i = 0; i < kWatchers.size(); ++i) {
      CAPTURE(kWatchers[i]->attributes);
      const bool can_show = (effect->outputs & kWatchers[i]->shows) != 0;
      const bool planned = std::ranges::count(with_effect[i].effects, effect->name) > 0;
      const bool same = same_bytes(without[i].frames, with_effect[i].frames);
      CHECK((can_show || !planned));
      CHECK((planned || (shown_source(*effect) & kWatchers[i]->shows) != 0 || same));
      shown |= planned && !same;
    }
    CHECK(shown);
  }
}

TEST_SUITE_END();
