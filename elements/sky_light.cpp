#include "elements/sky_light.h"

#include <numbers>

#include "elements/lamp.h"
#include "engine/base/even_points.h"

namespace simvis {
namespace {

constexpr AttributeSpec sky_radiance(std::string_view name) {
  return {.name = name,
          .default_value = "0.3",
          .text = "linear radiance that arrives from all around where nothing blocks it",
          .min = 0,
          .max = 1e12,
          .live = true};
}

constexpr AttributeSpec kSkyLightAttributes[] = {
    sky_radiance("red"),
    sky_radiance("green"),
    sky_radiance("blue"),
    {.name = "sky_points",
     .kind = AttributeKind::choice,
     .default_value = "32",
     .text = "distant lights that together are the sky, each with shadows if it has shadows",
     .choices = "16 32 64"},
    {.name = "shadows",
     .kind = AttributeKind::choice,
     .default_value = "yes",
     .text = "yes: objects block the light in pictures",
     .choices = "no yes"},
    {.name = "shadow_resolution",
     .kind = AttributeKind::integer,
     .default_value = "512",
     .unit = "px",
     .text = "texels along a side of each shadow map",
     .min = 16,
     .max = 8192},
};

const ElementRegistration kSkyLightRegistration({
    .name = "sky_light",
    .summary = "Light from the whole sky that things block: ambient occlusion.",
    .notes =
        "The lights of the sky stand on a sphere around the scene, below the horizon too. The ambient light of the "
        "element sky adds to it. It switches off the built-in light.",
    .attributes = kSkyLightAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<SkyLightElement>(context);
    },
});

std::uint32_t sky_shadow_px_of(const ElementContext& context, std::uint32_t points) {
  if (context.attributes.choice("shadows") == "no") {
    if (const CommandAttribute* const resolution = context.command.find("shadow_resolution")) {
      fail_at(resolution->where, "attribute \"shadow_resolution\" is not allowed for a light without shadows");
    }
    return 0;
  }
  check_shadow_count(context, points);
  return static_cast<std::uint32_t>(context.attributes.integer("shadow_resolution"));
}

}  // namespace

SkyLightElement::SkyLightElement(const ElementContext& context) {
  const auto points = static_cast<std::uint32_t>(std::stoul(context.attributes.choice("sky_points")));
  shadow_px_ = sky_shadow_px_of(context, points);
  const auto separator = std::make_shared<Separator>();
  separator->name = context.command.require("name").value;
  for (std::uint32_t i = 0; i < points; ++i) {
    lights_.push_back(std::make_shared<LightNode>(Light{.intensity = 4 * std::numbers::pi / points,
                                                        .direction = -even_point_of_ball(i, points),
                                                        .shadow_px = shadow_px_,
                                                        .lamp_points = points}));
    lights_.back()->name = separator->name;
    separator->add(lights_.back());
  }
  context.scene.insert(context.command, separator);
}

void SkyLightElement::update(ParameterView values) {
  for (const std::shared_ptr<LightNode>& node : lights_) {
    Light light = node->light();
    light.color = glm::vec3(values[0], values[1], values[2]);
    node->set_light(light);
  }
}

}  // namespace simvis
