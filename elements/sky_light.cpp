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
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/lamp.h"
#include "elements/sky_regions.h"
#include "engine/base/even_points.h"
#include "engine/base/read_error.h"
#include "engine/draw/sky_sphere.h"
#include "scenegraph/error_word.h"
#include "scenegraph/language/attribute_rows.h"
#include "scenegraph/picture_reader.h"

namespace simvis {
namespace {

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

AttributeRows<SkyLightDesc> sky_light_rows() {
  using Desc = SkyLightDesc;
  constexpr AttributeLimits kRadiance{.min = 0, .max = 1e12};
  return {
      color_rows(&Desc::color, "", kRadiance, "linear radiance that arrives from all around where nothing blocks it")
          .only("without a picture", std::not_fn(&Desc::has_picture)),
      row(&Desc::intensity, "intensity", "", kRadiance, "of a picture: factor of its radiance")
          .live()
          .only("with a picture", &Desc::has_picture),
      row(&Desc::picture, AttributeKind::file, "picture",
          "OpenEXR or Radiance HDR file of the radiance of all directions, twice as wide as high, which takes the "
          "place of red, green and blue: its middle is +x, its left half +y, its upper edge +z"),
      row(&Desc::points, "sky_points", {{16, "16"}, {32, "32"}, {64, "64"}, {128, "128"}, {256, "256"}},
          "distant lights that together are the sky, each with shadows if it has shadows; at most 64 with shadows"),
      row(&Desc::shadows, "shadows", {{false, "no"}, {true, "yes"}}, "yes: objects block the light in pictures"),
      row(&Desc::shadow_px, "shadow_resolution", "px", {.min = 16, .max = 8192},
          "texels along a side of each shadow map")
          .only("with shadows", &Desc::shadows)};
}
const AttributeRows<SkyLightDesc> kSkyLightRows = sky_light_rows();

const ElementRegistration kSkyLightRegistration({
    .name = "sky_light",
    .summary = "Light from the whole sky that objects block: ambient occlusion, or the light of a picture.",
    .notes =
        "The lights of the sky stand on a sphere around the scene, below the horizon too. The ambient light of the "
        "element sky adds to it. It switches off the built-in light. A picture is also what cameras see where nothing "
        "is hit.",
    .attributes = kSkyLightRows.table(),
    .create = create_element<SkyLightElement>,
});

SkyPicture read_picture(const ElementContext& context, const std::string& name) {
  const Location where = context.attributes.where("picture");
  const std::filesystem::path file = (context.command.folder / name).lexically_normal();
  if (!is_input_file(file)) fail_at(where, "attribute \"picture\": there is no picture " + in_quotes(file.string()));
  try {
    return picture_reader().sky(file);
  } catch (const InputError& error) {
    fail_at(where, "attribute \"picture\": " + without_error_word(error.what()));
  }
}

}  // namespace

SkyLightElement::SkyLightElement(const ElementContext& context)
    : desc_(kSkyLightRows.read(context.command, context.attributes)) {
  if (desc_.shadows) check_shadow_count(context, desc_.points);
  desc_.has_picture() ? add_picture(context) : add_even_lights();
  const auto separator = std::make_shared<Separator>();
  separator->name = context.command.require("name").value;
  if (sky_) separator->add(sky_);
  for (const std::shared_ptr<LightNode>& light : lights_) {
    light->name = separator->name;
    separator->add(light);
  }
  context.scene.insert(context.command, separator);
}

void SkyLightElement::add_even_lights() {
  for (std::uint32_t i = 0; i < desc_.points; ++i) {
    lights_.push_back(std::make_shared<LightNode>(Light{.intensity = 4 * std::numbers::pi / desc_.points,
                                                        .direction = -even_point_of_ball(i, desc_.points),
                                                        .shadow_px = desc_.shadows ? desc_.shadow_px : 0,
                                                        .lamp_points = desc_.points,
                                                        .lamp_point = i,
                                                        .lamp_shape = LampShape::even_sky}));
  }
}

void SkyLightElement::add_picture(const ElementContext& context) {
  const auto picture = std::make_shared<const SkyPicture>(read_picture(context, desc_.picture));
  sky_ = std::make_shared<SkyNode>(picture, glm::vec3(mean_radiance(*picture)));
  const std::vector<SkyRegion> regions = cut_sky(*picture, desc_.points);
  for (std::uint32_t i = 0; i < regions.size(); ++i) {
    lights_.push_back(std::make_shared<LightNode>(Light{.color = glm::vec3(regions[i].irradiance),
                                                        .direction = -regions[i].towards,
                                                        .shadow_px = desc_.shadows ? desc_.shadow_px : 0,
                                                        .lamp_points = static_cast<std::uint32_t>(regions.size()),
                                                        .lamp_point = i,
                                                        .lamp_shape = LampShape::sky_picture}));
  }
}

void SkyLightElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  kSkyLightRows.adapt(desc_, live_rows);
}

void SkyLightElement::update(ParameterView values) {
  kSkyLightRows.set(desc_, values);
  if (sky_) sky_->set_factor(static_cast<float>(desc_.intensity));
  for (const std::shared_ptr<LightNode>& node : lights_) {
    Light light = node->light();
    if (sky_) {
      light.intensity = desc_.intensity;
    } else {
      light.color = desc_.color;
    }
    node->set_light(light);
  }
}

}  // namespace simvis
