#include "elements/sky_light.h"

#include <bit>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "elements/lamp.h"
#include "elements/sky_regions.h"
#include "engine/base/even_points.h"
#include "engine/base/fnv1a.h"
#include "engine/base/read_error.h"
#include "engine/draw/sky_sphere.h"
#include "scenegraph/error_word.h"
#include "scenegraph/language/attribute_rows.h"
#include "scenegraph/picture_reader.h"

namespace simvis {
namespace {

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

// The shift mixes the high bits into the low ones, as the low bits of most numbers are 0.
std::uint64_t hash_of_picture(const SkyPicture& picture) {
  std::uint64_t hash = fnv1a_step(kFnv1aStart, picture.width);
  for (const glm::vec3& radiance : picture.radiance) {
    for (const float number : {radiance.r, radiance.g, radiance.b}) {
      hash = fnv1a_step(hash, std::bit_cast<std::uint32_t>(number));
      hash ^= hash >> 29;
    }
  }
  return hash;
}

bool same_pictures(const SkyPicture& a, const SkyPicture& b) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));  // no padding
  return a.width == b.width && a.height == b.height && a.radiance.size() == b.radiance.size() &&
         std::memcmp(a.radiance.data(), b.radiance.data(), a.radiance.size() * sizeof(glm::vec3)) == 0;
}

// The picture of this content that lives in the process, so that simulations of one sky hold it once; else this one.
std::shared_ptr<const SkyPicture> shared_picture(SkyPicture&& picture) {
  static std::mutex mutex;
  static std::unordered_multimap<std::uint64_t, std::weak_ptr<const SkyPicture>> pictures;
  const std::uint64_t key = hash_of_picture(picture);
  const std::lock_guard lock(mutex);
  std::erase_if(pictures, [](const auto& entry) { return entry.second.expired(); });
  const auto [first, last] = pictures.equal_range(key);
  for (auto entry = first; entry != last; ++entry) {
    std::shared_ptr<const SkyPicture> known = entry->second.lock();
    if (known && same_pictures(*known, picture)) return known;
  }
  auto added = std::make_shared<const SkyPicture>(std::move(picture));
  pictures.emplace(key, added);
  return added;
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
  const std::shared_ptr<const SkyPicture> picture = shared_picture(read_picture(context, desc_.picture));
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
