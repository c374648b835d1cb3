#include "import/model/model_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "import/model/file_command.h"

namespace simvis {
namespace {

constexpr double kMaxLightIntensity = 1e12;  // of the element `light`

double in_degrees(double rad) { return rad * 180 / std::numbers::pi; }
double elevation_of(const glm::dvec3& unit) { return in_degrees(std::asin(std::clamp(unit.z, -1.0, 1.0))); }
// Adding 0 turns -0 into 0, so that a light straight above has the azimuth 0.
double azimuth_of(const glm::dvec3& unit) { return in_degrees(std::atan2(unit.y + 0.0, unit.x + 0.0)); }

const char* name_of(ModelLight::Kind kind) {
  if (kind == ModelLight::Kind::directional) return "directional";
  return kind == ModelLight::Kind::point ? "point" : "spot";
}

}  // namespace

std::string light_command(const ModelLight& light, const std::string& name, const std::string& insert_at) {
  FileCommand command(CommandKind::element, "light", name, insert_at);
  command.add("kind", name_of(light.kind));
  constexpr const char* kColors[] = {"red", "green", "blue"};
  for (int i = 0; i < 3; ++i) command.add(kColors[i], decode_srgb(light.color[i]));
  command.add("intensity", std::clamp(light.intensity, 0.0, kMaxLightIntensity));
  if (light.kind == ModelLight::Kind::directional) {
    command.add("azimuth", azimuth_of(-light.direction));
    command.add("elevation", elevation_of(-light.direction));
  } else {
    command.add("range", light.range_m <= kMaxCoordinate_m ? light.range_m : 0);
    command.add("x", light.position_m.x);
    command.add("y", light.position_m.y);
    command.add("z", light.position_m.z);
  }
  if (light.kind == ModelLight::Kind::spot) {
    const double outer = std::clamp(in_degrees(light.outer_rad), 0.0, 90.0);
    command.add("inner_cone", std::clamp(in_degrees(light.inner_rad), 0.0, outer));
    command.add("outer_cone", outer);
    command.add("yaw", azimuth_of(light.direction));
    command.add("pitch", -elevation_of(light.direction));
  }
  if (light.has_shadows) command.add("shadows", "yes");
  return command.text();
}

}  // namespace simvis
