#include "elements/light.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include <simvis/pose.h>
#include "shaders/interop.h"

namespace simvis {
namespace {

constexpr double kMaxColor = 1e6, kMaxIntensity = 1e12;

constexpr AttributeSpec live(std::string_view name, std::string_view by_default, std::string_view unit,
                             std::string_view text, double min = -kNoLimit, double max = kNoLimit) {
  return {.name = name, .default_value = by_default, .unit = unit, .text = text, .min = min, .max = max, .live = true};
}
constexpr AttributeSpec light_color(std::string_view name) {
  return live(name, "1", "", "linear colour, multiplies the intensity", 0, kMaxColor);
}
constexpr AttributeSpec place(std::string_view name, std::string_view text) {
  return live(name, "0", "m", text, -kMaxCoordinate_m, kMaxCoordinate_m);
}

constexpr AttributeSpec turn(std::string_view name, std::string_view text) {
  AttributeSpec row = live(name, "0", "deg", text);
  row.full_turn = true;
  return row;
}

// Live rows in the order in which update() reads them. Each kind has some of them.
constexpr AttributeSpec kLightAttributes[] = {
    {.name = "kind",
     .kind = AttributeKind::choice,
     .default_value = "directional",
     .text = "directional: like the sun; point: equal to all sides; spot: a cone along +x",
     .choices = "directional point spot"},
    light_color("red"),
    light_color("green"),
    light_color("blue"),
    live("intensity", "1", "lux or cd", "lux for directional, candela for point and spot", 0, kMaxIntensity),
    turn("azimuth", "directional: direction of the light source, counter-clockwise from +x about +z"),
    live("elevation", "45", "deg", "directional: height of the light source above the horizon", -90, 90),
    place("x", "point, spot: forward"),
    place("y", "point, spot: to the left"),
    place("z", "point, spot: up"),
    live("range", "0", "m", "point, spot: distance at which the light ends; 0: no limit", 0, kMaxCoordinate_m),
    turn("yaw", "spot: turn of its axis to the left"),
    turn("pitch", "spot: turn of its axis downwards, before yaw"),
    live("inner_cone", "0", "deg", "spot: full intensity up to this angle from the axis", 0, 90),
    live("outer_cone", "45", "deg", "spot: dark beyond this angle; the edge is sharp if inner_cone equals it", 0, 90),
    {.name = "radius",
     .default_value = "0",
     .unit = "m",
     .text = "point, spot: of the ball that shines; 0: a point",
     .min = 0,
     .max = 1000},
    {.name = "angular_radius",
     .default_value = "0",
     .unit = "deg",
     .text = "directional: of the disc in the sky that shines, 0.27 for the sun; 0: a point",
     .min = 0,
     .max = 45},
    {.name = "lamp_points",
     .kind = AttributeKind::integer,
     .default_value = "16",
     .text = "with a radius: lights that together are the lamp, each with shadows if it has shadows",
     .min = 2,
     .max = SIMVIS_MAX_SHADOWS},
    {.name = "shadows",
     .kind = AttributeKind::choice,
     .default_value = "no",
     .text = "yes: objects cast shadows in pictures",
     .choices = "no yes"},
    {.name = "shadow_resolution",
     .kind = AttributeKind::integer,
     .default_value = "1024",
     .unit = "px",
     .text = "texels along a side of each shadow map; edges of shadows are exact to half a texel",
     .min = 16,
     .max = 8192},
};

const ElementRegistration kLightRegistration({
    .name = "light",
    .summary = "A directional, point or spot light.",
    .notes =
        "Units are those of KHR_lights_punctual. A white surface with the irradiance E shows the radiance E / pi. "
        "A light has only the parameters of its kind; kind, size, shadows and shadow_resolution cannot change while "
        "the scene runs. A lamp with a size throws soft shadows. The built-in light shines as long as a scene has no "
        "other light.",
    .attributes = kLightAttributes,
    .create = create_element<LightElement>,
});

LightKind kind_of(const AttributeValues& attributes) {
  const std::string& kind = attributes.choice("kind");
  return kind == "directional" ? LightKind::directional : kind == "point" ? LightKind::point : LightKind::spot;
}

bool has(LightKind kind, std::string_view attribute) {
  constexpr std::string_view kOfDirectional[] = {"azimuth", "elevation", "angular_radius"};
  constexpr std::string_view kOfPlaced[] = {"x", "y", "z", "range", "radius"};
  constexpr std::string_view kOfSpot[] = {"yaw", "pitch", "inner_cone", "outer_cone"};
  if (std::ranges::count(kOfDirectional, attribute) > 0) return kind == LightKind::directional;
  if (std::ranges::count(kOfPlaced, attribute) > 0) return kind != LightKind::directional;
  if (std::ranges::count(kOfSpot, attribute) > 0) return kind == LightKind::spot;
  return true;
}

Lamp lamp_of(const ElementContext& context, LightKind kind) {
  const AttributeValues& a = context.attributes;
  Lamp lamp{.radius = kind == LightKind::directional ? glm::radians(a.number("angular_radius")) : a.number("radius")};
  if (lamp.radius > 0) {
    lamp.points = static_cast<std::uint32_t>(a.integer("lamp_points"));
  } else if (const CommandAttribute* const points = context.command.find("lamp_points")) {
    fail_at(points->where,
            "attribute \"lamp_points\" is not allowed for a light without a radius or an angular_radius");
  }
  return lamp;
}

std::uint32_t shadow_px_of(const ElementContext& context, const Lamp& lamp) {
  const CommandAttribute* const resolution = context.command.find("shadow_resolution");
  if (context.attributes.choice("shadows") == "no") {
    if (resolution != nullptr)
      fail_at(resolution->where, "attribute \"shadow_resolution\" is not allowed for a light without shadows");
    return 0;
  }
  check_shadow_count(context, lamp.points);
  return static_cast<std::uint32_t>(context.attributes.integer("shadow_resolution"));
}

// Returns the direction in which the light travels from this position in the sky.
glm::dvec3 direction_from_sky(double azimuth_deg, double elevation_deg) {
  const SinCos a = sincos_deg(azimuth_deg), e = sincos_deg(elevation_deg);
  return {-e.cos * a.cos, -e.cos * a.sin, -e.sin};
}

}  // namespace

LightElement::LightElement(const ElementContext& context)
    : kind_(kind_of(context.attributes)),
      lamp_(lamp_of(context, kind_)),
      shadow_px_(shadow_px_of(context, lamp_)),
      place_(std::make_shared<Transform>()) {
  for (const CommandAttribute& attribute : context.command.attributes) {
    if (has(kind_, attribute.name)) continue;
    fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + " is not allowed for a light of the kind " +
                                 in_quotes(context.attributes.choice("kind")));
  }
  const auto separator = std::make_shared<Separator>();
  separator->name = context.command.require("name").value;
  separator->add(place_);
  for (std::uint32_t i = 0; i < lamp_.points; ++i) add_point(*separator, i);
  context.scene.insert(context.command, separator);
}

