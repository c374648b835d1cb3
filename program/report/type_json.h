// Types and commands as `simvis-run --describe TYPE --json` prints them.
#pragma once

#include <string>
#include <vector>

#include <simvis/effect.h>
#include <simvis/element.h>
#include <simvis/sensor.h>
#include "program/report/command_reference.h"

namespace simvis {

/// What a reference describes.
struct DescribedTypes {
  std::vector<const CommandForm*> commands;
  std::vector<const ElementType*> elements;
  std::vector<const SensorType*> sensors;
  std::vector<const EffectType*> effects;
};

/// Returns an object with the lists "commands", "elements", "sensors" and "effects". Each entry has a name, a summary
/// and attributes; types have notes, commands the names of required attributes; sensors have outputs and presets too,
/// and their attributes include those of effects.
std::string to_json(const DescribedTypes& types);

}  // namespace simvis
