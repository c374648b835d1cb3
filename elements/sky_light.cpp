#include "elements/sky_light.h"

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <utility>

#include "elements/lamp.h"
#include "elements/sky_regions.h"
#include "engine/base/even_points.h"
#include "engine/base/read_error.h"
#include "engine/draw/sky_sphere.h"
#include "scenegraph/error_word.h"
#include "scenegraph/picture_reader.h"

namespace simvis {
namespace {

constexpr std::string_view kPicture = "picture", kIntensity = "intensity";

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
    {.name = kIntensity,
     .default_value = "1",
     .text = "of a picture: factor of its radiance",
     .min = 0,
     .max = 1e12,
     .live = true},
    {.name = kPicture,
     .kind = AttributeKind::file,
     .text = "OpenEXR or Radiance HDR file of the radiance of all directions, twice as wide as high, which takes the "
             "place of red, green and blue: its middle is +x, its left half +y, its upper edge +z"},
    {.name = "sky_points",
     .kind = AttributeKind::choice,
     .default_value = "32",
     .text = "distant lights that together are the sky, each with shadows if it has shadows; at most 64 with shadows",
     .choices = "16 32 64 128 256"},
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
    .summary = "Light from the whole sky that things block: ambient occlusion, or the light of a picture.",
    .notes =
        "The lights of the sky stand on a sphere around the scene, below the horizon too. The ambient light of the "
        "element sky adds to it. It switches off the built-in light. A picture is also what cameras see where nothing "
        "is hit.",
    .attributes = kSkyLightAttributes,
    .create = create_element<SkyLightElement>,
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

SkyPicture read_picture(const ElementContext& context) {
  const Location where = context.attributes.where(kPicture);
  const std::filesystem::path file = (context.command.folder / context.attributes.text(kPicture)).lexically_normal();
  if (!is_input_file(file)) fail_at(where, "attribute \"picture\": there is no picture " + in_quotes(file.string()));
  try {
    return picture_reader().sky(file);
  } catch (const InputError& error) {
    fail_at(where, "attribute \"picture\": " + without_error_word(error.what()));
  }
}

bool is_of_picture(std::string_view attribute) { return attribute == kIntensity; }
bool is_of_color(std::string_view attribute) {
  return attribute == "red" || attribute == "green" || attribute == "blue";
}

void check_rows(const ElementContext& context, bool has_picture) {
  for (const CommandAttribute& attribute : context.command.attributes) {
    if (!(has_picture ? is_of_color(attribute.name) : is_of_picture(attribute.name))) continue;
    fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + " is not allowed for a sky_light " +
                                 (has_picture ? "with" : "without") + " a picture");
  }
}

}  // namespace

SkyLightElement::SkyLightElement(const ElementContext& context) {
  const auto points = static_cast<std::uint32_t>(std::stoul(context.attributes.choice("sky_points")));
  const bool has_picture = context.attributes.is_set(kPicture);
  check_rows(context, has_picture);
  shadow_px_ = sky_shadow_px_of(context, points);
  if (has_picture) {
    add_picture(context, points);
  } else {
    add_even_lights(points);
  }
  const auto separator = std::make_shared<Separator>();
  separator->name = context.command.require("name").value;
  if (sky_) separator->add(sky_);
  for (const std::shared_ptr<LightNode>& light : lights_) {
    light->name = separator->name;
    separator->add(light);
  }
  context.scene.insert(context.command, separator);
}

void SkyLightElement::add_even_lights(std::uint32_t points) {
  for (std::uint32_t i = 0; i < points; ++i) {
    lights_.push_back(std::make_shared<LightNode>(Light{.intensity = 4 * std::numbers::pi / points,
                                                        .direction = -even_point_of_ball(i, points),
                                                        .shadow_px = shadow_px_,
                                                        .lamp_points = points}));
  }
}

void SkyLightElement::add_picture(const ElementContext& context, std::uint32_t points) {
  const auto picture = std::make_shared<const SkyPicture>(read_picture(context));
  sky_ = std::make_shared<SkyNode>(picture, glm::vec3(mean_radiance(*picture)));
  const std::vector<SkyRegion> regions = cut_sky(*picture, points);
  for (const SkyRegion& region : regions) {
    lights_.push_back(std::make_shared<LightNode>(Light{.color = glm::vec3(region.irradiance),
                                                        .direction = -region.towards,
                                                        .shadow_px = shadow_px_,
                                                        .lamp_points = static_cast<std::uint32_t>(regions.size())}));
  }
}

void SkyLightElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  std::erase_if(live_rows,
                [this](const AttributeSpec& row) { return sky_ ? is_of_color(row.name) : is_of_picture(row.name); });
}

void SkyLightElement::update(ParameterView values) {
  if (sky_) sky_->set_factor(static_cast<float>(values[0]));
  for (const std::shared_ptr<LightNode>& node : lights_) {
    Light light = node->light();
    if (sky_) {
      light.intensity = values[0];
    } else {
      light.color = glm::vec3(values[0], values[1], values[2]);
    }
    node->set_light(light);
  }
}

}  // namespace simvis
