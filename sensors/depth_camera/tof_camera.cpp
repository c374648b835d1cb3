#include "sensors/depth_camera/tof_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include <simvis/pose.h>
#include <simvis/surface_point.h>
#include "effects/scanner/reflectance.h"
#include "engine/base/poisson.h"
#include "engine/splats/seen_splats.h"
#include "sensors/camera/camera_outputs.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/cloud_attributes.h"

namespace simvis {
namespace {

constexpr double kLightSpeed_mps = 299792458, kTwoPi = 2 * std::numbers::pi;
// What is nearer to a surface than this share of its range belongs to it.
constexpr double kTouching = 1e-6;

constexpr PresetAttribute kSr4000[] = {{"width", "176"}, {"height", "144"}, {"hfov", "43.6"}, {"frequency", "30e6"}};

// 1 / 3.86^2 of the amplitude at 1 m.
constexpr PresetAttribute kAzureKinect[] = {{"width", "640"},      {"height", "576"},           {"hfov", "75"},
                                            {"frequency", "30e6"}, {"amplitude_min", "0.0671"}, {"rate", "30"}};

constexpr SensorPreset kTofPresets[] = {
    {"mesa_sr4000", "MESA SwissRanger SR4000 at 30 MHz, 5 m",
     "Player 3, driver swissranger (30 MHz, 5 m); pixels: the article Time-of-flight camera of Wikipedia; field of "
     "view: not compared with MESA's data sheet",
     kSr4000, "Not found: the light of the lamp, noise, and a smallest amplitude."},
    {"azure_kinect", "Microsoft Azure Kinect DK, NFOV unbinned, 30 frames a second",
     "Microsoft, Azure Kinect DK hardware specifications, depth camera supported operating modes", kAzureKinect,
     "The largest range of 3.86 m holds for a white surface that faces the camera: the smallest amplitude is the one "
     "there. The smallest range of 0.5 m is not simulated. Frequency: of SimVis, so that ranges begin again beyond the "
     "largest one. Not taken over: the random error of at most 17 mm."},
};

std::vector<OutputSpec> tof_camera_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  OutputSpec depth = depth_output("depth", a);
  depth.meaning = "measured depth along the optical axis";
  depth.bound.clear();
  const auto image = [&](const char* name, const char* unit, const char* meaning, std::optional<double> nothing) {
    return OutputSpec{.name = name,
                      .kind = OutputKind::image,
                      .value_type = ValueType::f32,
                      .shape = depth.shape,
                      .unit = unit,
                      .meaning = meaning,
                      .nothing = nothing,
                      .when = std::string(name) + " among outputs",
                      .given = a.flag("outputs", name)};
  };
  return {depth,
          image("range", "m", "measured range along the ray through the pixel's centre",
                std::numeric_limits<double>::infinity()),
          image("amplitude", "", "amplitude of the modulation; 1: that of a white surface that faces the camera at 1 m",
                {})};
}

const SensorRegistration kTofCameraRegistration(
    {.name = "tof_camera",
     .summary = "A time-of-flight camera: range by the phase of modulated light, from four samples of each pixel.",
     .notes = "Ranges begin again at c / (2 frequency). Pixels at edges, corners that reflect light from wall to wall, "
              "and noise over a small amplitude mislead it as they do a real one; each is off unless its attribute "
              "asks for it.",
     .capabilities = kHasLens | kSeesSplats | kRaysHitSplats,
     .attributes = rows_of<TofCameraDesc>().table(),
     .create = create_sensor<TofCamera, TofCameraDesc>,
     .presets = kTofPresets,
     .outputs = tof_camera_outputs});

// A direction with a density by its cosine to the normal, for two numbers in [0, 1).
glm::dvec3 cosine_direction(const glm::dvec3& normal, double u, double v) {
  const glm::dvec3 across = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 a = glm::normalize(glm::cross(normal, across)), b = glm::cross(normal, a);
  const double radius = std::sqrt(u), angle = kTwoPi * v;
  return glm::normalize(radius * std::cos(angle) * a + radius * std::sin(angle) * b + std::sqrt(1 - u) * normal);
}

// Of the radical inverse in base 2: evenly spread numbers in [0, 1).
double van_der_corput(std::uint32_t i) {
  double value = 0;
  for (double digit = 0.5; i != 0; i >>= 1, digit /= 2) value += (i & 1) != 0 ? digit : 0;
  return value;
}

Image blank_image(std::uint32_t width_px, std::uint32_t height_px) {
  return {width_px, height_px, 1, std::vector<float>(std::size_t{width_px} * height_px)};
}

}  // namespace

