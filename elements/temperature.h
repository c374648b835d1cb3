// The element `temperature`: how warm the shapes of parts are and how well they emit, for thermal cameras.
//
//   <element type="temperature" name="ENGINE" insert_at="ROOT" part="CAR" material="Hood" temperature="350"/>
//   <element type="temperature" name="PEOPLE" insert_at="ROOT" parts="PERSON_*" temperature="306" emissivity="0.98"/>
//   <element type="temperature" name="STOVE" insert_at="ROOT" part="STOVE" texture="plates.png" temperature="295"
//            temperature_white="620"/>
//
// Reach    see shape_selection.h; what was inserted at a part has temperatures of its own.
// Units    kelvin: 0 degrees Celsius are 273.15 K.
// Parameters  temperature, temperature_white (with a texture only) and emissivity are live.
// Texture  a grey picture on the texture coordinates of the shape's material: black is `temperature`, white is
//          `temperature_white`, and its values between them are proportional to the 8-bit codes. Of colours the mean of
//          the three codes counts.
// Special  Shapes without this element have the temperature of the surroundings and are black bodies.
#pragma once

#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include <simvis/surface_heat.h>
#include "elements/shape_selection.h"

namespace simvis {

/// The heat of the shapes that an element selects.
struct SelectedHeat {
  std::string element;    ///< its name
  ShapeSelection shapes;  ///< that have the temperature
  SurfaceHeat heat;       ///< as the last update() says
};

/// Those of a scene, in any order. Valid until an element `temperature` is made or removed.
std::vector<const SelectedHeat*> temperatures_of(const Scene& scene);

/// What a command `temperature` says of the shapes.
struct TemperatureDesc {
  std::string texture;  ///< a file; empty: none
  double temperature_k = 293.15, emissivity = 1;
  double white_k = 293.15;  ///< with a texture, where it is white

  bool has_texture() const { return !texture.empty(); }
};

class TemperatureElement : public Element {
 public:
  /// Throws InputError at the attribute: no such material or name, a pattern that matches nothing, a part that has a
  /// temperature already, a picture that cannot be read, or temperature_white without a picture.
  explicit TemperatureElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

 private:
  TemperatureDesc desc_;
  std::shared_ptr<SelectedHeat> selected_;
};

}  // namespace simvis
