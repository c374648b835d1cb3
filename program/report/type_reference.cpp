#include "program/report/type_reference.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <simvis/effect.h>
#include <simvis/element.h>
#include <simvis/sensor.h>
#include "program/report/command_reference.h"
#include "program/report/output_table.h"
#include "program/report/type_json.h"
#include "scenegraph/language/markdown.h"
#include "scenegraph/language/text_table.h"

namespace simvis {
namespace {

constexpr std::string_view kAll = "all", kPresets = "presets";

std::string heading(std::string_view family, std::string_view name) {
  return "### " + std::string(family) + " `" + std::string(name) + "`\n\n";
}

// The summary and the notes, each paragraph followed by an empty line.
std::string paragraphs(std::string_view summary, std::string_view notes) {
  std::string page = markdown_text(summary) + "\n\n";
  while (!notes.empty()) {
    const std::size_t end = std::min(notes.find('\n'), notes.size());
    page += markdown_text(notes.substr(0, end)) + "\n\n";
    notes.remove_prefix(std::min(end + 1, notes.size()));
  }
  return page;
}

std::string table(AttributeTable attributes) { return attributes.empty() ? "" : markdown_table(attributes) + '\n'; }

std::string link_to_effect(std::string_view name) {
  return "[`" + std::string(name) + "`](#effect-" + std::string(name) + ")";
}

std::string markdown(const ElementType& type) {
  return heading("Element", type.name) + paragraphs(type.summary, type.notes) + table(type.attributes);
}

// The names of the presets, with a link to the page that has them.
std::string preset_names(const SensorType& type) {
  std::string names;
  for (const SensorPreset& preset : type.presets) {
    names += (names.empty() ? "" : ", ") + ("`" + std::string(preset.name) + "`");
  }
  return names.empty() ? names : "Presets, see [devices](devices.md): " + names + ".\n\n";
}

// The devices of a type as a table.
std::string preset_table(const SensorType& type) {
  std::string page =
      "## `" + std::string(type.name) +
      "`\n\n| `preset` | device | attributes | conditions, kinds of errors, and what the source does not "
      "say | source |\n|---|---|---|---|---|\n";
  for (const SensorPreset& preset : type.presets) {
    page += "| `" + std::string(preset.name) + "` | " + markdown_text(preset.summary) + " |";
    for (const PresetAttribute& each : preset.attributes) {
      page += " `" + std::string(each.name) + "=\"" + std::string(each.value) + "\"`";
    }
    page += " | " + markdown_text(preset.notes) + " | " + markdown_text(preset.source) + " |\n";
  }
  return page;
}

std::string all_presets(ReferenceFormat format) {
  const bool is_markdown = format == ReferenceFormat::markdown;
  std::string page;
  if (is_markdown) {
    page =
        "# Devices\n\n"
        "<!-- Generated: simvis-run --describe presets --markdown > docs/devices.md -->\n\n"
        "The attribute `preset` of a sensor sets the values of a device's data sheet. Attributes of the command take "
        "precedence.\nWhite noise is drawn for each measurement, a bias once. An attribute that a preset does not set "
        "has its default.\n";
  }
  for (const SensorType* const type : sensor_types()) {
    if (type->presets.empty()) continue;
    page += is_markdown ? "\n" + preset_table(*type) : std::string(type->name) + describe_presets(*type) + '\n';
  }
  return page;
}

// The rows of the type's own attributes as commands are checked against them: `outputs` has all outputs.
std::vector<AttributeSpec> own_rows(const SensorType& type) {
  std::vector<AttributeSpec> rows = all_attributes(type);
  std::erase_if(rows, [&](const AttributeSpec& row) {
    return std::ranges::count(type.attributes, row.name, &AttributeSpec::name) == 0;
  });
  return rows;
}

std::string markdown(const SensorType& type) {
  std::string effects;
  for (const EffectType* effect : effect_types()) {
    if (!may_have(type.name, *effect) || effect->attributes.empty()) continue;
    effects += (effects.empty() ? "" : ", ") + link_to_effect(effect->name);
  }
  if (!effects.empty()) effects = "It also takes the attributes of these effects: " + effects + ".\n\n";
  std::string outputs = output_markdown_table(all_outputs(type));
  if (!outputs.empty()) outputs += '\n';
  return heading("Sensor", type.name) + paragraphs(type.summary, type.notes) + table(own_rows(type)) + effects +
         outputs + preset_names(type);
}

// One fact about an effect in addition to its attributes, with its label.
struct EffectFact {
  std::string_view label;
  std::string value;
};

// What makes the effect active, which outputs show it, which sensors may have it, its accuracy setting and what its
// tests compare it with.
std::vector<EffectFact> effect_facts(const EffectType& type) {
  std::string shown, sensors;
  for (const auto& [output, name] :
       {std::pair(kShownInColor, "colour"), {kShownInDepth, "depth"}, {kShownInRanges, "ranges"}}) {
    if ((type.outputs & output) != 0) shown += (shown.empty() ? "" : ", ") + std::string(name);
  }
  for (const SensorType* sensor : sensor_types()) {
    if (may_have(sensor->capabilities, type)) sensors += (sensors.empty() ? "" : " ") + std::string(sensor->name);
  }
  std::vector<EffectFact> facts{{"called for by", std::string(type.source)},
                                {"shown in", shown},
                                {"sensors", sensors},
                                {"accuracy setting", std::string(type.knob)},
                                {"compared with", std::string(type.reference)}};
  std::erase_if(facts, [](const EffectFact& fact) { return fact.value.empty(); });
  return facts;
}

std::string markdown(const EffectType& type) {
  std::string facts;
  for (const EffectFact& fact : effect_facts(type)) {
    facts += "* " + std::string(fact.label) + ": " + markdown_text(fact.value) + '\n';
  }
  return heading("Effect", type.name) + paragraphs(type.summary, type.notes) + facts + '\n' + table(type.attributes);
}

std::string text(const ElementType& type) {
  return describe(type.name, type.summary, type.attributes, type.notes) + '\n';
}

std::string text(const SensorType& type) {
  return describe(type.name, type.summary, all_attributes(type), type.notes) + output_text_table(all_outputs(type)) +
         describe_presets(type) + '\n';
}

std::string text(const CommandForm& form) { return describe(form.name, form.summary, form.attributes) + '\n'; }

std::string markdown(const CommandForm& form) {
  return heading("Command", form.name) + paragraphs(form.summary, "") + table(form.attributes);
}

std::string text(const EffectType& type) {
  std::string text = describe(type.name, type.summary, type.attributes, type.notes);
  std::vector<TextRow> rows;  // the empty column indents them
  for (const EffectFact& fact : effect_facts(type)) rows.push_back({"", std::string(fact.label) + ": " + fact.value});
  return text + text_table(rows) + '\n';
}

template <typename Types>
std::string sections(const Types& types, ReferenceFormat format) {
  std::string page;
  for (const auto* type : types) page += format == ReferenceFormat::markdown ? markdown(*type) : text(*type);
  return page;
}

template <typename Types>
std::string chapter(std::string_view title, const Types& types, ReferenceFormat format) {
  return (format == ReferenceFormat::markdown ? "## " + std::string(title) + "\n\n" : "") + sections(types, format);
}

std::string all(ReferenceFormat format) {
  std::string page;
  if (format == ReferenceFormat::markdown) {
    page =
        "# Reference of elements, sensors and effects\n\n"
        "<!-- Generated: simvis-run --describe all --markdown > docs/reference.md -->\n\n"
        "This page is generated from the tables that also check the scene. `simvis-run --describe TYPE` prints the "
        "same.\n`live` marks a parameter: a number, ELEMENT.NAME, that can change while the scene runs. The attributes "
        "that every\ncommand has (name, insert_at, pose_offset) are in [scene-language.md](scene-language.md).\n\n";
  }
  page += chapter("Elements", element_types(), format) + chapter("Sensors", sensor_types(), format) +
          chapter("Effects", effect_types(), format);
  if (page.ends_with("\n\n")) page.pop_back();
  return page;
}

[[noreturn]] void refuse(std::string_view name) {
  std::vector<std::string_view> known{kAll, kPresets};
  for (const ElementType* each : element_types()) known.push_back(each->name);
  for (const SensorType* each : sensor_types()) known.push_back(each->name);
  for (const EffectType* each : effect_types()) known.push_back(each->name);
  const std::vector<CommandForm> commands = command_forms();
  for (const CommandForm& each : commands) known.push_back(each.name);
  std::string list;
  for (const std::string_view each : known) list += (list.empty() ? "" : ", ") + std::string(each);
  throw InputError("there is no command, element, sensor or effect type \"" + std::string(name) + "\"" +
                   suggestion(name, known) + " (known: " + list + ")");
}

/// Removes all types with other names. Throws if none is left.
void keep_named(DescribedTypes& types, std::string_view name) {
  const auto has_other_name = [&](const auto* type) { return type->name != name; };
  std::erase_if(types.commands, has_other_name);
  std::erase_if(types.elements, has_other_name);
  std::erase_if(types.sensors, has_other_name);
  std::erase_if(types.effects, has_other_name);
  if (types.commands.empty() && types.elements.empty() && types.sensors.empty() && types.effects.empty()) refuse(name);
}

template <typename Types>
void list_types(std::string_view family, const Types& types, std::string& page) {
  constexpr std::size_t kFamilyWidth = 9, kNameWidth = 30;
  for (const auto* type : types) {
    std::string line(family);
    line.resize(kFamilyWidth, ' ');
    line += type->name;
    line.resize(std::max(line.size() + 1, kNameWidth), ' ');
    page += line + std::string(type->summary) + '\n';
  }
}

}  // namespace

std::string type_list() {
  std::string page;
  list_types("element", element_types(), page);
  list_types("sensor", sensor_types(), page);
  list_types("effect", effect_types(), page);
  return page;
}

std::string type_reference(std::string_view name, ReferenceFormat format) {
  if (name == kAll && format != ReferenceFormat::json) return all(format);
  if (name == kPresets && format != ReferenceFormat::json) return all_presets(format);
  const std::vector<CommandForm> forms = command_forms();
  DescribedTypes types{
      .commands = {}, .elements = element_types(), .sensors = sensor_types(), .effects = effect_types()};
  for (const CommandForm& form : forms) types.commands.push_back(&form);
  if (name == kPresets) {
    types = {.commands = {}, .elements = {}, .sensors = types.sensors, .effects = {}};
    std::erase_if(types.sensors, [](const SensorType* type) { return type->presets.empty(); });
  } else if (name != kAll) {
    keep_named(types, name);
  }
  if (format == ReferenceFormat::json) return to_json(types);
  return sections(types.commands, format) + sections(types.elements, format) + sections(types.sensors, format) +
         sections(types.effects, format);
}

}  // namespace simvis
