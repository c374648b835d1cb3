// What effects cost in time, and what their knobs buy: each alone and all together, in the scene showcase, as a ratio
// to the scene without; and the error of each value of a knob against the most exact one.
//
//   effects [FRAMES]
//
// Prints one CSV row per effect, sensor and value of its knob. Frames with and without an effect are taken in turns.
// error: of colour, the RMS difference of linear radiance; of depth and ranges, the RMS difference in metres where both
// meet something. Empty where the effect is exact.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "effects/effect.h"
#include "simvis/simulation.h"

namespace {

using namespace simvis;
namespace fs = std::filesystem;

/// A sensor that stands where the scene's own of its kind does.
struct Watcher {
  std::string_view type, place;
  std::uint8_t shows;
};
constexpr Watcher kWatchers[] = {
    {"camera", R"(pose_offset="-5.2 -0.6 1.9 0 10 4" width="320" height="240" hfov="58" outputs="color")",
     kShownInColor},
    {"laser_scanner", R"(pose_offset="-3 0 0.7 0 0 0" samples="361" min_angle="-60" max_angle="60" method="raycast")",
     kShownInRanges},
};

struct Setting {
  std::string commands, attributes;
};

class Trial {
 public:
  Trial(const Watcher& watcher, const Setting& setting) : watcher_(watcher), simulation_(make(watcher, setting)) {}

  void step() {
    simulation_.step();
    std::int64_t ns = 0;
    for (const StageTime& stage : simulation_.stages()) ns += stage.end_ns - stage.start_ns;
    times_ms_.push_back(static_cast<double>(ns) / 1e6);
  }

  double median_ms() {
    const auto middle = times_ms_.begin() + static_cast<std::ptrdiff_t>(times_ms_.size() / 2);
    std::ranges::nth_element(times_ms_, middle);
    return *middle;
  }

  const std::vector<float>& output() const {
    return watcher_.shows == kShownInColor ? simulation_.color("WATCH").pixels : simulation_.scan("WATCH").range_m;
  }

 private:
  static Simulation make(const Watcher& watcher, const Setting& setting) {
    const fs::path file = fs::path(SIMVIS_SOURCE_DIR) / "scenes/showcase/showcase.xml";
    std::ifstream stream(file);
    std::string xml(std::istreambuf_iterator<char>(stream), {});
    xml.insert(xml.rfind("</simvis>"), setting.commands + "<sensor type=\"" + std::string(watcher.type) +
                                           "\" name=\"WATCH\" insert_at=\"ROOT\" " + std::string(watcher.place) + ' ' +
                                           setting.attributes + "/>");
    Simulation simulation = Simulation::from_string(xml, {}, file.parent_path(), file.string());
    for (const SensorInfo& each : simulation.sensors()) simulation.enable(each.name, each.name == "WATCH");
    simulation.step();  // uploads
    return simulation;
  }

  const Watcher& watcher_;
  Simulation simulation_;
  std::vector<double> times_ms_;
};

/// The example with another value of its knob.
std::string with_knob(std::string_view example, std::string_view knob, std::string_view value) {
  std::string text(example);
  const std::string written = std::string(knob) + "=\"";
  const std::size_t at = knob.empty() ? text.npos : text.find(written);
  if (at == text.npos) return text;
  const std::size_t first = at + written.size();
  return text.replace(first, text.find('"', first) - first, value);
}

Setting setting_of(const EffectType& effect, const Watcher& watcher, std::string_view value) {
  Setting setting{example_commands(effect, with_knob(effect.example.commands, effect.knob, value)), ""};
  if (may_have(watcher.type, effect)) {
    setting.attributes = with_knob(effect.example.attributes, effect.knob, value);
  }
  return setting;
}

double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
    const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += difference * difference;
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
}

std::vector<std::string> words(std::string_view text) {
  std::istringstream stream{std::string(text)};
  return {std::istream_iterator<std::string>(stream), {}};
}

struct Row {
  std::string effect, knob, value;
  double with_ms = 0, without_ms = 0, error = 0;
  bool has_error = false;
};

void print(const Watcher& watcher, const Row& row) {
  std::printf("%s,%s,%s,%s,%.4g,%.4g,%.3f,", row.effect.c_str(), std::string(watcher.type).c_str(), row.knob.c_str(),
              row.value.c_str(), row.with_ms, row.without_ms, row.with_ms / row.without_ms);
  if (row.has_error) std::printf("%.3g", row.error);
  std::puts("");
  std::fflush(stdout);
}

void take_turns(Trial& with, Trial& without, int frames) {
  for (int frame = 0; frame < frames; ++frame) {
    with.step();
    without.step();
  }
}

void measure(const EffectType& effect, const Watcher& watcher, int frames) {
  std::fprintf(stderr, "effects: %s, %s\n", std::string(effect.name).c_str(), std::string(watcher.type).c_str());
  std::vector<std::string> values = words(effect.example.knob_values);
  if (values.empty()) values.emplace_back();
  const Setting plain{example_commands(effect, effect.example.plain_commands), ""};
  const Trial reference(watcher, setting_of(effect, watcher, values.back()));
  for (const std::string& value : values) {
    Trial with(watcher, setting_of(effect, watcher, value)), without(watcher, plain);
    const double error = rms_difference(with.output(), reference.output());  // of the first frame of both
    take_turns(with, without, frames);
    print(watcher, {std::string(effect.name), std::string(effect.knob), value, with.median_ms(), without.median_ms(),
                    error, !effect.knob.empty()});
  }
}

void measure_all_together(const Watcher& watcher, int frames) {
  Setting all, plain;
  for (const EffectType* effect : effect_types()) {
    if ((effect->outputs & watcher.shows) == 0) continue;
    all.commands += example_commands(*effect, effect->example.commands);
    plain.commands += example_commands(*effect, effect->example.plain_commands);
    if (may_have(watcher.type, *effect)) all.attributes += std::string(effect->example.attributes) + ' ';
  }
  Trial with(watcher, all), without(watcher, plain);
  take_turns(with, without, frames);
  print(watcher, {"all", "", "", with.median_ms(), without.median_ms()});
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 15;
  if (frames < 1) {
    std::fputs("usage: effects [FRAMES]\n", stderr);
    return 2;
  }
  try {
    std::puts("effect,sensor,knob,value,median_ms,without_ms,ratio,error");
    for (const Watcher& watcher : kWatchers) {
      for (const EffectType* effect : effect_types()) {
        const bool carried = effect->attributes.empty() || may_have(watcher.type, *effect);
        if ((effect->outputs & watcher.shows) != 0 && carried) measure(*effect, watcher, frames);
      }
      measure_all_together(watcher, frames);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "effects: %s\n", error.what());
    return 1;
  }
}
