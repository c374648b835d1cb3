// The scene showcase with and without an effect, seen by one sensor.
#pragma once

#include <string>
#include <string_view>

#include <simvis/effect.h>
#include <simvis/simulation.h>
#include "scenes/showcase/effect_examples.h"

namespace simvis::bench {

/// Who looks: a sensor WATCH where the scene's own of that type stands.
struct Watcher {
  std::string_view type, attributes;
  std::uint8_t shows;  ///< an EffectOutput
};
inline constexpr Watcher kYardCamera{
    "camera", R"(pose_offset="-5.2 -0.6 1.9 0 10 4" width="320" height="180" hfov="58" outputs="color")",
    kShownInColor};
inline constexpr Watcher kYardScanner{
    "laser_scanner", R"(pose_offset="-3 0 0.7 0 0 0" samples="361" min_angle="-60" max_angle="60" method="raycast")",
    kShownInRanges};

/// What is added to the scene, and to the sensor.
struct Setting {
  std::string commands{}, attributes{};
};

/// Every registered effect has one.
const EffectExample& example_of(const EffectType& effect);

/// With the example of the effect. `value`: of its knob; empty: as the example says.
Setting with_effect(const EffectType& effect, const Watcher& watcher, std::string_view value = {});

/// The same scene where nothing names the effect.
Setting without_effect(const EffectType& effect);

/// Whether the watcher can show the effect.
bool can_show(const EffectType& effect, const Watcher& watcher);

/// Only WATCH is on.
Simulation yard(const Watcher& watcher, const Setting& setting);

}  // namespace simvis::bench
