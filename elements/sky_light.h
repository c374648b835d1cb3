// The element `sky_light`: light of the same radiance from the whole sky and from below, which things block: ambient
// occlusion.
//
//   <element type="sky_light" name="DAY" insert_at="ROOT" red="0.4" green="0.5" blue="0.6" sky_points="64"/>
//
// Model    `sky_points` distant lights stand evenly on the sphere and share its light, each with shadows. A matte
//          surface with the base colour c shows c times the radiance times the share of the sky that it sees, weighted
//          by the cosine of the direction. The ambient light of the element `sky` adds to it and is not blocked.
// Frames   the frame of the insertion point turns the lights.
// Error    With n lights a surface's light errs by less than sqrt(5 / (3 n)) in the root mean square, the standard
//          deviation of random directions; in steps of 4 / n times the cosine.
// Special  Its lights switch off the built-in light of the scene. Shiny surfaces show a highlight for each.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class SkyLightElement : public Element {
 public:
  /// Throws InputError at a shadow_resolution without shadows, and if too many lights have shadows.
  explicit SkyLightElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  std::uint32_t shadow_px_;
  std::vector<std::shared_ptr<LightNode>> lights_;
};

}  // namespace simvis
