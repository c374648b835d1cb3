#include "sensors/camera/path_image.h"

#include <algorithm>
#include <cmath>
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

std::vector<SensorRandom> random_of_samples(std::uint64_t seed, const std::string& sensor, std::uint32_t samples) {
  std::vector<SensorRandom> random;
  random.reserve(samples);
  for (std::uint32_t i = 0; i < samples; ++i) random.emplace_back(seed, sensor + "/path " + std::to_string(i));
  return random;
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
      row(&Desc::samples, "samples", "", {.min = 1, .max = 65536},
          "with light=\"path\": paths through each pixel; default: 16"),
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
    if (bounces) refuse(attributes, "bounces", why);
    if (stddev) refuse(attributes, "outputs", "color_stddev: " + why);
    return;
  }
  if (!color && !stddev) {
    refuse(attributes, "light", "paths are of colour, expected color or color_stddev among outputs");
  }
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
      random_(random_of_samples(seed, sensor, sampling.number_of_samples())),
      exposure_(layout.exposure),
      optics_(sensor, at_once(layout), near_m),
      tracer_(sampling.number_of_bounces()) {
  if (exposure_.magnification == glm::dvec3(1)) return;
  fail_at(exposure_.magnification_at,
          "attribute \"color_magnification\": paths have all colours, expected light=\"drawn\" or no magnification");
}

// Each reflection casts a ray for the path, and one to each kind of light source.
void PathImage::plan(const std::string& title, FramePlan& plan) const {
  constexpr std::uint64_t kRaysOfReflection = 4;
  plan.casts.push_back(
      {.name = sensor_,
       .reason = "paths of light of " + title + ": " + std::to_string(samples()) + " through each pixel, of up to " +
                 std::to_string(sampling_.number_of_bounces()) + " bounces",
       .max_rays = optics_.pixels() * samples() * (1 + kRaysOfReflection * sampling_.number_of_bounces()),
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
  list_ = &list;
  is_own_ = has_layers(list);
  world_.set(is_own_ ? first_.follow(list) : list);
  frame_ = random_key(time);
  of_sample_.assign(optics_.pixels(), glm::dvec3(0));
  mean_ = deviations_ = of_sample_;
}

double PathImage::time_s(std::uint32_t sample) const {
  return exposure_.time_s == 0 ? 0 : -exposure_.time_s * random_[sample].uniform(frame_, kOfAllPixels, kTimeDraw);
}

void PathImage::take(std::uint32_t sample, RayCaster& caster, std::span<const PixelRows> rows) {
  const SensorRandom& random = random_[sample];
  glm::dvec2 lens_m(0);
  if (exposure_.aperture_m > 0) {
    const double radius = exposure_.aperture_m * std::sqrt(random.uniform(frame_, kOfAllPixels, kLensRadiusDraw));
    const double angle = 2 * std::numbers::pi * random.uniform(frame_, kOfAllPixels, kLensAngleDraw);
    lens_m = {radius * std::cos(angle), radius * std::sin(angle)};
  }
  for (const PixelRows& each : rows) take_rows(caster, each, random, lens_m);
  add(sample);
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

void PathImage::take_rows(RayCaster& caster, const PixelRows& rows, const SensorRandom& random,
                          const glm::dvec2& lens_m) {
  const bool elsewhere = is_own_ || !rows.places.empty();
  const DrawList& list = elsewhere ? world_.place(rows.places) : *list_;
  tracer_.set({.list = &list,
               .materials = &list_->materials,
               .caster = elsewhere ? &world_.caster() : &caster,
               .world_from_view = glm::translate(rows.world_from_view, glm::dvec3(lens_m, 0))});
  const std::uint32_t width_px = optics_.layout().width_px;
  const auto trace = [&] {
    caster.parallel_for(starts_.size(), RayCaster::kPacketSize, [&](std::size_t, std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) starts_[i] = start(starts_[i].pixel, random, lens_m);
    });
    std::erase_if(starts_, [](const PathStart& each) { return each.direction == glm::dvec3(0); });
    radiance_.resize(starts_.size());
    tracer_.trace(starts_, random, frame_, radiance_);
    for (std::size_t i = 0; i < starts_.size(); ++i) of_sample_[starts_[i].pixel] = radiance_[i];
    starts_.clear();
  };
  for_tiled_pixels(rows.first, rows.count, width_px, [&](std::uint32_t pixel) {
    starts_.push_back({.pixel = pixel});
    if (starts_.size() == kPathsAtOnce) trace();
  });
  trace();
}

// Welford, "Note on a Method for Calculating Corrected Sums of Squares and Products" (1962).
void PathImage::add(std::uint32_t sample) {
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const glm::dvec3 before = of_sample_[i] - mean_[i];
    mean_[i] += before / (sample + 1.0);
    deviations_[i] += before * (of_sample_[i] - mean_[i]);
  }
}

void PathImage::finish(Image& color) {
  const std::uint32_t width_px = optics_.layout().width_px, height_px = optics_.layout().height_px;
  color.width = stddev_.width = width_px;
  color.height = stddev_.height = height_px;
  color.channels = 4;
  stddev_.channels = 3;
  std::vector<float>&colors = color.pixels.overwrite(), &deviations = stddev_.pixels.overwrite();
  colors.resize(4 * mean_.size());
  deviations.resize(sampling_.stddev ? 3 * mean_.size() : 0);
  const double per_square = 1 / (static_cast<double>(samples()) * (samples() - 1.0));
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto channel = static_cast<glm::length_t>(c);
      colors[4 * i + c] = static_cast<float>(mean_[i][channel]);
      if (sampling_.stddev) {
        deviations[3 * i + c] = static_cast<float>(std::sqrt(std::max(0.0, deviations_[i][channel]) * per_square));
      }
    }
    colors[4 * i + 3] = 1;
  }
}

}  // namespace simvis
