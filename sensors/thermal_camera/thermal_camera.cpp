#include "sensors/thermal_camera/thermal_camera.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <simvis/pose.h>
#include <simvis/surface_point.h>
#include "engine/base/srgb.h"
#include "sensors/camera/camera_outputs.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/thermal_camera/band_radiance.h"
#include "sensors/thermal_camera/false_color.h"
#include "sensors/thermal_camera/thermal_camera_presets.h"

namespace simvis {
namespace {

constexpr double kMaxCount = 65535;

std::vector<OutputSpec> thermal_camera_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  OutputSpec color = color_output("color", a);
  color.meaning = "false colours of the apparent temperature, linear RGB, and alpha, which is always 1";
  return {{.name = "temperature",
           .kind = OutputKind::image,
           .value_type = ValueType::f32,
           .shape = image_shape(a, 1),
           .unit = "K",
           .meaning = "apparent temperature: that of a black body of the same radiance from 8 to 14 um",
           .when = "temperature among outputs",
           .given = a.flag("outputs", "temperature")},
          {.name = "raw16",
           .kind = OutputKind::image,
           .value_type = ValueType::u32,
           .shape = image_shape(a, 1),
           .content = ImageContent::counts,
           .meaning = "apparent temperature in counts of kelvin_per_count, at most 65535",
           .message = std::string(kImageMessage),
           .when = "raw16 among outputs",
           .given = a.flag("outputs", "raw16")},
          color};
}

const SensorRegistration kThermalCameraRegistration(
    {.name = "thermal_camera",
     .summary = "A thermal camera: apparent temperature of surfaces by their radiance from 8 to 14 um.",
     .notes = "Elements temperature and thermal_surroundings say how warm surfaces, surroundings and the sky are. A "
              "surface of low emissivity reflects the surroundings and appears about as warm as they are. Glass is "
              "opaque. Noise, pattern and time constant are those of a microbolometer; each is off unless its "
              "attribute asks for it.",
     .capabilities = kHasLens,
     .attributes = rows_of<ThermalCameraDesc>().table(),
     .create = create_sensor<ThermalCamera, ThermalCameraDesc>,
     .presets = thermal_camera_presets(),
     .outputs = thermal_camera_outputs});

std::vector<std::uint32_t> tiled_pixels(std::uint32_t width_px, std::uint32_t height_px) {
  std::vector<std::uint32_t> pixels;
  pixels.reserve(std::size_t{width_px} * height_px);
  for_tiled_pixels(0, height_px, width_px, [&](std::uint32_t pixel) { pixels.push_back(pixel); });
  return pixels;
}

// A material whose alpha is that of the picture.
std::shared_ptr<const Material> picture_material(const Material& look, const SurfaceHeat& heat) {
  Material material = look;
  material.base_color = glm::vec4(1);
  material.base_color_texture = heat.texture;
  return std::make_shared<const Material>(std::move(material));
}

}  // namespace

AttributeRows<ThermalCameraDesc> ThermalCameraDesc::rows() {
  using Desc = ThermalCameraDesc;
  constexpr AttributeLimits kSeen{.min = 0, .max = kHottest_k};
  return {kPresetAttribute,
          nested(&Desc::pinhole, PinholeDesc::rows()),
          row(&Desc::footprint_rays, "footprint_rays", {{1, "1"}, {4, "4"}, {16, "16"}, {64, "64"}},
              "rays of each pixel, on a regular grid: the radiance of a pixel is their mean"),
          nested(&Desc::bolometer, BolometerDesc::rows()),
          row(&Desc::kelvin_per_count, "kelvin_per_count", "K", AttributeLimits{.min = 1e-4, .max = 100},
              "temperature of one count of raw16"),
          row(&Desc::color_min_k, "color_min", "K", kSeen,
              "temperature that is black in false colours; default: the lowest of each frame"),
          row(&Desc::color_max_k, "color_max", "K", kSeen,
              "temperature that is white in false colours; default: the highest of each frame"),
          flags_row<Desc>("outputs",
                          {{"temperature", &Desc::temperature}, {"raw16", &Desc::raw16}, {"color", &Desc::color}},
                          "what the camera measures"),
          kRateAttribute};
}

void ThermalCameraDesc::complete(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  effects = camera_effects(kHasLens, {a, context.seed, context.name, shown_outputs(true, true)});
  check_cast_pixels(pinhole, a);
  if (color_min_k && color_max_k && !(*color_min_k < *color_max_k)) {
    fail_at(a.where("color_max"), "attribute \"color_max\": " + format_number(*color_max_k) +
                                      " is not allowed, expected more than color_min, which is " +
                                      format_number(*color_min_k));
  }
}

ThermalCamera::ThermalCamera(std::string name, const ThermalCameraDesc& desc)
    : name_(std::move(name)),
      desc_(desc),
      optics_(name_, camera_layout(desc.pinhole, desc.effects), desc.pinhole.near_m),
      tiled_(tiled_pixels(desc.pinhole.width_px, desc.pinhole.height_px)),
      layer_world_(SurfaceLayer::first),
      bolometer_(desc.bolometer, desc.seed, name_, tiled_.size()) {}

HistoryDependence ThermalCamera::history_dependence() const {
  return desc_.bolometer.time_constant_s > 0 ? HistoryDependence::measurements : HistoryDependence::none;
}

void ThermalCamera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  moment_.world_from_sensor = world_from_sensor;
  world_from_view_ = world_from_sensor * sensor_from_view();
  list_ = &layer_world_.begin(list);
  plan.casts.push_back({.name = name_,
                        .reason = "the pixels of thermal camera " + name_,
                        .max_rays = std::uint64_t{desc_.footprint_rays} * tiled_.size()});
  plan_effects(name_, desc_.effects, plan);
}

