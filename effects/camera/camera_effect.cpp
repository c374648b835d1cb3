#include <simvis/camera_effect.h>

#include <algorithm>

#include "effects/effect_registry.h"

namespace simvis {
namespace {

EffectRegistry<CameraEffectType>& camera_effect_registry() {
  static EffectRegistry<CameraEffectType> all;
  return all;
}

}  // namespace

CameraEffectRegistration::CameraEffectRegistration(const CameraEffectType& type, std::string_view built_for) {
  camera_effect_registry().add(type, built_for);
}

std::vector<ChosenCameraEffect> camera_effects(std::uint8_t capabilities, const CameraEffectContext& context) {
  std::vector<ChosenCameraEffect> chosen;
  for (const CameraEffectType* type : camera_effect_registry().in_order(capabilities)) {
    // The effect is created even if no output shows it, so that its attributes are checked.
    std::shared_ptr<const CameraEffect> effect = type->create(context);
    const bool shown = (type->type.outputs & context.outputs) != 0;
    if (effect && shown) chosen.push_back({find_effect_type(type->type.name), std::move(effect)});
  }
  return chosen;
}

}  // namespace simvis
