#include <simvis/sensor_type.h>

#include <algorithm>
#include <vector>

#include "scenegraph/language/text_table.h"

namespace simvis {
namespace {

// Attributes of presets that others replace: a focal length or a lens that has one.
struct Replaced {
  std::string_view of_preset, by;
};
constexpr Replaced kReplaced[] = {{"hfov", "fx"}, {"hfov", "polynomial"}};

bool is_written(const Command& command, std::string_view of_preset) {
  return command.find(of_preset) != nullptr || std::ranges::any_of(kReplaced, [&](const Replaced& each) {
           return each.of_preset == of_preset && command.find(each.by) != nullptr;
         });
}

}  // namespace

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
    if (is_written(command, each.name)) continue;
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
    if (!preset.notes.empty()) add_wrapped(page, "  ", kIndent, std::string(preset.notes));
  }
  return page;
}

}  // namespace simvis
