#include "elements/light.h"

#include <algorithm>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>

#include <simvis/pose.h>
#include "scenegraph/language/attribute_rows.h"
#include "shaders/interop.h"

namespace simvis {
namespace {

constexpr double kMaxColor = 1e6, kMaxIntensity = 1e12;

// A light has the parameters of its kind.
AttributeRows<LightDesc> light_rows() {
  using Desc = LightDesc;
  constexpr AttributeLimits kPlace{.min = -kMaxCoordinate_m, .max = kMaxCoordinate_m}, kCone{.min = 0, .max = 90};
  const AttributeRows<Desc> directional =
      AttributeRows<Desc>{row(&Desc::azimuth_deg, "azimuth", "deg", kAnyNumber,
                              "directional: direction of the light source, counter-clockwise from +x about +z")
                              .live()
                              .full_turn(),
                          row(&Desc::elevation_deg, "elevation", "deg", {.min = -90, .max = 90},
                              "directional: height of the light source above the horizon")
                              .live(),
                          row(&Desc::angular_radius_rad, "angular_radius", kDegrees, {.min = 0, .max = 45},
                              "directional: of the disc in the sky that shines, 0.27 for the sun; 0: a point")}
          .only("for a directional light", &Desc::is_directional);
  const AttributeRows<Desc> placed =
      AttributeRows<Desc>{row(&Desc::x_m, "x", "m", kPlace, "point, spot: forward").live(),
                          row(&Desc::y_m, "y", "m", kPlace, "point, spot: to the left").live(),
                          row(&Desc::z_m, "z", "m", kPlace, "point, spot: up").live(),
                          row(&Desc::range_m, "range", "m", {.min = 0, .max = kMaxCoordinate_m},
                              "point, spot: distance at which the light ends; 0: no limit")
                              .live(),
                          row(&Desc::radius_m, "radius", "m", {.min = 0, .max = 1000},
                              "point, spot: of the ball that shines; 0: a point")}
          .only("for a point or spot light", std::not_fn(&Desc::is_directional));
  const AttributeRows<Desc> spot =
      AttributeRows<Desc>{
          row(&Desc::yaw_deg, "yaw", "deg", kAnyNumber, "spot: turn of its axis to the left").live().full_turn(),
          row(&Desc::pitch_deg, "pitch", "deg", kAnyNumber, "spot: turn of its axis downwards, before yaw")
              .live()
              .full_turn(),
          row(&Desc::inner_cone_rad, "inner_cone", kDegrees, kCone,
              "spot: full intensity up to this angle from the axis")
              .live(),
          row(&Desc::outer_cone_rad, "outer_cone", kDegrees, kCone,
              "spot: dark beyond this angle; the edge is sharp if inner_cone equals it")
              .live()}
          .only("for a spot light", &Desc::is_spot);
  return {row(&Desc::kind, "kind",
              {{LightKind::directional, "directional"}, {LightKind::point, "point"}, {LightKind::spot, "spot"}},
              "directional: like the sun; point: equal to all sides; spot: a cone along +x"),
          color_rows(&Desc::color, "", {.min = 0, .max = kMaxColor}, "linear colour, multiplies the intensity"),
          row(&Desc::intensity, "intensity", "lux or cd", {.min = 0, .max = kMaxIntensity},
              "lux for directional, candela for point and spot")
              .live(),
          directional,
          placed,
          spot,
          row(&Desc::lamp_points, "lamp_points", "", {.min = 2, .max = SIMVIS_MAX_SHADOWS},
              "with a radius: lights that together are the lamp, each with shadows if it has shadows")
              .only("with a radius or an angular_radius", &Desc::has_size),
          row(&Desc::shadows, "shadows", {{false, "no"}, {true, "yes"}}, "yes: objects cast shadows in pictures"),
          row(&Desc::shadow_px, "shadow_resolution", "px", {.min = 16, .max = 8192},
              "texels along a side of each shadow map; edges of shadows are exact to half a texel")
              .only("with shadows", &Desc::shadows)};
}
const AttributeRows<LightDesc> kLightRows = light_rows();

const ElementRegistration kLightRegistration({
    .name = "light",
    .summary = "A directional, point or spot light.",
    .notes =
        "Units are those of KHR_lights_punctual. A white surface with the irradiance E shows the radiance E / pi. "
        "A light has only the parameters of its kind; kind, size, shadows and shadow_resolution cannot change while "
        "the scene runs. A lamp with a size throws soft shadows. The built-in light shines as long as a scene has no "
        "other light.",
    .attributes = kLightRows.table(),
    .create = create_element<LightElement>,
});

Lamp lamp_of(const LightDesc& desc) {
  return {.radius = desc.is_directional() ? desc.angular_radius_rad : desc.radius_m,
          .points = desc.has_size() ? desc.lamp_points : 1};
}

// Returns the direction in which the light travels from this position in the sky.
glm::dvec3 direction_from_sky(double azimuth_deg, double elevation_deg) {
  const SinCos a = sincos_deg(azimuth_deg), e = sincos_deg(elevation_deg);
  return {-e.cos * a.cos, -e.cos * a.sin, -e.sin};
}

}  // namespace

LightElement::LightElement(const ElementContext& context)
    : desc_(kLightRows.read(context.command, context.attributes)),
      lamp_(lamp_of(desc_)),
      place_(std::make_shared<Transform>()) {
  if (desc_.shadows) check_shadow_count(context, lamp_.points);
  const auto separator = std::make_shared<Separator>();
  separator->name = context.command.require("name").value;
  separator->add(place_);
  for (std::uint32_t i = 0; i < lamp_.points; ++i) add_point(*separator, i);
  context.scene.insert(context.command, separator);
}

// A light of the lamp: all are alike but for their places.
Light LightElement::light(std::uint32_t i) const {
  Light light{.kind = desc_.kind, .color = desc_.color, .intensity = desc_.intensity / lamp_.points};
  if (desc_.is_directional()) light.direction = direction_from_sky(desc_.azimuth_deg, desc_.elevation_deg);
  light.range_m = desc_.range_m;
  if (desc_.is_spot()) {
    light.inner_cone_rad = desc_.inner_cone_rad;
    light.outer_cone_rad = desc_.outer_cone_rad;
  }
  light.shadow_px = desc_.shadows ? desc_.shadow_px : 0;
  if (lamp_.points == 1) return light;
  light.lamp_points = lamp_.points;
  light.lamp_point = i;
  light.lamp_shape = desc_.is_directional() ? LampShape::disc : LampShape::ball;
  light.lamp_radius = lamp_.radius;
  light.lamp_middle = desc_.is_directional() ? light.direction : -place_of_point(lamp_, i);
  if (desc_.is_directional()) light.direction = direction_of_point(lamp_, light.direction, i);
  return light;
}

void LightElement::add_point(Separator& separator, std::uint32_t i) {
  const auto node = std::make_shared<LightNode>(light(i));
  node->name = separator.name;
  lights_.push_back(node);
  if (lamp_.points == 1 || desc_.is_directional()) {
    separator.add(node);
    return;
  }
  const auto point = std::make_shared<Separator>();
  point->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), place_of_point(lamp_, i))));
  point->add(node);
  separator.add(point);
}

void LightElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  kLightRows.adapt(desc_, live_rows);
  std::ranges::find(live_rows, "intensity", &AttributeSpec::name)->unit = desc_.is_directional() ? "lux" : "cd";
}

void LightElement::update(ParameterView values) {
  kLightRows.set(desc_, values);
  place_->set_matrix(matrix_from_degrees({desc_.x_m, desc_.y_m, desc_.z_m}, 0, desc_.pitch_deg, desc_.yaw_deg));
  for (std::uint32_t i = 0; i < lamp_.points; ++i) lights_[i]->set_light(light(i));
}

}  // namespace simvis
