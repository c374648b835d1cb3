#include <simvis/camera_effect.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scenegraph/language/registrations.h"

namespace simvis {
namespace {

std::map<std::string_view, CameraEffectType>& registry() {
  static std::map<std::string_view, CameraEffectType> types;
  return types;
}

}  // namespace

CameraEffectRegistration::CameraEffectRegistration(const CameraEffectType& type, std::string_view built_for) {
  if (!EffectRegistration(type.type, built_for).accepted) return;
  registry().emplace(type.type.name, type);
  Registrations::instance().accept([name = type.type.name] { registry().erase(name); });
}

std::vector<ChosenCameraEffect> camera_effects(std::string_view sensor_type, const CameraEffectContext& context) {
  std::vector<const CameraEffectType*> types;
  for (const auto& [name, type] : registry()) {
    if (may_have(sensor_type, type.type)) types.push_back(&type);
  }
  std::ranges::stable_sort(types, {}, &CameraEffectType::order);
  std::vector<ChosenCameraEffect> chosen;
  for (const CameraEffectType* type : types) {
    // Made even where no output shows it: its attributes may be wrong.
    std::shared_ptr<const CameraEffect> effect = type->create(context);
    const bool shown = (type->type.outputs & context.outputs) != 0;
    if (effect && shown) chosen.push_back({find_effect_type(type->type.name), std::move(effect)});
  }
  return chosen;
}

}  // namespace simvis
