#include "effects/effect.h"

#include "scenegraph/type_registry.h"

namespace simvis {
namespace {

TypeRegistry<EffectType>& registry() {
  static TypeRegistry<EffectType> types("effect");
  return types;
}

// Whether `word` is one of those in `words`, which spaces separate.
bool is_among(std::string_view word, std::string_view words) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return false;
}

}  // namespace

EffectRegistration::EffectRegistration(const EffectType& type) { registry().add(type); }

std::vector<const EffectType*> effect_types() { return registry().sorted(); }

const EffectType* find_effect_type(std::string_view name) { return registry().find(name); }

void plan_scene_effects(const std::string& sensor, EffectOutput output, const DrawList& list, FramePlan& plan) {
  for (const EffectType* type : effect_types()) {
    if ((type->outputs & output) == 0 || type->called_for == nullptr || !type->called_for(list)) continue;
    plan.effects.push_back({sensor, std::string(type->name), std::string(type->source)});
  }
}

std::vector<AttributeSpec> with_effect_attributes(std::string_view sensor_type, AttributeTable own) {
  std::vector<AttributeSpec> table(own.begin(), own.end());
  for (const EffectType* effect : effect_types()) {
    if (!is_among(sensor_type, effect->sensors)) continue;
    table.insert(table.end(), effect->attributes.begin(), effect->attributes.end());
  }
  return table;
}

}  // namespace simvis
