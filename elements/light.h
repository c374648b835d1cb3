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
// Shadows  with shadows="yes" an object between the light and a surface blocks the light, see effects/scene/shadows.h.
// Special  A light element switches off the built-in light of the scene.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class LightElement : public Element {
 public:
  /// Throws InputError at an attribute that lights of this kind do not have, at `shadows` if too many lights have
  /// shadows, and at a shadow_resolution without shadows.
  explicit LightElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

  const std::shared_ptr<LightNode>& node() const { return light_; }

 private:
  LightKind kind_;
  std::uint32_t shadow_px_;
  std::shared_ptr<Transform> place_;
  std::shared_ptr<LightNode> light_;
};

}  // namespace simvis
