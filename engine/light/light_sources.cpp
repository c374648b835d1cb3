#include "engine/light/light_sources.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/draw/luminance.h"
#include "engine/light/direct_light.h"
#include "engine/light/lit_surface.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {
namespace {

// That of the pixel in which the direction lies, as in shaders/sky.frag. Frame of the picture.
glm::dvec3 sky_radiance(const SkyPicture& picture, const glm::dvec3& direction) {
  const double azimuth = std::atan2(direction.y, direction.x),
               elevation = std::atan2(direction.z, std::hypot(direction.x, direction.y));
  const auto pixel = [](double share, std::uint32_t count) {
    return static_cast<std::size_t>(std::clamp(std::floor(share * count), 0.0, count - 1.0));
  };
  const std::size_t column = pixel(0.5 - azimuth / (2 * std::numbers::pi), picture.width);
  const std::size_t row = pixel(0.5 - elevation / std::numbers::pi, picture.height);
  return glm::dvec3(picture.radiance[row * picture.width + column]);
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
  const glm::dmat4 view_from_sky = view_from(list.sky.transform);
  sky_from_view_ = glm::transpose(turn_of(view_from_sky));
  add_lamps();
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

void LightSources::add_lamps() {
  lamps_.clear();
  for (const LightItem& item : list_->lights) {
    const double power = item.light.intensity * luminance(glm::dvec3(item.light.color));
    if (power > 0) lamps_.push_back({item.light, view_from(item.transform), power});
  }
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
  const glm::dvec3 way = glm::dvec3(lamp.view_from_light[3]) - point_m;
  return lamp.power / std::max(glm::dot(way, way), 1e-12);
}

LightSample LightSources::sample_lamps(const glm::dvec3& point_m, double random) const {
  double sum = 0;
  for (const Lamp& lamp : lamps_) sum += expected(lamp, point_m);
  double rest = random * sum;
  std::size_t chosen = 0;
  for (; chosen + 1 < lamps_.size(); ++chosen) {
    const double own = expected(lamps_[chosen], point_m);
    if (rest < own) break;
    rest -= own;
  }
  const Lamp& lamp = lamps_[chosen];
  const DirectLight direct = direct_light(lamp.light, lamp.view_from_light, point_m);
  return {.toward = direct.toward,
          .distance_m = direct.distance_m,
          .light = direct.irradiance * (sum / expected(lamp, point_m))};
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
  const glm::dvec3 radiance = emitted_radiance(material_of(emitter.item), mesh, emitter.primitive, weights);
  return {.toward = toward,
          .distance_m = distance_m,
          .light = radiance / density,
          .density = density,
          .item = emitter.item,
          .primitive = emitter.primitive};
}

// A triangle is chosen by luminance x area, and its points are equally likely.
double LightSources::emitter_density(std::uint32_t item, double distance_m, double cosine) const {
  if (powers_[item] == 0) return 0;
  return powers_[item] / sums_.back() * distance_m * distance_m / cosine;
}

glm::dvec3 LightSources::arriving() const { return glm::dvec3(list_->environment.ambient); }

glm::dvec3 LightSources::seen(const glm::dvec3& direction) const {
  if (list_->medium.extinction_per_m > 0) return glm::dvec3(list_->medium.airlight);
  if (!list_->sky.picture) return glm::dvec3(list_->environment.background);
  return static_cast<double>(list_->sky.factor) * sky_radiance(*list_->sky.picture, sky_from_view_ * direction);
}

}  // namespace simvis
