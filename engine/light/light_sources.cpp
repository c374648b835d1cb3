#include "engine/light/light_sources.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/draw/luminance.h"
#include "engine/light/direct_light.h"
#include "engine/light/lit_surface.h"
#include "engine/light/surface_reflection.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {
namespace {

constexpr double kSphere_sr = 4 * std::numbers::pi;

// A direction of the sphere for two numbers in [0, 1), evenly distributed.
glm::dvec3 direction_of_sphere(double u, double v) {
  const double z = 1 - 2 * u, across = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * std::numbers::pi * v;
  return {across * std::cos(angle), across * std::sin(angle), z};
}

// A point of a sphere around the origin, and the even density over the density of such points.
struct SpherePoint {
  glm::dvec3 at{0};
  double weight = 1;
};

// For numbers u and v in [0, 1). The density is in proportion to the inverse square d^-2 of the distance from `to`,
// because the light of evenly distributed points has no bound near the sphere. With the distance D of `to` from the
// middle and the radius R, ln d^2 is evenly distributed from ln (D - R)^2 to ln (D + R)^2.
SpherePoint point_of_sphere(double radius, const glm::dvec3& to, double u, double v) {
  // Ratio of D and R below which the squares differ by less than 0.5 %: even points are as good.
  constexpr double kEqual = 1e-3;
  // (D - R)^2 / (D + R)^2 above which rounding changes no distance by more than about 2^-53 / 2e-8 < 1e-8 of it.
  constexpr double kTouching = 1e-16;
  const double distance = glm::length(to);
  const double nearest = (distance - radius) * (distance - radius),
               farthest = (distance + radius) * (distance + radius);
  const bool uneven = distance > kEqual * radius && radius > kEqual * distance && nearest > kTouching * farthest;
  if (!uneven) return {radius * direction_of_sphere(u, v)};
  const double ratio = std::log(farthest / nearest), square = farthest * std::exp(-u * ratio);
  const double twice = 2 * distance * radius;
  const double versine = std::clamp((square - nearest) / twice, 0.0, 2.0);  // 1 - cosine, exact at the nearest point
  const double across = std::sqrt(versine * (2 - versine)), angle = 2 * std::numbers::pi * v;
  const glm::dvec3 direction(across * std::cos(angle), across * std::sin(angle), 1 - versine);
  return {radius * (frame_of_axis(to / distance) * direction), square * ratio / (2 * twice)};
}

// The frame of a picture may be turned, and mirrored by no part.
glm::dmat3 turn_of(const glm::dmat4& frame) {
  const glm::dmat3 linear(frame);
  return {glm::normalize(linear[0]), glm::normalize(linear[1]), glm::normalize(linear[2])};
}

}  // namespace

void LightSources::set(const DrawList& list, const std::vector<std::shared_ptr<const Material>>& materials,
                       const glm::dmat4& world_from_view) {
  list_ = &list;
  materials_ = &materials;
  world_from_view_ = world_from_view;
  ambient_ = glm::dvec3(list.environment.ambient);
  sky_share_ = glm::dvec3(0);
  if (!list.sky.picture) {
    sky_.reset();
  } else if (!sky_ || sky_->picture() != list.sky.picture) {
    sky_ = shared_sky_sampler(list.sky.picture);
  }
  sky_from_view_ = glm::transpose(turn_of(view_from(list.sky.transform)));
  lamps_.clear();
  for (const LightItem& item : list.lights) add_light(item);
  emitters_.clear();
  sums_.clear();
  powers_.assign(list.items.size(), 0);
  for (std::uint32_t item = 0; item < list.items.size(); ++item) add_emitters(item);
}

// The two positions, which may be far from the world's origin, are subtracted first.
glm::dmat4 LightSources::view_from(std::uint32_t transform) const {
  const MeshPlacement place = place_mesh(list_->world_from_node[transform], world_from_view_);
  glm::dmat4 view_from_node(place.linear);
  view_from_node[3] = glm::dvec4(place.offset, 1);
  return view_from_node;
}