double TofCameraDesc::wrap_m() const { return kLightSpeed_mps / (2 * frequency_hz); }

AttributeRows<TofCameraDesc> TofCameraDesc::rows() {
  using Desc = TofCameraDesc;
  constexpr AttributeLimits kElectrons{.min = 0, .max = 1e9};
  return {
      kPresetAttribute,
      nested(&Desc::pinhole, PinholeDesc::rows()),
      row(&Desc::frequency_hz, "frequency", "Hz", AttributeLimits{.min = 0, .max = 1e12, .open_min = true},
          "frequency f of the modulation: ranges begin again at c / (2 f)"),
      row(&Desc::signal_e, "signal_e", "electrons", kElectrons,
          "of one sample by light from a white surface that faces the camera at 1 m; 0: no noise"),
      row(&Desc::contrast, "contrast", "", AttributeLimits{.min = 0, .max = 1, .open_min = true},
          "amplitude of the modulation as a share of the mean"),
      row(&Desc::ambient_e, "ambient_e", "electrons", kElectrons, "of one sample by other light, with signal_e"),
      row(&Desc::read_noise_e, "read_noise_e", "electrons", kElectrons,
          "standard deviation of the read noise of one sample, with signal_e"),
      row(&Desc::amplitude_min, "amplitude_min", "", kNotNegative,
          "pixels of less amplitude have no range; 1: that of a white surface that faces the camera at 1 m"),
      row(&Desc::footprint_rays, "footprint_rays", {{1, "1"}, {4, "4"}, {16, "16"}, {64, "64"}},
          "rays of each pixel, on a regular grid: pixels that see two objects measure a mixture"),
      row(&Desc::bounce_rays, "bounce_rays", "", AttributeLimits{.min = 0, .max = 65536},
          "rays from each surface that is seen, for light that comes there from another one; 0: none does"),
      flags_row<Desc>("outputs", {{"depth", &Desc::depth}, {"range", &Desc::range}, {"amplitude", &Desc::amplitude}},
                      "what the camera measures"),
      kDenseAttribute,
      kRateAttribute};
}

void TofCameraDesc::complete(const SensorContext& context) {
  check_cast_pixels(pinhole, context.attributes);
  effects = camera_effects(kHasLens, {context.attributes, context.seed, context.name, shown_outputs(false, true)});
}

TofCamera::TofCamera(std::string name, const TofCameraDesc& desc)
    : name_(std::move(name)),
      desc_(desc),
      optics_(name_, camera_layout(desc.pinhole, desc.effects), desc.pinhole.near_m),
      noise_(desc.seed, name_ + "/samples"),
      bounces_(desc.seed, name_ + "/bounces") {}

void TofCamera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  moment_.world_from_sensor = world_from_sensor;
  list_ = &list;
  const std::uint64_t rays = std::uint64_t{desc_.pinhole.width_px} * desc_.pinhole.height_px * desc_.footprint_rays;
  plan.casts.push_back({.name = name_,
                        .reason = "the pixels of time-of-flight camera " + name_ +
                                  (desc_.bounce_rays > 0 ? ", and light of one bounce" : ""),
                        .max_rays = rays * (1 + 2 * std::uint64_t{desc_.bounce_rays}),
                        .colors = true});
  plan_effects(name_, desc_.effects, plan);
}

void TofCamera::add(std::uint32_t pixel, double amplitude, double length_m) {
  const double share = amplitude / desc_.footprint_rays;
  lights_[pixel].phasor += std::polar(share, kTwoPi * desc_.frequency_hz * length_m / kLightSpeed_mps);
  lights_[pixel].sum += share;
}