void LightElement::add_point(Separator& lamp, std::uint32_t i) {
  const auto light =
      std::make_shared<LightNode>(Light{.kind = kind_, .shadow_px = shadow_px_, .lamp_points = lamp_.points});
  light->name = lamp.name;
  lights_.push_back(light);
  if (lamp_.points == 1 || kind_ == LightKind::directional) {
    lamp.add(light);
    return;
  }
  const auto point = std::make_shared<Separator>();
  point->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), place_of_point(lamp_, i))));
  point->add(light);
  lamp.add(point);
}

void LightElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  std::erase_if(live_rows, [this](const AttributeSpec& row) { return !has(kind_, row.name); });
  std::ranges::find(live_rows, "intensity", &AttributeSpec::name)->unit =
      kind_ == LightKind::directional ? "lux" : "cd";
}

void LightElement::update(ParameterView values) {
  Light light{.kind = kind_, .color = glm::vec3(values[0], values[1], values[2]), .intensity = values[3]};
  light.shadow_px = shadow_px_;
  light.lamp_points = lamp_.points;
  light.intensity /= lamp_.points;
  if (kind_ == LightKind::directional) {
    light.direction = direction_from_sky(values[4], values[5]);
  } else {
    const bool spot = kind_ == LightKind::spot;
    place_->set_matrix(
        matrix_from_degrees({values[4], values[5], values[6]}, 0, spot ? values[9] : 0, spot ? values[8] : 0));
    light.range_m = values[7];
    if (spot) {
      light.inner_cone_rad = glm::radians(values[10]);
      light.outer_cone_rad = glm::radians(values[11]);
    }
  }
  for (std::uint32_t i = 0; i < lamp_.points; ++i) {
    Light point = light;
    if (kind_ == LightKind::directional) point.direction = direction_of_point(lamp_, light.direction, i);
    lights_[i]->set_light(point);
  }
}

}  // namespace simvis
