#include <simvis/scan_effect.h>

#include <algorithm>
#include <iterator>

#include "effects/effect_registry.h"

namespace simvis {
namespace {

EffectRegistry<ScanEffectType>& scan_effect_registry() {
  static EffectRegistry<ScanEffectType> all;
  return all;
}

}  // namespace

ScanEffectRegistration::ScanEffectRegistration(const ScanEffectType& type, std::string_view built_for) {
  scan_effect_registry().add(type, built_for);
}

std::vector<ChosenScanEffect> scan_effects(const ScanEffectContext& context) {
  std::vector<ChosenScanEffect> chosen;
  for (const ScanEffectType* type : scan_effect_registry().in_order(kCastsBeams)) {
    if (std::shared_ptr<const ScanEffect> effect = type->create(context)) {
      chosen.push_back({find_effect_type(type->type.name), std::move(effect), type->called_for});
    }
  }
  return chosen;
}

std::vector<OutputSpec> scan_effect_outputs(const ScanEffectContext& context) {
  std::vector<OutputSpec> outputs;
  for (const ScanEffectType* type : scan_effect_registry().in_order(kCastsBeams)) {
    if (type->columns.empty()) continue;
    const bool given = type->create(context) != nullptr;
    for (OutputSpec& output : column_outputs(type->columns, OutputKind::scan_column, {context.rings, context.beams})) {
      output.message = kPointsMessage;
      output.when = type->type.source;
      output.given = given;
      outputs.push_back(std::move(output));
    }
  }
  return outputs;
}

bool any_traces(std::span<const ChosenScanEffect> effects) {
  return std::ranges::any_of(effects, [](const ChosenScanEffect& each) { return each.effect->traces(); });
}

std::vector<ChosenScanEffect> called_for(std::span<const ChosenScanEffect> effects, const DrawList& list) {
  std::vector<ChosenScanEffect> active;
  std::ranges::copy_if(effects, std::back_inserter(active), [&](const ChosenScanEffect& each) {
    return each.called_for == nullptr || each.called_for(list);
  });
  if (!any_traces(active)) {
    std::erase_if(active, [](const ChosenScanEffect& each) { return each.effect->only_traced(); });
  }
  return active;
}

}  // namespace simvis