void TofCamera::cast(RayCaster& caster) {
  lights_.assign(optics_.pixels(), {});
  if (footprint_.empty()) {
    std::vector<std::uint32_t> pixels(optics_.pixels());
    std::iota(pixels.begin(), pixels.end(), 0u);
    footprint_ = optics_.footprint(desc_.footprint_rays, pixels);
  }
  for (std::uint32_t ray = 0; ray < desc_.footprint_rays; ++ray) {
    const std::vector<LitPoint> lit = cast_direct(caster, footprint_[ray]);
    for (std::uint32_t bounce = 0; bounce < desc_.bounce_rays; ++bounce) {
      add_lit(caster, cast_bounce(caster, lit, ray, bounce));
    }
  }
  publish();
}

// Splats before the t_min of a ray stop light of it. Where there are splats, rays begin at near_m instead.
std::vector<TofCamera::ViewHit> TofCamera::cast_view(RayCaster& caster, std::span<const glm::dvec3> directions,
                                                     std::span<const double> near_m) const {
  const glm::dmat4 world_from_view = moment_.world_from_sensor * sensor_from_view();
  const bool begins_at_near = has_splats(*list_);
  std::vector<RayHit> hits(directions.size());
  if (begins_at_near) {
    std::vector<glm::dvec3> origins_m;
    for (std::size_t i = 0; i < directions.size(); ++i) origins_m.push_back(near_m[i] * directions[i]);
    caster.cast_from(world_from_view, origins_m, directions, hits);
  } else {
    caster.cast(world_from_view, directions, hits, near_m);
  }
  std::vector<ViewHit> from_near;
  for (std::size_t i = 0; i < hits.size(); ++i) from_near.push_back({hits[i], begins_at_near ? near_m[i] : 0});
  return from_near;
}

std::vector<TofCamera::LitPoint> TofCamera::cast_direct(RayCaster& caster, const PixelFan& fan) {
  const glm::dmat4 world_from_view = moment_.world_from_sensor * sensor_from_view();
  const auto& [pixels, directions, near_m] = fan;
  const std::vector<ViewHit> hits = cast_view(caster, directions, near_m);
  std::vector<LitPoint> lit;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double range_m = hits[i].range_m();
    if (!std::isfinite(range_m)) continue;
    const glm::dmat4 world_from_near = glm::translate(world_from_view, hits[i].begins_m * directions[i]);
    const SurfacePoint surface = surface_point(*list_, world_from_near, directions[i], hits[i].hit);
    const double reflected = reflectance(surface), cosine = -glm::dot(surface.normal, directions[i]);
    add(pixels[i], reflected * cosine / (range_m * range_m), 2 * range_m);
    if (is_splat(hits[i].hit)) continue;
    lit.push_back({pixels[i], range_m * directions[i], surface.normal, range_m, reflected});
  }
  return lit;
}

// One ray from each point that is seen, to where light may come from.
std::vector<TofCamera::Path> TofCamera::cast_bounce(RayCaster& caster, const std::vector<LitPoint>& lit,
                                                    std::uint32_t ray, std::uint32_t bounce) const {
  const glm::dmat4 world_from_view = moment_.world_from_sensor * sensor_from_view();
  std::vector<glm::dvec3> origins_m(lit.size()), directions(lit.size());
  std::vector<double> behind_m(lit.size());
  std::vector<RayHit> hits(lit.size());
  // Evenly spread points of the square, moved by a random vector for each pixel.
  const double u = (bounce + 0.5) / desc_.bounce_rays, v = van_der_corput(bounce);
  for (std::size_t i = 0; i < lit.size(); ++i) {
    const auto moved = [&](double value, std::uint32_t draw) {
      const double sum = value + bounces_.uniform(ray, lit[i].pixel, draw);
      return sum - std::floor(sum);
    };
    origins_m[i] = lit[i].point_m;
    directions[i] = cosine_direction(lit[i].normal, moved(u, 0), moved(v, 1));
    behind_m[i] = kTouching * lit[i].range_m;
  }
  caster.cast_from(world_from_view, origins_m, directions, hits, behind_m);
  std::vector<Path> paths;
  for (std::size_t i = 0; i < lit.size(); ++i) {
    if (!std::isfinite(hits[i].range_m) || is_splat(hits[i])) continue;
    const glm::dvec3 lit_m = origins_m[i] + hits[i].range_m * directions[i];
    if (!optics_.shows(lit_m)) continue;  // the lamp does not shine there
    const SurfacePoint surface =
        surface_point(*list_, glm::translate(world_from_view, origins_m[i]), directions[i], hits[i]);
    const double lamp_m = glm::length(lit_m), cosine = -glm::dot(surface.normal, lit_m) / lamp_m;
    if (!(cosine > 0)) continue;
    const double amplitude = lit[i].reflectance * reflectance(surface) * cosine / (lamp_m * lamp_m);
    paths.push_back({.pixel = lit[i].pixel,
                     .lit_m = lit_m,
                     .amplitude = amplitude / desc_.bounce_rays,
                     .length_m = lamp_m + hits[i].range_m + lit[i].range_m});
  }
  return paths;
}

