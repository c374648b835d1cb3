#include "engine/light/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "engine/draw/luminance.h"

namespace simvis {
namespace {

constexpr double kUnit = 0x1p-53;
// Rays per piece of a loop of the pool.
constexpr std::size_t kPiece = 256;
// A hit at this share of the distance of a light is the surface that emits, or one in which the lamp lies: rounding
// moves points of one plane by some 2^-53 of the coordinates.
constexpr double kThere = 1 - 1e-9;

// Where a ray begins that leaves the point at which another one has hit a surface: effects/scanner/onward_ray.h.
double leaving_m(const glm::dvec3& point_m, const RayHit& hit, double cosine) {
  return std::max(2 * (5 * hit.error_bound_m + 8 * kUnit * glm::length(point_m)) / cosine, 1e-30);
}

bool blocks_all(const Material& material) {
  return material.alpha_mode != AlphaMode::blend && material.opacity == 1 && material.transmission == 0;
}

}  // namespace

void PathTracer::set(const PathScene& scene) {
  scene_ = scene;
  sources_.set(*scene.list, *scene.materials, scene.world_from_view);
}

double PathTracer::transmittance(double distance_m) const {
  const double extinction_per_m = scene_.list->medium.extinction_per_m;
  return extinction_per_m > 0 ? std::exp(-extinction_per_m * distance_m) : 1;
}

void PathTracer::trace(std::span<const PathStart> starts, const SensorRandom& random, std::uint64_t frame,
                       std::span<glm::dvec3> radiance) {
  std::ranges::fill(radiance, glm::dvec3(0));
  paths_.clear();
  for (std::uint32_t i = 0; i < starts.size(); ++i) {
    paths_.push_back({.start = i,
                      .pixel = starts[i].pixel,
                      .draws = starts[i].draws,
                      .direction = starts[i].direction,
                      .behind_m = starts[i].near_m});
  }
  const Numbers numbers{random, frame};
  while (!paths_.empty()) {
    cast_paths();
    lights_.assign(paths_.size(), {});
    added_.assign(paths_.size(), glm::dvec3(0));
    goes_on_.assign(paths_.size(), 0);
    scene_.caster->parallel_for(paths_.size(), kPiece, [&](std::size_t, std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) {
        goes_on_[i] = follow(paths_[i], hits_[i], numbers, lights_[i], added_[i]) ? 1 : 0;
      }
    });
    light_rays_.clear();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      radiance[paths_[i].start] += added_[i];
      for (const LightRay& ray : lights_[i]) {
        if (ray.light != glm::dvec3(0)) light_rays_.push_back(ray);
      }
      if (goes_on_[i] != 0) paths_[kept++] = paths_[i];
    }
    paths_.resize(kept);
    cast_lights(radiance);
  }
}

// Rays of the camera come first: a path that has left it never comes back to it.
void PathTracer::cast_paths() {
  const std::size_t count = paths_.size();
  hits_.resize(count);
  origins_m_.resize(count);
  directions_.resize(count);
  behind_m_.resize(count);
  std::stable_sort(paths_.begin(), paths_.end(),
                   [](const Path& a, const Path& b) { return a.from_camera && !b.from_camera; });
  std::size_t of_camera = 0;
  for (std::size_t i = 0; i < count; ++i) {
    origins_m_[i] = paths_[i].origin_m;
    directions_[i] = paths_[i].direction;
    behind_m_[i] = paths_[i].behind_m;
    if (paths_[i].from_camera) ++of_camera;
  }
  const std::span<const glm::dvec3> directions(directions_);
  const std::span<const double> behind_m(behind_m_);
  const std::span<RayHit> hits(hits_);
  if (of_camera > 0) {
    scene_.caster->cast(scene_.world_from_view, directions.first(of_camera), hits.first(of_camera),
                        behind_m.first(of_camera), {}, HitSides::front);
  }
  if (of_camera < count) {
    scene_.caster->cast_from(scene_.world_from_view, std::span<const glm::dvec3>(origins_m_).subspan(of_camera),
                             directions.subspan(of_camera), hits.subspan(of_camera), behind_m.subspan(of_camera));
  }
}

glm::dvec3 PathTracer::escaped(const Path& path) const {
  if (path.seen) return sources_.seen(path.direction);
  const glm::dvec3 light = sources_.arriving(path.direction);
  if (path.density == 0) return light;
  return light * (path.density / (path.density + sources_.sky_density(path.direction)));
}

double PathTracer::emission_weight(const Path& path, const RayHit& hit, const LitSurface& surface) const {
  if (path.density == 0) return 1;
  const double cosine = std::abs(glm::dot(surface.face, path.direction));
  return path.density / (path.density + sources_.emitter_density(hit.item, hit.range_m, cosine));
}

bool PathTracer::follow(Path& path, const RayHit& hit, const Numbers& numbers, LightRays& lights,
                        glm::dvec3& added) const {
  if (std::isinf(hit.range_m)) {
    added = path.share * escaped(path);
    return false;
  }
  const double clear = transmittance(hit.range_m - path.in_air_m);
  if (clear < 1) added += path.share * ((1 - clear) * glm::dvec3(scene_.list->medium.airlight));
  path.share *= clear;
  path.in_air_m = hit.range_m;
  const LitSurface surface =
      lit_surface(*scene_.list, material_of(hit.item), scene_.world_from_view, path.origin_m, path.direction, hit);
  if (surface.emission != glm::dvec3(0)) {
    added += path.share * surface.emission * (surface.covered * emission_weight(path, hit, surface));
  }
  return meet(path, hit, surface, numbers, lights);
}

