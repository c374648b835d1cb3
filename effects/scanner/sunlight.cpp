#include "effects/scanner/sunlight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "effects/scanner/detection_law.h"
#include "effects/scanner/onward_ray.h"
#include "effects/scanner/reflectance.h"
#include "engine/base/assert.h"
#include "engine/draw/sky_sphere.h"
#include "engine/draw/splat_item.h"
#include "engine/light/surface_shares.h"

namespace simvis {
namespace {

constexpr AttributeSpec kSunlightAttributes[] = {
    {.name = "sunlight",
     .default_value = "0",
     .text = "variance that a surface of radiance 1 adds to the receiver's noise, in units of the receiver's own; "
             "0: light does not disturb it",
     .min = 0},
};

const ScanEffectRegistration kSunlightRegistration(
    {.type = {.name = "sunlight",
              .summary = "The light of the scene raises the noise of the receiver: weak echoes are lost.",
              .notes =
                  "The threshold of dropout_power, by default that of a surface of reflectance 0.1 at range_max, is "
                  "multiplied by sqrt(1 + sunlight L). L is the radiance of what the beam sees, as in a picture: by "
                  "directional lights that no part hides, the ambient light and the sky. A data sheet with a range "
                  "in the dark and one in the light says sunlight L = (R_dark / R_light)^4 - 1.",
              .source = "attribute sunlight above 0",
              .outputs = kShownInRanges,
              .reference = "shot noise of background light: Richmond and Cain, Direct-Detection LADAR Systems (SPIE "
                           "2010)",
              .needs = kCastsBeams,
              .attributes = kSunlightAttributes},
     .order = ScanOrder::disturbance,
     .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
       if (context.attributes.number("sunlight") == 0) return nullptr;
       return std::make_unique<Sunlight>(context);
     }});

double mean(const glm::vec3& color) {
  return (static_cast<double>(color.r) + static_cast<double>(color.g) + static_cast<double>(color.b)) / 3;
}

}  // namespace

Sunlight::Sunlight(const ScanEffectContext& context)
    : sunlight_(context.attributes.number("sunlight")),
      threshold_(context.attributes.number("dropout_power")),
      spread_(context.attributes.number("dropout_noise")),
      has_dropout_(threshold_ > 0),
      random_(context.random("sunlight")) {
  if (!has_dropout_) threshold_ = 0.1 / (context.range_max_m * context.range_max_m);
}

void Sunlight::aim(const ScanContext& context, std::vector<BeamRay>& rays) const {
  SIMVIS_ASSERT(context.scene != nullptr);
  const std::size_t beams = std::size_t{context.rings} * context.beams;
  radiance_.assign(beams, 0);
  sky_.assign(beams, 0);
  for (const BeamRay& ray : rays) sky_[ray.beam] += ray.share;
  lit_.clear();
  counted_ = false;
  suns_.clear();
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(context.world_from_sensor));
  for (const LightItem& item : context.scene->lights) {
    if (item.light.kind != LightKind::directional) continue;
    const glm::dvec3 along = glm::dmat3(context.scene->world_from_node[item.transform]) * item.light.direction;
    suns_.push_back({.towards = -(sensor_from_world * glm::normalize(along)),
                     .irradiance = item.light.intensity * mean(item.light.color)});
  }
}

void Sunlight::meet(const ScanContext& context, const BeamRay& ray, const SurfacePoint& surface, Echo&,
                    std::vector<BeamRay>& onward) const {
  const double reflects = reflectance(surface), cosine = -glm::dot(surface.normal, ray.direction);
  const SurfaceShares shares = surface_shares(*surface.material, reflects, cosine);
  if (ray.asked_by == this) {  // something stands between a surface and a light
    Lit& lit = lit_[ray.question];
    lit.radiance *= shares.passed;
    if (!(shares.passed > 0) || ray.turns >= kMaxTurns) return;
    onward.push_back(ray);
    onward.back().t_min_m = surface.range_m + 2 * surface.error_bound_m;
    ++onward.back().turns;
    return;
  }
  if (is_splat_item(*context.scene, surface.item)) {  // its colour is the light that it sends
    sky_[ray.beam] -= ray.share;
    radiance_[ray.beam] += ray.share * mean(glm::vec3(surface.base_color));
    return;
  }
  sky_[ray.beam] -= ray.share * (1 - shares.reflected * shares.reflected - shares.passed * shares.passed);
  const double seen = ray.share * reflects * shares.matte;
  radiance_[ray.beam] += seen * mean(context.scene->environment.ambient);
  for (const Sun& sun : suns_) {
    const double light = glm::dot(surface.normal, sun.towards);
    if (!(light > 0) || !(seen > 0) || sun.irradiance == 0) continue;
    BeamRay& question = onward.emplace_back(onward_ray(ray, surface, sun.towards, light));
    question.asked_by = this;
    question.question = static_cast<std::uint32_t>(lit_.size());
    lit_.push_back({ray.beam, seen * sun.irradiance * light / std::numbers::pi});
  }
}

// The standard deviation of the receiver's noise, in units of that in the dark.
double Sunlight::noise(const ScanContext& context, std::uint32_t beam) const {
  if (!counted_) {
    for (const Lit& lit : lit_) radiance_[lit.beam] += lit.radiance;
    counted_ = true;
  }
  const double sky = std::max(sky_[beam], 0.0) * mean(glm::vec3(mean_background(*context.scene)));
  return std::sqrt(1 + sunlight_ * (radiance_[beam] + sky));
}

void Sunlight::receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const {
  if (echoes.empty()) return;
  const double threshold = noise(context, beam) * threshold_;
  std::uint32_t draw = 0;
  std::erase_if(echoes, [&](const Echo& echo) {
    const double in_the_dark = has_dropout_ ? kept_share(echo.power, threshold_, spread_) : 1;
    return !(random_.uniform(random_key(context.time), beam, draw++) * in_the_dark <
             kept_share(echo.power, threshold, spread_));
  });
}

}  // namespace simvis