// Adds those paths that nothing keeps the lamp's light from.
void TofCamera::add_lit(RayCaster& caster, const std::vector<Path>& paths) {
  std::vector<glm::dvec3> directions;
  std::vector<double> near_m;
  for (const Path& path : paths) {
    directions.push_back(glm::normalize(path.lit_m));
    near_m.push_back(optics_.near_range_m(directions.back()));
  }
  const std::vector<ViewHit> hits = cast_view(caster, directions, near_m);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const bool shaded = hits[i].range_m() < (1 - kTouching) * glm::length(paths[i].lit_m);
    if (!shaded) add(paths[i].pixel, paths[i].amplitude, paths[i].length_m);
  }
}

// The phasor that the four samples of the pixel give, in the unit of an amplitude.
std::complex<double> TofCamera::sampled(std::uint32_t pixel) const {
  const Light& light = lights_[pixel];
  if (desc_.signal_e == 0) return light.phasor;
  double samples[4];
  for (std::uint32_t k = 0; k < 4; ++k) {
    // |p| cos(arg p - k pi / 2)
    const double part = (k % 2 == 0 ? light.phasor.real() : light.phasor.imag()) * (k < 2 ? 1 : -1);
    const double mean_e = desc_.signal_e * (light.sum + desc_.contrast * part) + desc_.ambient_e;
    samples[k] = poisson(noise_, std::max(mean_e, 0.0), random_key(moment_.time), pixel, 2 * k);
    if (desc_.read_noise_e > 0)
      samples[k] += desc_.read_noise_e * noise_.gaussian(random_key(moment_.time), pixel, 2 * k + 1);
  }
  const double per_e = 1 / (2 * desc_.signal_e * desc_.contrast);
  return {per_e * (samples[0] - samples[2]), per_e * (samples[1] - samples[3])};
}

void TofCamera::publish() {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  depth_ = range_ = amplitude_ = blank_image(desc_.pinhole.width_px, desc_.pinhole.height_px);
  std::vector<float>&depths = depth_.pixels.edit(), &ranges = range_.pixels.edit(),
  &amplitudes = amplitude_.pixels.edit();
  for (std::uint32_t pixel = 0; pixel < lights_.size(); ++pixel) {
    const std::complex<double> phasor = sampled(pixel);
    const double amplitude = std::abs(phasor), turns = std::arg(phasor) / kTwoPi;
    const bool measured = lights_[pixel].sum > 0 && amplitude > 0 && amplitude >= desc_.amplitude_min;
    const double range_m = desc_.wrap_m() * (turns < 0 ? turns + 1 : turns);
    ranges[pixel] = measured ? static_cast<float>(range_m) : kNone;
    depths[pixel] = measured ? static_cast<float>(range_m * optics_.direction(pixel).z) : kNone;
    amplitudes[pixel] = static_cast<float>(amplitude);
  }
  measured_ = moment_;
}

Measurement TofCamera::measurement() const {
  Measurement measurement = optics_.measurement(measured_);
  const auto add_image = [&](bool wanted, const char* name, const Image& image, ImageContent content,
                             const char* unit) {
    if (wanted) measurement.arrays.push_back(image_array(name, image, content, unit));
  };
  add_image(desc_.depth, "depth", depth_, ImageContent::depth, "m");
  add_image(desc_.range, "range", range_, ImageContent::numbers, "m");
  add_image(desc_.amplitude, "amplitude", amplitude_, ImageContent::numbers, "");
  return measurement;
}

}  // namespace simvis
