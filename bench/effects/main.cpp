// Measures the time that effects cost and the accuracy that their knobs give: each effect alone and all together, in
// the scene showcase, as a ratio to the scene without effects; and the error of each value of a knob compared with the
// most exact value.
//
//   effects [FRAMES]
//
// Prints one CSV row per effect, sensor and value of its knob. Frames with and without an effect are taken in turns.
// error: for colour the RMS difference of linear radiance; for depth and ranges the RMS difference in metres where both
// have a hit. It is empty if the effect is exact.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "bench/effects/yard.h"

namespace {

using namespace simvis;
using namespace simvis::bench;

class Trial {
 public:
  Trial(const Watcher& watcher, const Setting& setting) : watcher_(watcher), simulation_(yard(watcher, setting)) {
    for (int i = 0; i < 2; ++i) step();  // the first step uploads data, in the second one things have moved
    times_ms_.clear();
  }

  void step() {
    constexpr int kRoundTrip = 8;  // frames after which things that move are where they were
    drive_examples(simulation_, frame_++ % kRoundTrip);
    simulation_.step();
    std::int64_t ns = 0;
    for (const StageTime& stage : simulation_.diagnostics().stages()) ns += stage.end_ns - stage.start_ns;
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
  const Watcher& watcher_;
  Simulation simulation_;
  int frame_ = 0;
  std::vector<double> times_ms_;
};

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
  std::vector<std::string> values = words(example_of(effect).knob_values);
  if (values.empty()) values.emplace_back();
  const Setting plain = without_effect(effect);
  const Trial reference(watcher, with_effect(effect, watcher, values.back()));
  for (const std::string& value : values) {
    Trial with(watcher, with_effect(effect, watcher, value)), without(watcher, plain);
    const double error = rms_difference(with.output(), reference.output());  // from the second frame of both
    take_turns(with, without, frames);
    print(watcher, {std::string(effect.name), std::string(effect.knob), value, with.median_ms(), without.median_ms(),
                    error, !effect.knob.empty()});
  }
}

// The example of `atmosphere` is fog; other kinds of weather are measured here.
void measure_weather(const Watcher& watcher, int frames) {
  for (const WeatherExample& weather : kWeatherExamples) {
    std::fprintf(stderr, "effects: %s, %s\n", std::string(weather.kind).c_str(), std::string(watcher.type).c_str());
    Trial with(watcher, {.commands = std::string(weather.commands)}), without(watcher, {});
    take_turns(with, without, frames);
    print(watcher, {"atmosphere: " + std::string(weather.kind), "", "", with.median_ms(), without.median_ms()});
  }
}

// Lamps with a size and pictures for each colour are left out: each light has shadow maps in each picture of depth of
// field and of motion blur, which together would be more than a device has.
void measure_all_together(const Watcher& watcher, int frames) {
  Setting all, plain;
  for (const EffectType* effect : effect_types()) {
    if (!can_show(*effect, watcher)) continue;
    if (effect->name == "area_lights" || effect->name == "chromatic_aberration") continue;
    const Setting on = with_effect(*effect, watcher), off = without_effect(*effect);
    all.commands += on.commands;
    all.attributes = join_attributes(all.attributes, on.attributes);
    plain.commands += off.commands;
  }
  Trial with(watcher, all), without(watcher, plain);
  take_turns(with, without, frames);
  print(watcher, {"all", "", "", with.median_ms(), without.median_ms()});
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc == 2 ? std::atoi(argv[1]) : 15;
  if (argc > 2 || frames < 1) {
    std::fputs("usage: effects [FRAMES]\n", stderr);
    return 2;
  }
  try {
    std::puts("effect,sensor,knob,value,median_ms,without_ms,ratio,error");
    for (const Watcher& watcher : {kYardCamera, kYardScanner}) {
      for (const EffectType* effect : effect_types()) {
        if (can_show(*effect, watcher)) measure(*effect, watcher, frames);
      }
      if (watcher.shows == kShownInRanges) measure_weather(watcher, frames);
      measure_all_together(watcher, frames);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "effects: %s\n", error.what());
    return 1;
  }
}
