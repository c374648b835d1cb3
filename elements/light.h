// The element `light`: a light that can be moved, aimed, dimmed and coloured while the scene runs.
//
//   <element type="light" name="SUN" insert_at="ROOT" kind="directional" intensity="3" azimuth="120" elevation="35"/>
//   <element type="light" name="TORCH" insert_at="ROBOT" kind="spot" intensity="20" outer_cone="25" pitch="10"/>
//
// Kinds    directional: as the sun; `azimuth` and `elevation` say where it stands in the sky, so the light travels the
//          other way. point: at x y z, alike to all sides. spot: at x y z, along +x as a camera looks, turned by `yaw`
//          and `pitch` as the element pose turns. A light has the parameters of its kind only.
// Frames   those of the insertion point: a pose before the light moves and turns it, of the sun too.
// Units    KHR_lights_punctual: lux (directional) or candela (point, spot), times a linear colour. A white surface of
//          irradiance E shows the radiance E / pi.
// Shadows  with shadows="yes" what stands in the light's way keeps it from what lies behind, see effects/shadows.h.
// Special  a scene with a light element is not lit by the built-in light.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class LightElement : public Element {
 public:
  /// Throws InputError at an attribute that lights of this kind do not have, at one too many with shadows, and at a
  /// shadow_resolution without shadows.
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
