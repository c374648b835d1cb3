// The scene showcase with and without an effect, measured by one sensor.
#pragma once

#include <string>
#include <string_view>

#include <simvis/effect.h>
#include <simvis/simulation.h>
#include "scenes/showcase/effect_examples.h"

namespace simvis::bench {

/// The measuring sensor WATCH, at the pose of the scene's own sensor of that type.
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

/// The commands added to the scene and the attributes added to the sensor.
struct Setting {
  std::string commands{}, attributes{};
};

/// The example of an effect; every registered effect has one.
const EffectExample& example_of(const EffectType& effect);

/// The setting of the effect's example. `value` is that of its knob; if empty, the example's value is used.
Setting with_effect(const EffectType& effect, const Watcher& watcher, std::string_view value = {});

/// The setting of the same scene without the effect.
Setting without_effect(const EffectType& effect);

/// True if the watcher can show the effect.
bool can_show(const EffectType& effect, const Watcher& watcher);

/// Loads the scene; only WATCH is on.
Simulation yard(const Watcher& watcher, const Setting& setting);

}  // namespace simvis::bench
