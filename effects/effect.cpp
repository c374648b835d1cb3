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

std::vector<EffectFact> effect_facts(const EffectType& type) {
  std::string shown;
  for (const auto& [output, name] :
       {std::pair(kShownInColor, "colour"), {kShownInDepth, "depth"}, {kShownInRanges, "ranges"}}) {
    if ((type.outputs & output) != 0) shown += (shown.empty() ? "" : ", ") + std::string(name);
  }
  std::vector<EffectFact> facts{{"called for by", std::string(type.source)},
                                {"shown in", shown},
                                {"sensors", std::string(type.sensors)},
                                {"accuracy knob", std::string(type.knob)},
                                {"compared with", std::string(type.reference)}};
  std::erase_if(facts, [](const EffectFact& fact) { return fact.value.empty(); });
  return facts;
}

std::string describe_effect(const EffectType& type) {
  std::string text = describe(type.name, type.summary, type.attributes, type.notes);
  for (const EffectFact& fact : effect_facts(type)) text += "  " + std::string(fact.label) + ": " + fact.value + '\n';
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

void plan_frame_effects(const DrawList& list, const TargetLimits& limits, FramePlan& plan) {
  for (const EffectType* effect : effect_types()) {
    if (effect->plan_frame != nullptr) effect->plan_frame(list, limits, plan);
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
