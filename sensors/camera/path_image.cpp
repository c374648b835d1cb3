#include "sensors/camera/path_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <utility>

#include "engine/splats/seen_splats.h"
#include "sensors/camera/camera_outputs.h"

namespace simvis {
namespace {

// Paths that are followed together; each takes about 700 bytes.
constexpr std::size_t kPathsAtOnce = std::size_t{1} << 16;
// What names the random time and point of the lens of a sample: no pixel has it, see kMaxCastPixels.
constexpr std::uint32_t kOfAllPixels = ~0u;
enum SharedDraw : std::uint32_t { kTimeDraw, kLensRadiusDraw, kLensAngleDraw };
// Random numbers of a pixel before those of its path.
enum PixelDraw : std::uint32_t { kColumnDraw, kRowDraw, kPixelDraws };

// That of one moment through the centre of the lens.
CameraLayout at_once(CameraLayout layout) {
  layout.exposure = {};
  layout.row_time_s = 0;
  return layout;
}

// Whether a ray can meet what covers less than all, which casters let pass or take for solid.
bool has_layers(const DrawList& list) {
  return std::ranges::any_of(list.materials, [](const std::shared_ptr<const Material>& material) {
    return material->alpha_mode == AlphaMode::blend || material->opacity < 1;
  });
}

// Rays hit triangles and shapes: neither lines nor points without a size.
bool has_thin_items(const DrawList& list) {
  return std::ranges::any_of(list.items, [&](const DrawItem& item) {
    const Mesh& mesh = *list.meshes[item.mesh];
    return item.visible && mesh.topology != Topology::triangles && !mesh.surface && !mesh.splats;
  });
}

// Each has its first light, of those that stand for it.
bool has_several_sky_pictures(const DrawList& list) {
  return std::ranges::count_if(list.lights, [](const LightItem& item) {
           return item.light.lamp_shape == LampShape::sky_picture && item.light.lamp_point == 0;
         }) > 1;
}

std::string three_digits(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", number);
  return text.data();
}

[[noreturn]] void refuse(const AttributeValues& attributes, std::string_view name, const std::string& why) {
  fail_at(attributes.where(name), "attribute \"" + std::string(name) + "\": " + why);
}

}  // namespace

AttributeRows<PathSampling> PathSampling::rows() {
  using Desc = PathSampling;
  return {
      row(&Desc::light, "light", {{CameraLight::drawn, "drawn"}, {CameraLight::path, "path"}},
          "drawn: colour is drawn, with the light that comes straight from lamps; path: colour is the mean of random "
          "paths of light, without a Vulkan device"),
      row(&Desc::samples, "samples", "", {.min = 1, .max = PixelEstimate::kMaxSamples},
          "with light=\"path\": paths through each pixel; default: 16"),
      row(&Desc::noise, "noise", "", kAboveZero,
          "with light=\"path\", in place of samples: standard error of linear radiance, the root mean square over the "
          "pixels of a tile of 16 x 16 and R, G and B; each tile takes the fewest samples for it, at least 18"),
      row(&Desc::bounces, "bounces", "", {.min = 0, .max = 64},
          "with light=\"path\": reflections of light between its source and the camera at most; 1: light that comes "
          "straight from its source; default: 4"),
      checked<Desc>([](Desc& desc, const AttributeValues& attributes) {
        desc.light_at = attributes.where("light");
        desc.stddev = attributes.flag("outputs", "color_stddev");
      })};
}

void PathSampling::check(const AttributeValues& attributes, bool color, const ColorSampling& sampling) const {
  if (!by_paths()) {
    const std::string why = "a drawn picture has none, expected light=\"path\" beside it";
    if (samples) refuse(attributes, "samples", why);
    if (noise) refuse(attributes, "noise", why);
    if (bounces) refuse(attributes, "bounces", why);
    if (stddev) refuse(attributes, "outputs", "color_stddev: " + why);
    return;
  }
  if (!color && !stddev) {
    refuse(attributes, "light", "paths are of colour, expected color or color_stddev among outputs");
  }
  if (samples && noise) refuse(attributes, "samples", "noise decides how many there are, expected one of the two");
  if (stddev && number_of_samples() < 2) {
    refuse(attributes, "samples", "one sample shows no standard deviation, expected at least 2 with color_stddev");
  }
  const std::string why = "paths go through the whole square of each pixel, expected light=\"drawn\" beside it";
  if (sampling.supersampling > 1) refuse(attributes, "supersampling", why);
  if (sampling.msaa > 1) refuse(attributes, "msaa", why);
  if (sampling.max_error_px > 0) refuse(attributes, "max_error_px", "paths hit every triangle, expected 0");
}

OutputSpec color_stddev_output(std::string name, const AttributeValues& attributes) {
  return {
      .name = std::move(name),
      .kind = OutputKind::image,
      .value_type = ValueType::f32,
      .shape = image_shape(attributes, 3),
      .meaning = "standard deviation of color by its random paths, before effects of the camera: linear RGB radiance",
      .when = "color_stddev among outputs",
      .given = attributes.flag("outputs", "color_stddev")};
}

PathImage::PathImage(const PathSampling& sampling, const std::string& sensor, std::uint64_t seed,
                     const CameraLayout& layout, double near_m)
    : sampling_(sampling),
      sensor_(sensor),
      seed_(seed),
      exposure_(layout.exposure),
      optics_(sensor, at_once(layout), near_m),
      tracer_(sampling.number_of_bounces()),
      estimate_(layout.width_px, layout.height_px, sampling.number_of_samples(), sampling.noise) {
  if (exposure_.magnification == glm::dvec3(1)) return;
  fail_at(exposure_.magnification_at,
          "attribute \"color_magnification\": paths have all colours, expected light=\"drawn\" or no magnification");
}

// Each reflection casts a ray for the path, and one to each kind of light source. How many surfaces rays pass depends
// on the scene.
void PathImage::plan(const std::string& title, FramePlan& plan) const {
  constexpr std::uint64_t kRaysOfReflection = 4;
  const std::uint32_t samples = sampling_.number_of_samples();
  plan.casts.push_back(
      {.name = sensor_,
       .reason = "paths of light of " + title + ": " + (sampling_.noise ? "up to " : "") + std::to_string(samples) +
                 " through each pixel, of up to " + std::to_string(sampling_.number_of_bounces()) +
                 " bounces, and again behind each gap and pane of glass",
       .max_rays = optics_.pixels() * samples * (1 + kRaysOfReflection * sampling_.number_of_bounces()),
       .colors = true});
}

void PathImage::begin(const DrawList& list, const FrameTime& time) {
  if (has_splats(list)) {
    fail_at(sampling_.light_at,
            "attribute \"light\": paths do not reflect at Gaussian splats, which the scene has, expected \"drawn\" or "
            "their part in \"ignore\"");
  }
  if (has_thin_items(list)) {
    fail_at(sampling_.light_at,
            "attribute \"light\": paths do not hit lines, and points without a size, which the scene has, expected "
            "\"drawn\" or their part in \"ignore\"");
  }
  if (has_several_sky_pictures(list)) {
    fail_at(sampling_.light_at,
            "attribute \"light\": paths take the light of one picture of the sky, and the scene has several, expected "
            "\"drawn\" or one element sky_light with a picture");
  }
  list_ = &list;
  is_own_ = has_layers(list);
  world_.set(is_own_ ? first_.follow(list) : list);
  still_from_.reset();
  frame_ = random_key(time);
  estimate_.begin();
}

double PathImage::time_s(std::uint32_t sample) const {
  return exposure_.time_s == 0 ? 0 : -exposure_.time_s * random_of(sample).uniform(frame_, kOfAllPixels, kTimeDraw);
}

void PathImage::take(std::uint32_t sample, RayCaster& caster, std::span<const PixelRows> rows) {
  const SensorRandom random = random_of(sample);
  glm::dvec2 lens_m(0);
  if (exposure_.aperture_m > 0) {
    const double radius = exposure_.aperture_m * std::sqrt(random.uniform(frame_, kOfAllPixels, kLensRadiusDraw));
    const double angle = 2 * std::numbers::pi * random.uniform(frame_, kOfAllPixels, kLensAngleDraw);
    lens_m = {radius * std::cos(angle), radius * std::sin(angle)};
  }
  for (const PixelRows& each : rows) take_rows(caster, each, sample, lens_m);
}

// The lens is a pinhole at `lens_m`, through which the plane of focus is seen where the centre of the lens shows it.
PathStart PathImage::start(std::uint32_t pixel, const SensorRandom& random, const glm::dvec2& lens_m) const {
  const double x = random.uniform(frame_, pixel, kColumnDraw), y = random.uniform(frame_, pixel, kRowDraw);
  const glm::dvec3 through = optics_.direction(pixel, glm::dvec2(x, y) - 0.5);
  if (through == glm::dvec3(0) || exposure_.aperture_m == 0) {
    return {pixel, through, through == glm::dvec3(0) ? 0 : optics_.near_range_m(through), kPixelDraws};
  }
  const glm::dvec3 in_focus = through * (exposure_.focus_m / through.z);
  const glm::dvec3 direction = glm::normalize(in_focus - glm::dvec3(lens_m, 0));
  return {pixel, direction, optics_.near_range_m(direction), kPixelDraws};
}

// A scene that stands as the tracer has it stays.
void PathImage::set_scene(RayCaster& caster, std::span<const ItemPlace> places, const glm::dmat4& world_from_view) {
  if (places.empty() && still_from_ == world_from_view) return;
  const bool elsewhere = is_own_ || !places.empty();
  const DrawList& list = elsewhere ? world_.place(places, caster.threads()) : *list_;
  tracer_.set({.list = &list,
               .materials = &list_->materials,
               .caster = elsewhere ? &world_.caster() : &caster,
               .world_from_view = world_from_view});
  still_from_.reset();
  if (places.empty()) still_from_ = world_from_view;
}

void PathImage::take_rows(RayCaster& caster, const PixelRows& rows, std::uint32_t sample, const glm::dvec2& lens_m) {
  if (!estimate_.takes_some(sample, rows.first, rows.count)) return;
  set_scene(caster, rows.places, glm::translate(rows.world_from_view, glm::dvec3(lens_m, 0)));
  const SensorRandom random = random_of(sample);
  const auto trace = [&] {
    caster.parallel_for(starts_.size(), RayCaster::kPacketSize, [&](std::size_t, std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) starts_[i] = start(starts_[i].pixel, random, lens_m);
    });
    const auto shows_nothing = [](const PathStart& each) { return each.direction == glm::dvec3(0); };
    for (const PathStart& each : starts_) {
      if (shows_nothing(each)) estimate_.add(sample, each.pixel, glm::dvec3(0));
    }
    std::erase_if(starts_, shows_nothing);
    radiance_.resize(starts_.size());
    tracer_.trace(starts_, random, frame_, radiance_);
    for (std::size_t i = 0; i < starts_.size(); ++i) estimate_.add(sample, starts_[i].pixel, radiance_[i]);
    starts_.clear();
  };
  estimate_.for_pixels(sample, rows.first, rows.count, [&](std::uint32_t pixel) {
    starts_.push_back({.pixel = pixel});
    if (starts_.size() == kPathsAtOnce) trace();
  });
  trace();
}

