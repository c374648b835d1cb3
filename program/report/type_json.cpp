#include "program/report/type_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/words.h"
#include "program/report/output_table.h"
#include "scenegraph/language/markdown.h"

namespace simvis {
namespace {

using Json = nlohmann::ordered_json;

/// A value that an attribute table may leave out.
Json given(std::string_view text) { return text.empty() ? Json(nullptr) : Json(text); }
Json given(double limit) { return std::isfinite(limit) ? Json(limit) : Json(nullptr); }

Json attribute_json(const AttributeSpec& spec) {
  Json json = {{"name", spec.name},
               {"kind", kind_text(spec.kind)},
               {"default", given(spec.default_value)},
               {"unit", given(spec.unit)},
               {"min", given(spec.min)},
               {"max", given(spec.max)},
               {"open_min", spec.open_min},
               {"open_max", spec.open_max},
               {"choices", Json::array()},
               {"live", spec.live},
               {"text", spec.text}};
  if (spec.kind == AttributeKind::choice || spec.kind == AttributeKind::flags) {
    json["choices"] = words_of(spec.choices);
  }
  return json;
}

Json attributes_json(AttributeTable table) {
  Json list = Json::array();
  for (const AttributeSpec& spec : table) list.push_back(attribute_json(spec));
  return list;
}

Json paragraphs_json(std::string_view notes) {
  Json list = Json::array();
  for (const std::string_view paragraph : words_of(notes, "\n")) list.push_back(paragraph);
  return list;
}

Json preset_json(const SensorPreset& preset) {
  Json json = {
      {"name", preset.name}, {"summary", preset.summary}, {"source", preset.source}, {"attributes", Json::object()}};
  for (const PresetAttribute& each : preset.attributes) json["attributes"][std::string(each.name)] = each.value;
  return json;
}

Json type_json(const CommandForm& form) {
  Json json = {{"name", form.name}, {"summary", form.summary}, {"attributes", attributes_json(form.attributes)}};
  json["required"] = form.required;
  return json;
}

Json type_json(const ElementType& type) {
  return {{"name", type.name},
          {"summary", type.summary},
          {"notes", paragraphs_json(type.notes)},
          {"attributes", attributes_json(type.attributes)}};
}

Json type_json(const SensorType& type) {
  Json json = {{"name", type.name},
               {"summary", type.summary},
               {"notes", paragraphs_json(type.notes)},
               {"attributes", attributes_json(all_attributes(type))},
               {"outputs", Json::array()},
               {"presets", Json::array()}};
  for (const OutputSpec& output : all_outputs(type)) {
    json["outputs"].push_back(output_json(output));
    json["outputs"].back()["when"] = given(output.when);
  }
  for (const SensorPreset& preset : type.presets) json["presets"].push_back(preset_json(preset));
  return json;
}

Json type_json(const EffectType& type) {
  return {{"name", type.name},     {"summary", type.summary},     {"notes", paragraphs_json(type.notes)},
          {"source", type.source}, {"reference", type.reference}, {"attributes", attributes_json(type.attributes)}};
}

template <typename Types>
Json list_json(const Types& types) {
  Json list = Json::array();
  for (const auto* const type : types) list.push_back(type_json(*type));
  return list;
}

}  // namespace

std::string to_json(const DescribedTypes& types) {
  const Json json = {{"commands", list_json(types.commands)},
                     {"elements", list_json(types.elements)},
                     {"sensors", list_json(types.sensors)},
                     {"effects", list_json(types.effects)}};
  return json.dump(2) + "\n";
}

}  // namespace simvis
