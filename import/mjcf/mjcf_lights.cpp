#include "import/mjcf/mjcf_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "import/mesh/picture_file.h"
#include "import/mjcf/mjcf_pictures.h"
#include "import/model/file_command.h"

namespace simvis {
namespace {

// The diffuse part of a headlight goes with the cosine of the angle at which the camera sees a surface, which is 2/3 in
// the mean over the disc that a ball is in a picture.
constexpr double kMeanOfHeadlight = 2.0 / 3;

constexpr double kMujocoCutoff_deg = 45;

glm::dvec3 light_unit(const MjcfElement& light, const glm::dvec3& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) light.fail("has a direction without length");
  return glm::normalize(v / largest);
}

ModelLight::Kind light_kind(const MjcfElement& light) {
  const std::string type = light.text("type", light.flag("directional", false) ? "directional" : "spot");
  if (type == "directional") return ModelLight::Kind::directional;
  if (type == "point") return ModelLight::Kind::point;
  if (type != "spot") light.fail("has the type " + in_quotes(type) + ", expected spot, directional or point");
  return light.number("cutoff", kMujocoCutoff_deg) < 90 ? ModelLight::Kind::spot : ModelLight::Kind::point;
}

// As MuJoCo divides the light at a distance.
double attenuation(const MjcfElement& light, double distance_m) {
  const glm::dvec3 factors = light.vector("attenuation", {1, 0, 0});
  const double divisor = factors.x + distance_m * (factors.y + distance_m * factors.z);
  if (!(divisor > 0)) light.fail("has an attenuation that is not above 0");
  return divisor;
}

bool keeps_direction(const MjcfElement& light) { return light.text("mode", "fixed").starts_with("track"); }

}  // namespace

glm::dvec3 MjcfLights::way_of(const MjcfLight& light, const MjcfTree& tree,
                              const std::vector<glm::dmat4>& file_from_body, const glm::dvec3& position_m) {
  const std::string mode = light.element.text("mode", "fixed");
  if (keeps_direction(light.element) && light_kind(light.element) != ModelLight::Kind::directional) {
    report_.warn_once(light.element.at(), "a light that keeps its direction turns with its body here");
  }
  const auto target = std::ranges::find(tree.bodies, light.prefix + light.element.text("target"), &MjcfBody::own);
  if (mode.starts_with("target") && target != tree.bodies.end()) {
    report_.warn_once(light.element.at(), "a light that is aimed at a body is aimed at its first place here");
    const glm::dmat4& body = file_from_body[static_cast<std::size_t>(target - tree.bodies.begin())];
    const glm::dvec3 there(rigid_inverse(file_from_body[light.body]) * body[3]);
    if (there != position_m) return there - position_m;
  }
  const double distance_m = glm::length(position_m);
  const glm::dvec3 along = glm::dmat3(light.body_from_frame) * light.element.vector("dir", {0, 0, -1});
  return (distance_m > 0 ? distance_m : 1) * light_unit(light.element, along);
}

ModelLight MjcfLights::read(const MjcfLight& light, const MjcfTree& tree,
                            const std::vector<glm::dmat4>& file_from_body) {
  const MjcfElement& element = light.element;
  ModelLight made{.kind = light_kind(element), .color = element.vector("diffuse", glm::dvec3(0.7))};
  made.color = glm::clamp(made.color, 0.0, 1.0);
  made.position_m = glm::dvec3(light.body_from_frame * glm::dvec4(element.vector("pos", glm::dvec3(0)), 1));
  const glm::dvec3 way = way_of(light, tree, file_from_body, made.position_m);
  const double distance_m = glm::length(way);
  made.direction = way / distance_m;
  made.intensity = std::numbers::pi;  // of a white surface that shows 1
  made.has_shadows = element.find("castshadow") == "true";
  if (made.kind == ModelLight::Kind::directional) return made;
  made.intensity *= distance_m * distance_m / attenuation(element, distance_m);
  made.outer_rad = glm::radians(std::max(element.number("cutoff", kMujocoCutoff_deg), 0.0));
  return made;
}

std::vector<std::string> MjcfLights::commands(const MjcfTree& tree, const std::string& sky) {
  std::vector<glm::dmat4> file_from_body(tree.bodies.size(), glm::dmat4(1));
  for (std::size_t i = 1; i < tree.bodies.size(); ++i) {
    file_from_body[i] = file_from_body[tree.bodies[i].parent] * tree.bodies[i].parent_from_body;
  }
  std::vector<std::string> commands;
  glm::dvec3 ambient(0);
  for (const MjcfLight& light : lights_) {
    try {
      if (!light.element.flag("active", true)) continue;
      const glm::dvec3 own_ambient = light.element.vector("ambient", glm::dvec3(0));
      ModelLight made = read(light, tree, file_from_body);
      std::string point = tree.bodies[light.body].name;
      // A light from far away has no place to follow its body with.
      if (keeps_direction(light.element) && made.kind == ModelLight::Kind::directional) {
        made.direction = glm::dmat3(file_from_body[light.body]) * made.direction;
        point.clear();
      }
      commands.push_back(light_command(made, light.name, point));
      ambient += own_ambient;
    } catch (const InputError& error) {
      report_.warn(without_word_error(error.what()) + "; the light is left out");
    }
  }
  std::optional<MjcfElement> headlight;
  for (const MjcfElement& section : tree.model().sections("visual")) {
    for (const MjcfElement& child : section.children()) {
      if (child.tag() == "headlight") headlight = child;
    }
  }
  const std::optional<glm::dvec3> background = mjcf_background(tree.model(), report_);
  const bool has_ambient = !commands.empty() || headlight;
  if (!has_ambient && !background) return commands;
  FileCommand command(CommandKind::element, "sky", sky, "");
  if (!headlight || headlight->number("active", 1) != 0) {
    const glm::dvec3 own = headlight ? headlight->vector("ambient", glm::dvec3(0.1)) : glm::dvec3(0.1);
    const glm::dvec3 diffuse = headlight ? headlight->vector("diffuse", glm::dvec3(0.4)) : glm::dvec3(0.4);
    ambient += own + kMeanOfHeadlight * diffuse;
  }
  for (int i = 0; background && i < 3; ++i) {
    constexpr const char* kColors[] = {"red", "green", "blue"};
    command.add(kColors[i], (*background)[i]);
  }
  for (int i = 0; has_ambient && i < 3; ++i) {
    constexpr const char* kColors[] = {"ambient_red", "ambient_green", "ambient_blue"};
    command.add(kColors[i], decode_srgb(std::clamp(ambient[i], 0.0, 1.0)));
  }
  commands.push_back(command.text());
  return commands;
}

}  // namespace simvis
