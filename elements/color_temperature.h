// The element `color_temperature`: gives a light element the colour of a black body.
//
//   <element type="color_temperature" name="DUSK" insert_at="ROOT" light="SUN" kelvin="3500"/>
//
// Parameters  kelvin (live). The light's own colour is multiplied by the black body's colour, so that both can change.
//          The black body's colour has luminance 1 (Rec. 709), so a white light keeps its luminance. Below
//          1900 K blue would be below 0 and is set to 0, which adds up to 0.7 %.
#pragma once

#include <memory>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

/// Returns the colour of a black body as linear sRGB (Rec. 709 primaries, white point D65). Its luminance is 1, that is
/// 0.2126 r + 0.7152 g + 0.0722 b = 1, before negative channels are set to 0. Below about 1900 K blue is negative,
/// because such a red lies outside sRGB. Valid from 1000 K to 40000 K. From 2000 K up the chromaticities x and y are
/// within 0.003 of tables.
///
/// Planck's law is integrated with the CIE 1931 colour matching functions in the multi-lobe fit of Wyman, Sloan and
/// Shirley, Simple Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2 (2), 2013.
glm::dvec3 black_body_color(double temperature_k);

class ColorTemperatureElement : public Element {
 public:
  /// Throws InputError at the attribute if the element does not exist, is not a light or has a colour temperature
  /// already.
  explicit ColorTemperatureElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::vector<std::shared_ptr<LightNode>> lights_;  // of the light element
};

}  // namespace simvis
