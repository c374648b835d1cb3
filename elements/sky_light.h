// The element `sky_light`: light from the whole sky and from below, which objects block: of the same radiance
// everywhere (ambient occlusion), or of a picture (image-based lighting).
//
//   <element type="sky_light" name="DAY" insert_at="ROOT" red="0.4" green="0.5" blue="0.6" sky_points="64"/>
//   <element type="sky_light" name="DAY" insert_at="ROOT" picture="sky.exr" sky_points="64"/>
//
// Model    `sky_points` distant lights stand evenly on the sphere and share its light, each with shadows. A matte
//          surface with the base colour c shows c times the radiance times the share of the sky that it sees, weighted
//          by the cosine of the direction. The ambient light of the element `sky` adds to it and is not blocked.
// Picture  Its lights have the light of the parts of the picture that they stand for, see sky_regions.h. The picture
//          itself is what cameras see where nothing is hit, unless there is fog; event cameras, `sunlight` and pages
//          take its mean instead. See SkyPicture for its directions.
// Paths    Paths of light take the picture, or the same radiance from everywhere, in place of the lights.
// Frames   the frame of the insertion point turns the lights and the picture.
// Error    Without a picture and with n lights a surface's light errs by less than sqrt(5 / (3 n)) in the root mean
//          square, the standard deviation of random directions; in steps of 4 / n times the cosine.
// Special  Its lights switch off the built-in light of the scene. Shiny surfaces show a highlight for each.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

/// What a command `sky_light` says.
struct SkyLightDesc {
  std::string picture;        ///< a file; empty: the same radiance from everywhere
  glm::vec3 color{0.3f};      ///< linear radiance, without a picture
  double intensity = 1;       ///< with a picture, factor of its radiance
  std::uint32_t points = 32;  ///< lights that are the sky
  bool shadows = true;        ///< objects block it
  std::uint32_t shadow_px = 512;

  bool has_picture() const { return !picture.empty(); }
};

class SkyLightElement : public Element {
 public:
  /// Throws InputError at a shadow_resolution without shadows, if too many lights have shadows, and for a picture that
  /// cannot be read.
  explicit SkyLightElement(const ElementContext& context);
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  void update(ParameterView values) override;

 private:
  void add_even_lights();
  void add_picture(const ElementContext& context);

  SkyLightDesc desc_;
  std::shared_ptr<SkyNode> sky_;  // null: without a picture
  std::vector<std::shared_ptr<LightNode>> lights_;
};

}  // namespace simvis
