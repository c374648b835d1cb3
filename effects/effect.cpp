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

std::vector<const EffectType*> effects_in_scene(const DrawList& list, std::uint8_t outputs) {
  std::vector<const EffectType*> found;
  for (const EffectType* effect : effect_types()) {
    if (effect->in_scene && (effect->outputs & outputs) != 0 && effect->in_scene(list)) found.push_back(effect);
  }
  return found;
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
