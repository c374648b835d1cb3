// The element `light`: a light that can be moved, aimed, dimmed and coloured while the scene runs.
//
//   <element type="light" name="SUN" insert_at="ROOT" kind="directional" intensity="3" azimuth="120" elevation="35"/>
//   <element type="light" name="TORCH" insert_at="ROBOT" kind="spot" intensity="20" outer_cone="25" pitch="10"/>
//
// Kinds    directional: a distant light such as the sun; `azimuth` and `elevation` give its position in the sky, and
//          the light travels in the opposite direction. point: at x y z, with the same intensity in all directions.
//          spot: at x y z, along +x as a camera looks, turned by `yaw` and `pitch` as the element `pose` turns. A light
//          has the parameters of its kind only.
// Frames   the frame of the insertion point. A pose before the light moves and turns every kind of light, the sun too.
// Units    KHR_lights_punctual: lux (directional) or candela (point, spot), times a linear colour. A white surface with
//          the irradiance E shows the radiance E / pi.
// Size     with radius="0.1" a point or spot light is a ball whose surface shines, and with angular_radius="0.27" a
//          directional light is a disc in the sky: `lamp_points` lights that share its intensity and stand evenly on
//          it, see lamp.h. Paths of light take random points of it instead.
// Shadows  with shadows="yes" an object between the light and a surface blocks the light, see effects/scene/shadows.h.
// Special  A light element switches off the built-in light of the scene.
#pragma once

#include <memory>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/lamp.h"

namespace simvis {

/// What a command `light` says. Numbers of other kinds of light have no effect.
struct LightDesc {
  LightKind kind = LightKind::directional;     ///< cannot change, as the size and the shadows
  glm::vec3 color{1};                          ///< linear
  double intensity = 1;                        ///< lux of a directional light, else candela
  double azimuth_deg = 0;                      ///< of the light source, counter-clockwise from +x about +z
  double elevation_deg = 45;                   ///< of the light source above the horizon
  double x_m = 0, y_m = 0, z_m = 0;            ///< in the frame of the insertion point
  double range_m = 0;                          ///< where the light ends; 0: no limit
  double yaw_deg = 0, pitch_deg = 0;           ///< of the axis of a spot light
  double inner_cone_rad = 0;                   ///< full intensity up to this angle from the axis
  double outer_cone_rad = glm::radians(45.0);  ///< dark beyond this angle
  double radius_m = 0;                         ///< of the ball that shines; 0: a point
  double angular_radius_rad = 0;               ///< of the disc in the sky that shines; 0: a point
  std::uint32_t lamp_points = 16;              ///< lights that are a lamp with a size
  bool shadows = false;                        ///< objects block it
  std::uint32_t shadow_px = 1024;              ///< texels along a side of a shadow map

  bool is_directional() const { return kind == LightKind::directional; }
  bool is_spot() const { return kind == LightKind::spot; }
  bool has_size() const { return radius_m > 0 || angular_radius_rad > 0; }
};

class LightElement : public Element {
 public:
  /// Throws InputError at an attribute that lights of this kind do not have, at `shadows` if too many lights have
  /// shadows, at a shadow_resolution without shadows, and at lamp_points without a size.
  explicit LightElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

  /// The points of the lamp, at least one.
  const std::vector<std::shared_ptr<LightNode>>& nodes() const { return lights_; }

 private:
  Light light(std::uint32_t i) const;
  void add_point(Separator& separator, std::uint32_t i);

  LightDesc desc_;
  Lamp lamp_;
  std::shared_ptr<Transform> place_;
  std::vector<std::shared_ptr<LightNode>> lights_;
};

}  // namespace simvis
