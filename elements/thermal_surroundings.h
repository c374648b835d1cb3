// The element `thermal_surroundings`: the temperatures of what stands around a scene, for thermal cameras.
//
//   <element type="thermal_surroundings" name="WEATHER" insert_at="ROOT" ambient="283" sky="250"/>
//
// Units    kelvin: 0 degrees Celsius are 273.15 K.
// Parameters  ambient and sky are live. Surfaces reflect a black body of the temperature `ambient` on all sides, and
//          those that no element `temperature` names have this temperature themselves. Where nothing is hit a camera
//          sees a black body of the temperature `sky`.
// Several  A scene has at most one.
#pragma once

#include <memory>

#include <simvis/element.h>
#include <simvis/node.h>
#include <simvis/surface_heat.h>

namespace simvis {

/// The surroundings of a scene. The pointer is valid until an element of this type is made or removed; null: there is
/// none.
const ThermalSurroundings* thermal_surroundings_of(const Scene& scene);

class ThermalSurroundingsElement : public Element {
 public:
  /// Throws InputError if the scene has one already.
  explicit ThermalSurroundingsElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<ThermalSurroundings> surroundings_;
};

}  // namespace simvis
