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
//          it, see lamp.h.
// Shadows  with shadows="yes" an object between the light and a surface blocks the light, see effects/scene/shadows.h.
// Special  A light element switches off the built-in light of the scene.
#pragma once

#include <memory>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/lamp.h"

namespace simvis {

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
  void add_point(Separator& lamp, std::uint32_t i);

  LightKind kind_;
  Lamp lamp_;
  std::uint32_t shadow_px_;
  std::shared_ptr<Transform> place_;
  std::vector<std::shared_ptr<LightNode>> lights_;
};

}  // namespace simvis
