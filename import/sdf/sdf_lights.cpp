#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/srgb.h"
#include "import/model/model_light.h"
#include "import/sdf/sdf_command.h"

namespace simvis {
namespace {

void add_linear_color(const glm::dvec4& color, const char* const (&names)[3], SdfCommand& command) {
  for (int i = 0; i < 3; ++i) command.add(names[i], decode_srgb(color[i]));
}

// What remains of SDF's light at a distance, as a factor.
double sdf_attenuation(const SdfElement& attenuation, double distance_m) {
  const double constant = attenuation.child("constant").number(1), linear = attenuation.child("linear").number(1);
  const double quadratic = attenuation.child("quadratic").number(0);
  const double divisor = constant + distance_m * (linear + distance_m * quadratic);
  if (!(divisor > 0)) attenuation.fail("has factors that are not allowed, expected a sum above 0");
  return 1 / divisor;
}

double intensity_cd(const SdfElement& light, double intensity, double range_m) {
  const double distance_m = std::min(kSdfLightDistance_m, range_m / 2);
  const double kept = sdf_attenuation(light.child("attenuation"), distance_m);
  return std::numbers::pi * intensity * kept * distance_m * distance_m;
}

glm::dvec3 direction_of(const SdfElement& light, const glm::dmat4& point_from_light) {
  const glm::dvec3 direction = light.child("direction").vector(glm::dvec3(0, 0, -1));
  const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  if (!(largest > 0)) light.fail("has a <direction> without length");
  return glm::normalize(glm::dvec3(point_from_light * glm::dvec4(direction / largest, 0)));
}

ModelLight::Kind kind_of_light(const SdfElement& light) {
  const std::string type = light.attribute("type");
  if (type == "point") return ModelLight::Kind::point;
  if (type == "spot") return ModelLight::Kind::spot;
  if (type == "directional") return ModelLight::Kind::directional;
  light.fail("has the type " + in_quotes(type) + ", expected point, spot or directional");
}

}  // namespace

std::string sdf_light_command(const SdfElement& light, const SdfPlace& place, const glm::dmat4& point_from_light,
                              ImportReport& report) {
  ModelLight made;
  made.kind = kind_of_light(light);
  made.color = glm::dvec3(light.child("diffuse").color(glm::dvec4(1), report));
  made.direction = direction_of(light, point_from_light);
  made.position_m = glm::dvec3(point_from_light[3]);
  made.has_shadows = light.child("cast_shadows").flag(false);
  double intensity = light.child("intensity").number(1);
  if (!light.child("light_on").flag(true)) intensity = 0;
  if (made.kind == ModelLight::Kind::directional) {
    // As Ogre2Light::SetIntensity() of gz-rendering (commit dafbffa), which multiplies by pi.
    made.intensity = std::numbers::pi * intensity;
    return light_command(made, place.name, place.insert_at);
  }
  made.range_m = light.child("attenuation").child("range").number(10);
  if (!(made.range_m > 0)) light.fail("has a <range> that is not above 0");
  made.intensity = intensity_cd(light, intensity, made.range_m);
  const SdfElement spot = light.child("spot");
  made.inner_rad = spot.child("inner_angle").number(0) / 2;
  made.outer_rad = spot.child("outer_angle").number(0) / 2;
  return light_command(made, place.name, place.insert_at);
}

std::optional<std::string> sdf_sky_command(const SdfElement& scene, const SdfPlace& place, ImportReport& report) {
  const SdfElement background = scene.child("background"), ambient = scene.child("ambient");
  if (!background && !ambient) return std::nullopt;
  SdfCommand command(CommandKind::element, "sky", place);
  if (background) add_linear_color(background.color(glm::dvec4(1), report), {"red", "green", "blue"}, command);
  // gz-sim takes the numbers as linear and shows a white surface in ambient light A as A / pi: gz-rendering (commit
  // dafbffa) passes them on in Ogre2Scene::SetAmbientLight(), and OGRE's diffuse colour is that of the surface by pi.
  if (ambient) {
    const glm::dvec4 light = ambient.color(glm::dvec4(1), report) / std::numbers::pi;
    constexpr const char* kNames[] = {"ambient_red", "ambient_green", "ambient_blue"};
    for (int i = 0; i < 3; ++i) command.add(kNames[i], light[i]);
  }
  return command.text();
}

}  // namespace simvis