void ThermalCamera::cast(RayCaster& of_list) {
  RayCaster& caster = layer_world_.caster(of_list);
  ambient_radiance_ = band_radiance(heat_.surroundings.ambient_k);
  sky_radiance_ = band_radiance(heat_.surroundings.sky_k);
  emitted_.clear();
  for (const SurfaceHeat& each : heat_.surfaces) {
    emitted_.push_back(each.emissivity * band_radiance(each.temperature_k) + (1 - each.emissivity) * ambient_radiance_);
  }
  prepare_textures();
  radiance_.assign(tiled_.size(), 0);
  if (footprint_.empty()) footprint_ = optics_.footprint(desc_.footprint_rays, tiled_);
  for (const PixelFan& fan : footprint_) cast_rays(caster, fan);
  bolometer_.read(moment_.time, radiance_);
  publish();
}

void ThermalCamera::cast_rays(RayCaster& caster, const PixelFan& fan) {
  const auto& [pixels, directions, near_m] = fan;
  std::vector<SeenSurface> seen(pixels.size());
  rays_.cast(caster, *list_, world_from_view_, directions, near_m, seen);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    radiance_[pixels[i]] += radiance_of(seen[i], directions[i]) / desc_.footprint_rays;
  }
}

double ThermalCamera::radiance_of(const SeenSurface& surface, const glm::dvec3& direction) const {
  if (surface.item == kNoItem) return sky_radiance_;
  const std::uint32_t source = heat_.of_item[surface.item];
  const SurfaceHeat& heat = heat_.surfaces[source];
  return heat.texture == nullptr ? emitted_[source] : textured_radiance(surface, direction, heat);
}

double ThermalCamera::textured_radiance(const SeenSurface& surface, const glm::dvec3& direction,
                                        const SurfaceHeat& heat) const {
  const RayHit hit{surface.range_m, surface.error_bound_m, surface.item, surface.primitive};
  const double share = std::clamp(
      static_cast<double>(surface_point(textured_list_, world_from_view_, direction, hit).base_color.a), 0.0, 1.0);
  const double temperature_k = heat.temperature_k + share * (heat.white_k - heat.temperature_k);
  return heat.emissivity * band_radiance(temperature_k) + (1 - heat.emissivity) * ambient_radiance_;
}

// The list is copied in each frame in which anything has a picture.
void ThermalCamera::prepare_textures() {
  const bool any = std::ranges::any_of(heat_.surfaces, [](const SurfaceHeat& each) { return each.texture != nullptr; });
  if (!any) {
    textured_list_ = {};
    return;
  }
  textured_list_ = *list_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> materials;  // by look and by heat
  for (std::size_t i = 0; i < textured_list_.items.size(); ++i) {
    DrawItem& item = textured_list_.items[i];
    const std::uint32_t source = heat_.of_item[i];
    if (heat_.surfaces[source].texture == nullptr) continue;
    const auto count = static_cast<std::uint32_t>(textured_list_.materials.size());
    const auto [known, is_new] = materials.try_emplace({item.material, source}, count);
    if (is_new) {
      textured_list_.materials.push_back(
          picture_material(*textured_list_.materials[item.material], heat_.surfaces[source]));
    }
    item.material = known->second;
  }
}

void ThermalCamera::publish() {
  const std::size_t pixels = radiance_.size();
  std::vector<double> temperatures_k(pixels);
  std::ranges::transform(radiance_, temperatures_k.begin(), band_temperature_k);
  const auto image = [&](std::uint32_t channels) {
    return Image{desc_.pinhole.width_px, desc_.pinhole.height_px, channels, std::vector<float>(pixels * channels)};
  };
  if (desc_.temperature) {
    temperature_ = image(1);
    std::ranges::transform(temperatures_k, temperature_.pixels.edit().begin(),
                           [](double kelvin) { return static_cast<float>(kelvin); });
  }
  if (desc_.raw16) {
    counts_.overwrite().resize(pixels);
    std::ranges::transform(temperatures_k, counts_.edit().begin(), [&](double kelvin) {
      return static_cast<std::uint32_t>(std::min(std::round(kelvin / desc_.kelvin_per_count), kMaxCount));
    });
  }
  if (desc_.color) {
    color_ = image(4);
    const auto [lowest, highest] = std::ranges::minmax(temperatures_k);
    const double low_k = desc_.color_min_k.value_or(lowest), high_k = desc_.color_max_k.value_or(highest);
    std::vector<float>& colors = color_.pixels.edit();
    for (std::size_t i = 0; i < pixels; ++i) {
      const double share = high_k > low_k ? std::clamp((temperatures_k[i] - low_k) / (high_k - low_k), 0.0, 1.0) : 0;
      const glm::dvec3 code = false_color(share);
      for (int c = 0; c < 3; ++c) colors[4 * i + static_cast<std::size_t>(c)] = linear_from_srgb(code[c]);
      colors[4 * i + 3] = 1;
    }
  }
  measured_ = moment_;
}

Measurement ThermalCamera::measurement() const {
  Measurement measurement = optics_.measurement(measured_);
  if (desc_.temperature) {
    measurement.arrays.push_back(image_array("temperature", temperature_, ImageContent::numbers, "K"));
  }
  if (desc_.raw16) {
    const bool measured = !counts_.empty();
    measurement.arrays.push_back(
        {{.name = "raw16",
          .kind = OutputKind::image,
          .value_type = ValueType::u32,
          .shape = {measured ? desc_.pinhole.height_px : 0, measured ? desc_.pinhole.width_px : 0, 1},
          .content = ImageContent::counts},
         counts_});
  }
  if (desc_.color) measurement.arrays.push_back(image_array("color", color_, ImageContent::color));
  return measurement;
}

}  // namespace simvis
