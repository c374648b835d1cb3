#include <simvis/camera_effect.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <shared_mutex>

#include "scenegraph/language/registrations.h"

namespace simvis {
namespace {

struct Registry {
  std::shared_mutex mutex;  // guards types: a plug-in may be loaded while other threads create sensors
  std::map<std::string_view, CameraEffectType> types;
};

Registry& registry() {
  static Registry all;
  return all;
}

std::vector<const CameraEffectType*> types_in_order(std::uint8_t capabilities) {
  const std::shared_lock lock(registry().mutex);
  std::vector<const CameraEffectType*> types;
  for (const auto& [name, type] : registry().types) {
    if (may_have(capabilities, type.type)) types.push_back(&type);
  }
  std::ranges::stable_sort(types, {}, &CameraEffectType::order);
  return types;
}

}  // namespace

CameraEffectRegistration::CameraEffectRegistration(const CameraEffectType& type, std::string_view built_for) {
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

std::vector<ChosenCameraEffect> camera_effects(std::uint8_t capabilities, const CameraEffectContext& context) {
  std::vector<ChosenCameraEffect> chosen;
  for (const CameraEffectType* type : types_in_order(capabilities)) {
    // The effect is created even if no output shows it, so that its attributes are checked.
    std::shared_ptr<const CameraEffect> effect = type->create(context);
    const bool shown = (type->type.outputs & context.outputs) != 0;
    if (effect && shown) chosen.push_back({find_effect_type(type->type.name), std::move(effect)});
  }
  return chosen;
}

}  // namespace simvis
