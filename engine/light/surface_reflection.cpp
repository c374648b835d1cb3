#include "engine/light/surface_reflection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/draw/luminance.h"

namespace simvis {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDielectric = 0.04;  // reflectance at normal incidence for the refractive index 1.5
constexpr double kMinChance = 0.1;    // of the layer that is expected to reflect less

double squared(double x) { return x * x; }

double alpha_squared(const SurfaceReflection& surface) { return squared(squared(surface.roughness)); }

glm::dvec3 normal_reflectance(const SurfaceReflection& surface) {
  return glm::mix(glm::dvec3(kDielectric), surface.base, surface.metallic);
}

double schlick_power(double cosine) {
  const double tilted = 1 - std::clamp(cosine, 0.0, 1.0);
  return squared(squared(tilted)) * tilted;
}

// The density of microfacet normals, by their projected area.
double facet_density(double alpha2, double cosine) {
  return alpha2 / (kPi * squared(squared(cosine) * (alpha2 - 1) + 1));
}

double masking_root(double alpha2, double cosine) { return std::sqrt(alpha2 + (1 - alpha2) * squared(cosine)); }

// The share of directions that sample the boundary.
double boundary_chance(const SurfaceReflection& surface, double eye_cosine) {
  if (surface.matte) return 0;
  const glm::dvec3 normal = normal_reflectance(surface);
  const double boundary = luminance(normal + (1.0 - normal) * schlick_power(eye_cosine));
  const double below = luminance(surface.base) * (1 - surface.metallic);
  if (below == 0) return 1;
  return std::clamp(boundary / (boundary + below), kMinChance, 1 - kMinChance);
}

// The normal of a visible microfacet in the frame of the surface.
glm::dvec3 visible_facet(const glm::dvec3& eye, double alpha, double u, double v) {
  const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * eye.x, alpha * eye.y, eye.z));
  const double flat = squared(stretched.x) + squared(stretched.y);
  const glm::dvec3 across = flat > 0 ? glm::dvec3(-stretched.y, stretched.x, 0) / std::sqrt(flat) : glm::dvec3(1, 0, 0);
  const double radius = std::sqrt(u), angle = 2 * kPi * v, x = radius * std::cos(angle);
  const double upper = (1 + stretched.z) / 2, half_disc = std::sqrt(std::max(0.0, 1 - squared(x)));
  const double y = (1 - upper) * half_disc + upper * radius * std::sin(angle);
  const glm::dvec3 normal = x * across + y * glm::cross(stretched, across) +
                            std::sqrt(std::max(0.0, 1 - squared(x) - squared(y))) * stretched;
  return glm::normalize(glm::dvec3(alpha * normal.x, alpha * normal.y, std::max(0.0, normal.z)));
}

}  // namespace

glm::dmat3 frame_of_axis(const glm::dvec3& axis) {
  const glm::dvec3 aside = std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(axis, aside));
  return {x, glm::cross(axis, x), axis};
}

glm::dvec3 reflected_share(const SurfaceReflection& surface, const glm::dvec3& to_eye, const glm::dvec3& to_light) {
  const double eye = glm::dot(surface.normal, to_eye), light = glm::dot(surface.normal, to_light);
  if (!(eye > 0 && light > 0)) return glm::dvec3(0);
  if (surface.matte) return surface.base * (light / kPi);
  const glm::dvec3 facet = glm::normalize(to_eye + to_light), normal = normal_reflectance(surface);
  const glm::dvec3 fresnel = normal + (1.0 - normal) * schlick_power(glm::dot(facet, to_eye));
  const double alpha2 = alpha_squared(surface);
  const double masking = light * masking_root(alpha2, eye) + eye * masking_root(alpha2, light);
  const double boundary = facet_density(alpha2, glm::dot(surface.normal, facet)) * light / (2 * masking);
  return fresnel * boundary + (1.0 - fresnel) * surface.base * ((1 - surface.metallic) * light / kPi);
}

glm::dvec3 sample_direction(const SurfaceReflection& surface, const glm::dvec3& to_eye, const glm::dvec3& random) {
  const glm::dmat3 frame = frame_of_axis(surface.normal);
  const glm::dvec3 eye = to_eye * frame;
  if (random.z < boundary_chance(surface, eye.z)) {
    const glm::dvec3 facet = visible_facet(eye, squared(surface.roughness), random.x, random.y);
    return glm::normalize(frame * (2 * glm::dot(eye, facet) * facet - eye));
  }
  const double radius = std::sqrt(random.x), angle = 2 * kPi * random.y;
  return glm::normalize(frame *
                        glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - random.x)));
}

double direction_density(const SurfaceReflection& surface, const glm::dvec3& to_eye, const glm::dvec3& to_light) {
  const double eye = glm::dot(surface.normal, to_eye), light = glm::dot(surface.normal, to_light);
  const double chance = boundary_chance(surface, eye), below = (1 - chance) * std::max(light, 0.0) / kPi;
  if (chance == 0 || !(eye > 0)) return below;
  // The density of visible facets is D G1 (eye . facet) / eye; reflection divides it by 4 (eye . facet).
  const double alpha2 = alpha_squared(surface), cosine = glm::dot(surface.normal, glm::normalize(to_eye + to_light));
  return below + chance * facet_density(alpha2, cosine) / (2 * (eye + masking_root(alpha2, eye)));
}

}  // namespace simvis
