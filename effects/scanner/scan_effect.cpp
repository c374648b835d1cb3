#include <simvis/scan_effect.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "scenegraph/language/registrations.h"

namespace simvis {
namespace {

std::map<std::string_view, ScanEffectType>& registry() {
  static std::map<std::string_view, ScanEffectType> types;
  return types;
}

}  // namespace

ScanEffectRegistration::ScanEffectRegistration(const ScanEffectType& type, std::string_view built_for) {
  if (!EffectRegistration(type.type, built_for).accepted) return;
  registry().emplace(type.type.name, type);
  Registrations::instance().accept([name = type.type.name] { registry().erase(name); });
}

std::vector<ChosenScanEffect> scan_effects(const ScanEffectContext& context) {
  std::vector<const ScanEffectType*> types;
  for (const auto& [name, type] : registry()) types.push_back(&type);
  std::ranges::stable_sort(types, {}, &ScanEffectType::order);
  std::vector<ChosenScanEffect> chosen;
  for (const ScanEffectType* type : types) {
    if (std::shared_ptr<const ScanEffect> effect = type->create(context)) {
      chosen.push_back({find_effect_type(type->type.name), std::move(effect), type->called_for});
    }
  }
  return chosen;
}

}  // namespace simvis
