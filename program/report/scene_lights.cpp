#include "program/report/scene_lights.h"

#include <algorithm>
#include <numbers>

#include "elements/light.h"
#include "elements/sky_light.h"
#include "engine/base/even_points.h"
#include "shaders/interop.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

constexpr double kSphere_sr = 4 * std::numbers::pi;

bool is_of_sky(const Light& light) {
  return light.lamp_shape == LampShape::even_sky || light.lamp_shape == LampShape::sky_picture;
}

bool has_size(const Light& light) { return light.lamp_points > 1 && !is_of_sky(light); }

}  // namespace

SceneLights::SceneLights(const Simulation& simulation) : root_(built_scene(simulation).scene.root()) {
  find(root_);
  if (environment_ == nullptr) {
    environment_ = std::make_shared<EnvironmentNode>(Environment{});
    root_->add(environment_);
  }
  own_ = environment_->environment();
}

// What flatteners for sensors reach. The last environment applies.
void SceneLights::find(const std::shared_ptr<Group>& group) {
  if (group->kind() == NodeKind::visual) return;
  std::vector<NodePtr> children = group->children();
  if (group->kind() == NodeKind::switch_) {
    const int which = static_cast<const Switch&>(*group).which();
    if (which == Switch::kNone) return;
    if (which != Switch::kAll) children = {children[static_cast<std::size_t>(which)]};
  }
  for (const NodePtr& child : children) {
    if (const auto below = std::dynamic_pointer_cast<Group>(child)) find(below);
    if (const auto light = std::dynamic_pointer_cast<LightNode>(child)) hold(group, light);
    if (const auto environment = std::dynamic_pointer_cast<EnvironmentNode>(child)) environment_ = environment;
  }
}

// A group that several parents have is reached several times.
void SceneLights::hold(const std::shared_ptr<Group>& parent, const std::shared_ptr<LightNode>& light) {
  const auto held =
      std::ranges::find_if(lights_, [&](const Held& each) { return each.parent == parent && each.node == light; });
  if (held != lights_.end()) {
    ++held->count;
    return;
  }
  lights_.push_back({.parent = parent, .node = light, .own = light->light(), .stand_in = std::make_shared<Group>()});
}

bool SceneLights::offers(DrawnLight light) const {
  const auto any = [&](bool (*is)(const Light&)) {
    return std::ranges::any_of(lights_, [is](const Held& held) { return is(held.own); });
  };
  if (light == DrawnLight::shadows) return any([](const Light& each) { return !is_of_sky(each); });
  if (light == DrawnLight::sizes) return any(has_size);
  if (light == DrawnLight::sky) return any(is_of_sky) || own_.ambient != glm::vec3(0);
  return true;
}

void SceneLights::show(Held& held, bool shown) {
  if (held.shown == shown) return;
  held.shown = shown;
  const NodePtr node = held.node;
  const NodePtr &next = shown ? node : held.stand_in, &last = shown ? held.stand_in : node;
  held.parent->insert_before(*last, next);
  held.parent->remove(*last);
}

// The ambient light, of which so many lights are to take the place.
void SceneLights::set_ambient(const glm::vec3& ambient, std::uint32_t lights) {
  if (has_sky_) root_->remove(*sky_);
  has_sky_ = lights > 0 && ambient != glm::vec3(0);
  Environment environment = own_;
  environment.ambient = has_sky_ ? glm::vec3(0) : ambient;
  environment_->set_environment(environment);
  if (!has_sky_) return;
  sky_ = std::make_shared<Separator>();
  for (std::uint32_t i = 0; i < lights; ++i) {
    sky_->add(std::make_shared<LightNode>(Light{.color = ambient,
                                                .intensity = kSphere_sr / lights,
                                                .direction = -even_point_of_ball(i, lights),
                                                .shadow_px = SkyLightDesc{}.shadow_px,
                                                .lamp_points = lights,
                                                .lamp_point = i,
                                                .lamp_shape = LampShape::even_sky}));
  }
  root_->add(sky_);
}

void SceneLights::show(DrawnLight shown) {
  glm::vec3 ambient = own_.ambient;
  std::uint32_t with_shadows = 0;
  for (Held& held : lights_) {
    Light light = held.own;
    const bool of_sky = is_of_sky(light), whole = has_size(light) && shown < DrawnLight::sizes;
    if (of_sky && shown < DrawnLight::sky) {
      ambient += glm::vec3(glm::dvec3(held.node->shown().color) * (light.intensity / kSphere_sr));
    }
    show(held, !(of_sky && shown < DrawnLight::sky) && !(whole && light.lamp_point > 0));
    if (whole) light.intensity *= light.lamp_points;
    const bool blocked = held.shown && shown != DrawnLight::plain && with_shadows + held.count <= SIMVIS_MAX_SHADOWS;
    const std::uint32_t usual_px = of_sky ? SkyLightDesc{}.shadow_px : LightDesc{}.shadow_px;
    light.shadow_px = !blocked ? 0 : light.shadow_px > 0 ? light.shadow_px : usual_px;
    with_shadows += blocked ? held.count : 0;
    held.node->set_light(light);
  }
  set_ambient(ambient, shown == DrawnLight::sky ? SIMVIS_MAX_SHADOWS - with_shadows : 0);
}

void SceneLights::restore() {
  for (Held& held : lights_) {
    show(held, true);
    held.node->set_light(held.own);
  }
  set_ambient(own_.ambient, 0);
}

}  // namespace simvis
