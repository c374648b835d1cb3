#include "import/programs/inventor/inventor_lights.h"

#include <Inventor/VRMLnodes/SoVRMLDirectionalLight.h>
#include <Inventor/VRMLnodes/SoVRMLPointLight.h>
#include <Inventor/VRMLnodes/SoVRMLSpotLight.h>
#include <Inventor/nodes/SoDirectionalLight.h>
#include <Inventor/nodes/SoPointLight.h>
#include <Inventor/nodes/SoSpotLight.h>

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <numbers>
#include <utility>

#include "import/programs/inventor/inventor_look.h"
#include "import/programs/inventor/inventor_shapes.h"

namespace simvis {
namespace {

// A white diffuse surface has the radiance irradiance / pi. Inventor's intensity is the radiance of such a surface.
constexpr double kLuxPerIntensity = std::numbers::pi;

glm::dvec3 dvec3_of(const SoSFVec3f& field) {
  const SbVec3f& v = field.getValue();
  return {v[0], v[1], v[2]};
}

glm::dvec3 direction_of(const SoSFVec3f& field) {
  const glm::dvec3 v = dvec3_of(field);
  return v == glm::dvec3(0) ? glm::dvec3(0, 0, -1) : glm::normalize(v);
}

// The engine needs an outer cone that is not empty and an inner cone within it.
void set_cone(double inner_rad, double outer_rad, Light& light) {
  constexpr double kNarrowest_rad = 1e-3, kInnerShare = 0.999;
  light.kind = LightKind::spot;
  light.outer_cone_rad = std::clamp(outer_rad, kNarrowest_rad, std::numbers::pi / 2);
  light.inner_cone_rad = std::clamp(inner_rad, 0.0, light.outer_cone_rad * kInnerShare);
}

// Both overloads set the position and the properties that depend on the kind of light. They return false for a kind
// that SimVis does not support.
bool convert(const SoLight& source, Light& light, glm::dvec3& place) {
  if (const auto* directional = dynamic_cast<const SoDirectionalLight*>(&source)) {
    light.direction = direction_of(directional->direction);
  } else if (const auto* point = dynamic_cast<const SoPointLight*>(&source)) {
    light.kind = LightKind::point;
    place = dvec3_of(point->location);
  } else if (const auto* spot = dynamic_cast<const SoSpotLight*>(&source)) {
    const double outer_rad = spot->cutOffAngle.getValue();
    set_cone(outer_rad * (1 - static_cast<double>(spot->dropOffRate.getValue())), outer_rad, light);
    light.direction = direction_of(spot->direction);
    place = dvec3_of(spot->location);
  } else {
    return false;
  }
  return true;
}

bool convert(const SoVRMLLight& source, Light& light, glm::dvec3& place) {
  if (const auto* directional = dynamic_cast<const SoVRMLDirectionalLight*>(&source)) {
    light.direction = direction_of(directional->direction);
  } else if (const auto* point = dynamic_cast<const SoVRMLPointLight*>(&source)) {
    light.kind = LightKind::point;
    light.range_m = point->radius.getValue();
    place = dvec3_of(point->location);
  } else if (const auto* spot = dynamic_cast<const SoVRMLSpotLight*>(&source)) {
    set_cone(spot->beamWidth.getValue(), spot->cutOffAngle.getValue(), light);
    light.direction = direction_of(spot->direction);
    light.range_m = spot->radius.getValue();
    place = dvec3_of(spot->location);
  } else {
    return false;
  }
  return true;
}

template <class AnyLight>
void add(SoCallbackAction& action, const AnyLight& source, ImportedScene& scene) {
  if (source.on.getValue() == 0) return;
  Light light;
  glm::dvec3 place(0);
  if (!convert(source, light, place)) return;
  const SbColor& color = source.color.getValue();
  light.color = linear_of_display_color({color[0], color[1], color[2]});
  light.intensity = kLuxPerIntensity * std::max(0.0, static_cast<double>(source.intensity.getValue()));
  const glm::dmat4 part_from_light = glm::translate(matrix_of(action.getModelMatrix()), place);
  ImportedNode node;
  node.name = innermost_name(action);
  node.parent_from_node = part_from_light;
  node.light = light;
  scene.nodes.push_back(std::move(node));
}

}  // namespace

void add_inventor_light(SoCallbackAction& action, const SoLight& light, ImportedScene& scene) {
  add(action, light, scene);
}

void add_inventor_light(SoCallbackAction& action, const SoVRMLLight& light, ImportedScene& scene) {
  add(action, light, scene);
}

}  // namespace simvis
