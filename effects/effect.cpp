#include <simvis/effect.h>

#include <algorithm>

#include "scenegraph/language/type_registry.h"

namespace simvis {
namespace {

TypeRegistry<EffectType>& effect_registry() {
  static TypeRegistry<EffectType> types("effect");
  return types;
}

}  // namespace

EffectRegistration::EffectRegistration(const EffectType& type, std::string_view built_for)
    : accepted(effect_registry().add(type, built_for)) {}

std::vector<const EffectType*> effect_types() { return effect_registry().sorted(); }

const EffectType* find_effect_type(std::string_view name) { return effect_registry().find(name); }

bool may_have(std::uint8_t capabilities, const EffectType& effect) {
  return effect.needs != 0 && (capabilities & effect.needs) == effect.needs;
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

std::vector<AttributeSpec> with_effect_attributes(std::uint8_t capabilities, AttributeTable own) {
  std::vector<AttributeSpec> table(own.begin(), own.end());
  for (const EffectType* effect : effect_types()) {
    if (!may_have(capabilities, *effect)) continue;
    table.insert(table.end(), effect->attributes.begin(), effect->attributes.end());
  }
  return table;
}

}  // namespace simvis