// One of the lights of a lamp stands for it; the lights of the picture of the sky say together how much of it shines.
void LightSources::add_light(const LightItem& item) {
  const Light& light = item.light;
  const glm::dvec3 whole = light.intensity * glm::dvec3(light.color);
  if (light.lamp_shape == LampShape::sky_picture && sky_) {
    const glm::dvec3 mean(list_->sky.mean);
    for (glm::length_t c = 0; c < 3; ++c) sky_share_[c] += mean[c] > 0 ? whole[c] / (kSphere_sr * mean[c]) : 0;
    return;
  }
  if (light.lamp_shape == LampShape::even_sky) {
    ambient_ += whole / kSphere_sr;
    return;
  }
  const bool has_size = light.lamp_shape == LampShape::ball || light.lamp_shape == LampShape::disc;
  if (luminance(whole) == 0 || (has_size && light.lamp_point > 0)) return;
  Lamp lamp{.light = light,
            .view_from_light = view_from(item.transform),
            .light_from_view = glm::dmat4(1),
            .radius_m = 0,
            .middle_m = glm::dvec3(0),
            .power = luminance(whole)};
  if (has_size) {
    lamp.light.intensity *= light.lamp_points;
    lamp.power *= light.lamp_points;
  }
  if (light.lamp_shape == LampShape::ball) lamp.radius_m = light.lamp_radius * glm::length(lamp.view_from_light[0]);
  const glm::dvec3 middle = light.lamp_shape == LampShape::ball ? light.lamp_middle : glm::dvec3(0);
  lamp.light_from_view = glm::inverse(lamp.view_from_light);
  lamp.middle_m = glm::dvec3(lamp.view_from_light * glm::dvec4(middle, 1));
  lamps_.push_back(lamp);
}

void LightSources::add_emitters(std::uint32_t item) {
  const DrawItem& drawn = list_->items[item];
  const Mesh& mesh = *list_->meshes[drawn.mesh];
  const Material& material = material_of(item);
  const double power = luminance(glm::dvec3(material.emissive));
  if (!drawn.visible || power == 0 || material.unlit || mesh.topology != Topology::triangles || mesh.surface) return;
  powers_[item] = power;
  const glm::dmat4 view_from_mesh = view_from(drawn.transform);
  const double side = glm::determinant(glm::dmat3(view_from_mesh)) < 0 ? -1 : 1;
  const auto corner = [&](std::size_t index) {
    return glm::dvec3(view_from_mesh * glm::dvec4(glm::dvec3(mesh.positions[mesh.indices[index]]), 1));
  };
  for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
    const glm::dvec3 a = corner(first), ab = corner(first + 1) - a, ac = corner(first + 2) - a;
    const glm::dvec3 across = glm::cross(ab, ac);
    const double length = glm::length(across);
    if (length == 0) continue;
    emitters_.push_back({.item = item,
                         .primitive = static_cast<std::uint32_t>(first / 3),
                         .both_sides = material.double_sided,
                         .corner_m = a,
                         .first_m = ab,
                         .second_m = ac,
                         .outward = across * (side / length)});
    sums_.push_back((sums_.empty() ? 0 : sums_.back()) + power * length / 2);
  }
}

// What a point may get of a lamp. It is above 0 wherever the lamp shines.
double LightSources::expected(const Lamp& lamp, const glm::dvec3& point_m) const {
  if (lamp.light.kind == LightKind::directional) return lamp.power;
  const glm::dvec3 way = lamp.middle_m - point_m;
  return lamp.power / std::max({glm::dot(way, way), lamp.radius_m * lamp.radius_m, 1e-12});
}

