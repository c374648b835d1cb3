#include <simvis/sensor_type.h>

#include <algorithm>
#include <vector>

#include "scenegraph/language/text_table.h"

namespace simvis {

Command with_preset(Command command, const SensorType& type) {
  const CommandAttribute* const written = command.find(kPresetAttribute.name);
  if (type.presets.empty() || written == nullptr) return command;
  const CommandAttribute chosen = *written;
  const auto preset = std::ranges::find(type.presets, chosen.value, &SensorPreset::name);
  if (preset == type.presets.end()) {
    std::vector<std::string_view> known;
    std::string list;
    for (const SensorPreset& each : type.presets) {
      known.push_back(each.name);
      list += (list.empty() ? "" : ", ") + std::string(each.name);
    }
    fail_at(chosen.where, "attribute \"preset\": " + in_quotes(chosen.value) +
                              " is not allowed, expected one of: " + list + suggestion(chosen.value, known));
  }
  std::erase_if(command.attributes, [](const CommandAttribute& each) { return each.name == kPresetAttribute.name; });
  for (const PresetAttribute& each : preset->attributes) {
    if (command.find(each.name) != nullptr) continue;
    command.attributes.push_back({std::string(each.name), std::string(each.value), chosen.where});
  }
  return command;
}

std::string describe_presets(const SensorType& type) {
  constexpr std::size_t kIndent = 2;
  std::string page;
  for (const SensorPreset& preset : type.presets) {
    page += '\n';
    add_wrapped(page, "", kIndent, "preset " + std::string(preset.name) + ": " + std::string(preset.summary));
    add_wrapped(page, "  ", kIndent, "from " + std::string(preset.source));
    std::string attributes;
    for (const PresetAttribute& each : preset.attributes) {
      attributes += (attributes.empty() ? "" : " ") + std::string(each.name) + "=\"" + std::string(each.value) + '"';
    }
    add_wrapped(page, "  ", kIndent, attributes);
  }
  return page;
}

}  // namespace simvis
