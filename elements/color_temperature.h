// The element `color_temperature`: gives a light element the colour of a black body.
//
//   <element type="color_temperature" name="DUSK" insert_at="ROOT" light="SUN" kelvin="3500"/>
//
// Parameters  kelvin (live). The light's own colour is multiplied by the body's, so that both can change; its luminance
//          (Rec. 709) stays what it was.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

/// The colour of a black body: linear sRGB (Rec. 709 primaries, white point D65) of luminance 1, that is
/// 0.2126 r + 0.7152 g + 0.0722 b = 1 before channels below 0 are cut to 0. Below about 1900 K blue is cut: such a
/// red lies outside sRGB. 1000 K to 40000 K; chromaticities x and y are within 0.003 of tables from 2000 K up.
///
/// Planck's law is integrated with the CIE 1931 colour matching functions as fitted by Wyman, Sloan and Shirley,
/// Simple Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2 (2), 2013 (multi-lobe fit).
glm::dvec3 black_body_color(double temperature_k);

class ColorTemperatureElement : public Element {
 public:
  /// Throws InputError at the attribute: no such element, one that is no light, one that has a temperature already.
  explicit ColorTemperatureElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::shared_ptr<LightNode> light_;
};

}  // namespace simvis