LightSample LightSources::sample_lamps(const glm::dvec3& point_m, const glm::dvec3& random) const {
  double sum = 0;
  for (const Lamp& lamp : lamps_) sum += expected(lamp, point_m);
  double rest = random.z * sum;
  std::size_t chosen = 0;
  for (; chosen + 1 < lamps_.size(); ++chosen) {
    const double own = expected(lamps_[chosen], point_m);
    if (rest < own) break;
    rest -= own;
  }
  const Lamp& lamp = lamps_[chosen];
  Light light = lamp.light;
  glm::dmat4 view_from_light = lamp.view_from_light;
  double weight = 1;
  if (light.lamp_shape == LampShape::disc) {
    const double radius = std::tan(light.lamp_radius) * std::sqrt(random.x), angle = 2 * std::numbers::pi * random.y;
    light.direction = glm::normalize(frame_of_axis(light.lamp_middle) *
                                     glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), 1));
  } else if (light.lamp_shape == LampShape::ball) {
    const glm::dvec3 lit = glm::dvec3(lamp.light_from_view * glm::dvec4(point_m, 1)) - light.lamp_middle;
    const SpherePoint point = point_of_sphere(light.lamp_radius, lit, random.x, random.y);
    view_from_light[3] = view_from_light * glm::dvec4(light.lamp_middle + point.at, 1);
    weight = point.weight;
  }
  const DirectLight direct = direct_light(light, view_from_light, point_m);
  return {.toward = direct.toward,
          .distance_m = direct.distance_m,
          .light = direct.irradiance * (weight * sum / expected(lamp, point_m))};
}

LightSample LightSources::sample_emitters(const glm::dvec3& point_m, const glm::dvec3& random) const {
  const auto found = std::ranges::upper_bound(sums_, random.z * sums_.back());
  const Emitter& emitter = emitters_[std::min(static_cast<std::size_t>(found - sums_.begin()), emitters_.size() - 1)];
  const double root = std::sqrt(random.x);
  const glm::dvec3 weights(1 - root, root * (1 - random.y), root * random.y);
  const glm::dvec3 way = emitter.corner_m + weights.y * emitter.first_m + weights.z * emitter.second_m - point_m;
  const double distance_m = glm::length(way);
  if (distance_m == 0) return {};
  const glm::dvec3 toward = way / distance_m;
  const double cosine = -glm::dot(emitter.outward, toward);
  if (cosine == 0 || (cosine < 0 && !emitter.both_sides)) return {};
  const double density = emitter_density(emitter.item, distance_m, std::abs(cosine));
  const Mesh& mesh = *list_->meshes[list_->items[emitter.item].mesh];
  const Material& material = material_of(emitter.item);
  const glm::dvec3 radiance = emitted_radiance(material, mesh, emitter.primitive, weights) *
                              covered_share(material, mesh, emitter.primitive, weights);
  return {.toward = toward,
          .distance_m = distance_m,
          .light = radiance / density,
          .density = density,
          .item = emitter.item,
          .primitive = emitter.primitive};
}

LightSample LightSources::sample_sky(const glm::dvec3& random) const {
  const glm::dvec3 toward = glm::normalize(sky_->sample(random) * sky_from_view_);
  const double density = sky_density(toward);
  if (!(density > 0)) return {};
  return {.toward = toward, .light = arriving(toward) / density, .density = density};
}

// A triangle is chosen by luminance x area, and its points are equally likely.
double LightSources::emitter_density(std::uint32_t item, double distance_m, double cosine) const {
  if (powers_[item] == 0) return 0;
  return powers_[item] / sums_.back() * distance_m * distance_m / cosine;
}

double LightSources::sky_density(const glm::dvec3& direction) const {
  return any_sky() ? sky_->density(sky_from_view_ * direction) : 0;
}

glm::dvec3 LightSources::arriving(const glm::dvec3& direction) const {
  if (!sky_) return ambient_;
  return ambient_ + sky_share_ * sky_->radiance(sky_from_view_ * direction);
}

glm::dvec3 LightSources::seen(const glm::dvec3& direction) const {
  if (list_->medium.extinction_per_m > 0) return glm::dvec3(list_->medium.airlight);
  if (!sky_) return glm::dvec3(list_->environment.background);
  return static_cast<double>(list_->sky.factor) * sky_->radiance(sky_from_view_ * direction);
}

}  // namespace simvis
