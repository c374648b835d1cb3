#include "elements/color_temperature.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "elements/light.h"

namespace simvis {
namespace {

constexpr AttributeSpec kColorTemperatureAttributes[] = {
    {.name = "light", .kind = AttributeKind::element, .text = "required: the light element"},
    {.name = "kelvin",
     .default_value = "6500",
     .unit = "K",
     .text = "temperature of the black body; candle 1900, lamp 2850, noon 5800",
     .min = 1000,
     .max = 40000,
     .live = true},
};

const ElementRegistration kColorTemperatureRegistration({
    .name = "color_temperature",
    .summary = "Gives a light element the colour of a black body.",
    .notes = "The colour follows from Planck's law and the CIE 1931 colour matching functions. A white light "
             "keeps its luminance; below 1900 K, where blue would be below 0 and is set to 0, it gains up to 0.7 %.",
    .attributes = kColorTemperatureAttributes,
    .create = create_element<ColorTemperatureElement>,
});

// One lobe of the fit: a bell curve of height 1 around `center`, with a different slope on each side. Wavelengths are
// in nm, slopes in 1/nm.
double lobe(double wavelength, double center, double slope_below, double slope_above) {
  const double t = (wavelength - center) * (wavelength < center ? slope_below : slope_above);
  return std::exp(-0.5 * t * t);
}

glm::dvec3 color_matching(double nm) {
  return {0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

// Returns CIE XYZ up to a factor. The integrand is smooth and vanishes towards both ends. For such an integrand the
// trapezoidal rule converges faster than any power of the step.
glm::dvec3 planckian_xyz(double temperature_k) {
  constexpr double kSecondRadiation_nm_k = 1.438776877e7;  // h c / k, CODATA 2018
  constexpr int kFirst_nm = 360, kLast_nm = 830;
  glm::dvec3 xyz(0);
  for (int nm = kFirst_nm; nm <= kLast_nm; ++nm) {
    const double relative = nm / 560.0;  // keeps the numbers near 1
    const double radiance = std::pow(relative, -5) / std::expm1(kSecondRadiation_nm_k / (nm * temperature_k));
    xyz += radiance * color_matching(nm);
  }
  return xyz;
}

void set_tint(std::span<const std::shared_ptr<LightNode>> lights, const glm::vec3& tint) {
  for (const std::shared_ptr<LightNode>& light : lights) light->set_tint(tint);
}

}  // namespace

glm::dvec3 black_body_color(double temperature_k) {
  // In rows, computed from the chromaticities of Rec. 709 and D65.
  constexpr double kRgbFromXyz[3][3] = {
      {3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}};
  glm::dvec3 xyz = planckian_xyz(temperature_k);
  xyz /= xyz.y;
  glm::dvec3 rgb;
  for (int i = 0; i < 3; ++i) {
    const double* const row = kRgbFromXyz[i];
    rgb[i] = std::max(0.0, row[0] * xyz.x + row[1] * xyz.y + row[2] * xyz.z);
  }
  return rgb;
}

ColorTemperatureElement::ColorTemperatureElement(const ElementContext& context) {
  const CommandAttribute& name = context.command.require("light");
  const auto* const light = dynamic_cast<const LightElement*>(context.find_element(name.value));
  if (light == nullptr) {
    fail_at(name.where, "attribute \"light\": the element " + in_quotes(name.value) +
                            " is not a light, expected the name of a light element");
  }
  lights_ = light->nodes();
  // A tint other than white is set: no black body has exactly the colour (1, 1, 1).
  if (lights_[0]->tint() != glm::vec3(1)) {
    fail_at(name.where, "attribute \"light\": " + in_quotes(name.value) + " already has a colour temperature");
  }
  // An empty node that marks the position of the element in the graph.
  context.scene.insert(context.command, std::make_shared<Separator>());
  context.scene.undo().add([lights = lights_] { set_tint(lights, glm::vec3(1)); });
}

void ColorTemperatureElement::update(ParameterView values) {
  set_tint(lights_, glm::vec3(black_body_color(values[0])));
}

}  // namespace simvis
