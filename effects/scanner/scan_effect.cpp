#include <simvis/scan_effect.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <tuple>

#include "scenegraph/language/registrations.h"

namespace simvis {
namespace {

struct Registry {
  std::shared_mutex mutex;  // guards types: a plug-in may be loaded while other threads create sensors
  std::map<std::string_view, ScanEffectType> types;
};

Registry& registry() {
  static Registry all;
  return all;
}

std::vector<const ScanEffectType*> types_in_order() {
  const std::shared_lock lock(registry().mutex);
  std::vector<const ScanEffectType*> types;
  for (const auto& [name, type] : registry().types) {
    if (may_have(kCastsBeams, type.type)) types.push_back(&type);
  }
  std::ranges::stable_sort(types, {}, &ScanEffectType::order);
  return types;
}

}  // namespace

ScanEffectRegistration::ScanEffectRegistration(const ScanEffectType& type, std::string_view built_for) {
  if (!EffectRegistration(type.type, built_for).accepted) return;
  {
    const std::lock_guard lock(registry().mutex);
    registry().types.emplace(type.type.name, type);
  }
  Registrations::instance().accept([name = type.type.name] {
    const std::lock_guard lock(registry().mutex);
    registry().types.erase(name);
  });
}

std::vector<ChosenScanEffect> scan_effects(const ScanEffectContext& context) {
  std::vector<ChosenScanEffect> chosen;
  for (const ScanEffectType* type : types_in_order()) {
    if (std::shared_ptr<const ScanEffect> effect = type->create(context)) {
      chosen.push_back({find_effect_type(type->type.name), std::move(effect), type->called_for});
    }
  }
  return chosen;
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
