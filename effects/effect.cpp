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

EffectRegistration::EffectRegistration(const EffectType& type) { registry().add(type); }

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

std::string example_commands(const EffectType& effect, std::string_view commands) {
  constexpr std::string_view kMark = "EFFECT";
  const std::string name = std::string(kMark) + '_' + std::string(effect.name);
  std::string text(commands);
  for (std::size_t at = text.find(kMark); at != text.npos; at = text.find(kMark, at + name.size())) {
    text.replace(at, kMark.size(), name);
  }
  return text;
}

std::string join_attributes(std::string_view a, std::string_view b) {
  std::string joined(a);
  while (true) {
    const std::size_t name = b.find_first_not_of(' '), equals = b.find('='), open = b.find('"');
    const std::size_t close = open == b.npos ? b.npos : b.find('"', open + 1);
    if (close == b.npos) return joined;
    const std::string written = ' ' + std::string(b.substr(name, equals - name)) + '=';
    if ((' ' + joined).find(written) == std::string::npos)
      joined += ' ' + std::string(b.substr(name, close + 1 - name));
    b.remove_prefix(close + 1);
  }
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