void PathImage::finish(Image& color) {
  const std::uint32_t width_px = optics_.layout().width_px, height_px = optics_.layout().height_px;
  color.width = stddev_.width = width_px;
  color.height = stddev_.height = height_px;
  color.channels = 4;
  stddev_.channels = 3;
  std::vector<float>&colors = color.pixels.overwrite(), &deviations = stddev_.pixels.overwrite();
  const std::uint32_t pixels = width_px * height_px;
  colors.assign(4 * std::size_t{pixels}, 1);
  deviations.resize(sampling_.stddev ? 3 * std::size_t{pixels} : 0);
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
    const glm::vec3 mean(estimate_.mean(pixel));
    std::copy_n(&mean[0], 3, &colors[4 * std::size_t{pixel}]);
    if (!sampling_.stddev) continue;
    const glm::vec3 deviation(glm::sqrt(estimate_.variance(pixel)));
    std::copy_n(&deviation[0], 3, &deviations[3 * std::size_t{pixel}]);
  }
  if (sampling_.noise) reached_ = estimate_.reached();
}

SensorReport PathImage::report() const {
  if (!reached_) return {};
  const ReachedNoise& r = *reached_;
  return {.notes = {{"path_samples", r.samples},
                    {"max_path_samples", static_cast<double>(r.max_samples)},
                    {"path_noise", r.error},
                    {"max_path_noise", r.max_error}},
          .explanation = "paths of " + sensor_ + ": " + three_digits(r.samples) + " samples in the mean, at most " +
                         std::to_string(r.max_samples) + ", reach the standard error " + three_digits(r.error) +
                         " of linear radiance, " + three_digits(r.max_error) + " in the tile with the most; " +
                         std::to_string(r.tiles_above) + " of " + std::to_string(r.tiles) + " tiles are above " +
                         format_number(*sampling_.noise) + '\n'};
}

}  // namespace simvis
