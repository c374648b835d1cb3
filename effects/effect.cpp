#include <simvis/effect.h>

#include <algorithm>

#include "scenegraph/language/type_registry.h"

namespace simvis {
namespace {

TypeRegistry<EffectType>& registry() {
  static TypeRegistry<EffectType> types("effect");
  return types;
}

}  // namespace

EffectRegistration::EffectRegistration(const EffectType& type, std::string_view built_for)
    : accepted(registry().add(type, built_for)) {}

std::vector<const EffectType*> effect_types() { return registry().sorted(); }

const EffectType* find_effect_type(std::string_view name) { return registry().find(name); }

std::string describe_effect(const EffectType& type) {
  std::string shown;
  for (const auto& [output, name] :
       {std::pair(kShownInColor, "colour"), {kShownInDepth, "depth"}, {kShownInRanges, "ranges"}}) {
    if ((type.outputs & output) != 0) shown += (shown.empty() ? "" : ", ") + std::string(name);
  }
  std::string text = describe(type.name, type.summary, type.attributes);
  const auto add = [&](std::string_view what, std::string_view value) {
    if (!value.empty()) text += "  " + std::string(what) + ": " + std::string(value) + '\n';
  };
  add("called for by", type.source);
  add("shown in", shown);
  add("of sensors", type.sensors);
  add("accuracy for time", type.knob);
  add("held against", type.reference);
  return text;
}

bool may_have(std::string_view sensor_type, const EffectType& effect) {
  const std::string types = ' ' + std::string(effect.sensors) + ' ';
  return types.find(' ' + std::string(sensor_type) + ' ') != std::string::npos;
}

void plan_scene_effects(const std::string& sensor, std::size_t first_pass, const DrawList& list, FramePlan& plan) {
  const auto first = plan.passes.begin() + static_cast<std::ptrdiff_t>(first_pass);
  if (std::none_of(first, plan.passes.end(), [](const Pass& pass) { return pass.color; })) return;
  for (const EffectType* effect : effect_types()) {
    if (effect->in_scene == nullptr || !effect->in_scene(list)) continue;
    plan.effects.push_back({sensor, std::string(effect->name), std::string(effect->source)});
  }
}

std::vector<AttributeSpec> with_effect_attributes(std::string_view sensor_type, AttributeTable own) {
  std::vector<AttributeSpec> table(own.begin(), own.end());
  for (const EffectType* effect : effect_types()) {
    if (!may_have(sensor_type, *effect)) continue;
    table.insert(table.end(), effect->attributes.begin(), effect->attributes.end());
  }
  return table;
}

}  // namespace simvis