// Chooses between the gaps of the surface, its mirror, its pane and its matte share.
bool PathTracer::meet(Path& path, const RayHit& hit, const LitSurface& surface, const Numbers& numbers,
                      LightRays& lights) const {
  const double gap = 1 - surface.covered, mirror = surface.covered * surface.reflected;
  const double pane = surface.covered * luminance(surface.passed), matte = surface.covered * surface.matte;
  const double sum = gap + mirror + pane + matte;
  if (!(sum > 0)) return false;
  path.share *= sum;
  double rest = matte == sum ? sum : numbers.one(path) * sum;
  const auto is = [&rest](double share) {
    const bool chosen = rest < share;
    rest -= share;
    return chosen;
  };
  const bool through_gap = is(gap), through_pane = !through_gap && is(pane);
  if (through_gap || through_pane) {
    if (through_pane) path.share *= surface.passed / luminance(surface.passed);
    path.behind_m = hit.range_m + 2 * hit.error_bound_m;
    return true;
  }
  if (path.bounces == bounces_) return false;
  if (!is(mirror)) return reflect(path, hit, surface, numbers, lights);
  const double cosine = -glm::dot(surface.face, path.direction);
  path.origin_m += hit.range_m * path.direction;
  path.direction = glm::normalize(path.direction + 2 * cosine * surface.face);
  path.density = 0;
  path.behind_m = leaving_m(path.origin_m, hit, cosine);
  path.in_air_m = 0;
  path.from_camera = false;
  ++path.bounces;
  return true;
}

bool PathTracer::reflect(Path& path, const RayHit& hit, const LitSurface& surface, const Numbers& numbers,
                         LightRays& lights) const {
  const glm::dvec3 point_m = path.origin_m + hit.range_m * path.direction, to_eye = -path.direction;
  const auto light_from = [&](std::size_t kind, const LightSample& sample) {
    const double cosine = glm::dot(surface.face, sample.toward);
    if (!(cosine > 0)) return;
    const double density = sample.density > 0 ? direction_density(surface.reflection, to_eye, sample.toward) : 0;
    const double weight = sample.density > 0 ? sample.density / (sample.density + density) : 1;
    const glm::dvec3 share = reflected_share(surface.reflection, to_eye, sample.toward) * weight;
    const double clear = std::isinf(sample.distance_m) ? 1 : transmittance(sample.distance_m);
    lights[kind] = {.start = path.start,
                    .origin_m = point_m,
                    .light = path.share * share * sample.light * clear,
                    .behind_m = leaving_m(point_m, hit, cosine),
                    .sample = sample};
  };
  if (sources_.any_lamps()) light_from(0, sources_.sample_lamps(point_m, numbers.three(path)));
  if (sources_.any_emitters()) light_from(1, sources_.sample_emitters(point_m, numbers.three(path)));
  if (sources_.any_sky()) light_from(2, sources_.sample_sky(numbers.three(path)));
  const glm::dvec3 direction = sample_direction(surface.reflection, to_eye, numbers.three(path));
  const double cosine = glm::dot(surface.face, direction);
  const glm::dvec3 share = reflected_share(surface.reflection, to_eye, direction);
  if (!(cosine > 0) || share == glm::dvec3(0)) return false;
  path.density = direction_density(surface.reflection, to_eye, direction);
  path.share *= share / path.density;
  path.origin_m = point_m;
  path.direction = direction;
  path.behind_m = leaving_m(point_m, hit, cosine);
  path.in_air_m = 0;
  path.from_camera = path.seen = false;
  ++path.bounces;
  return true;
}

// Returns whether anything may block the ray behind this hit. If the hit blocks all of its light, it has none then.
bool PathTracer::passes(LightRay& ray, const RayHit& hit) const {
  const LightSample& to = ray.sample;
  if (std::isinf(hit.range_m) || (hit.item == to.item && hit.primitive == to.primitive)) return false;
  if (hit.range_m >= kThere * to.distance_m) return false;
  const Material& material = material_of(hit.item);
  glm::dvec3 passed(0);
  if (!blocks_all(material)) {
    const LitSurface surface =
        lit_surface(*scene_.list, material, scene_.world_from_view, ray.origin_m, to.toward, hit);
    passed = 1 - surface.covered + surface.covered * surface.passed;
  }
  ray.light *= passed;
  ray.behind_m = hit.range_m + 2 * hit.error_bound_m;
  return passed != glm::dvec3(0);
}

void PathTracer::cast_lights(std::span<glm::dvec3> radiance) {
  while (!light_rays_.empty()) {
    const std::size_t count = light_rays_.size();
    hits_.resize(count);
    origins_m_.resize(count);
    directions_.resize(count);
    behind_m_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      origins_m_[i] = light_rays_[i].origin_m;
      directions_[i] = light_rays_[i].sample.toward;
      behind_m_[i] = light_rays_[i].behind_m;
    }
    scene_.caster->cast_from(scene_.world_from_view, origins_m_, directions_, hits_, behind_m_);
    goes_on_.assign(count, 0);
    scene_.caster->parallel_for(count, kPiece, [&](std::size_t, std::size_t first, std::size_t in_piece) {
      for (std::size_t i = first; i < first + in_piece; ++i) goes_on_[i] = passes(light_rays_[i], hits_[i]) ? 1 : 0;
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (goes_on_[i] != 0) {
        light_rays_[kept++] = light_rays_[i];
      } else {
        radiance[light_rays_[i].start] += light_rays_[i].light;
      }
    }
    light_rays_.resize(kept);
  }
}

}  // namespace simvis
