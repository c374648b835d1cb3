// How a surface reflects light: glTF's metallic-roughness model as the pictures of cameras show it
// (shaders/lights.glsl), in double, and directions that are distributed nearly as the light that it reflects.
//
// Model    A Lambertian layer of (1 - metallic) x base / pi below a boundary of Trowbridge-Reitz (GGX) microfacets with
//          alpha = roughness^2, Smith's height-correlated visibility and Schlick's Fresnel term, whose reflectance at
//          normal incidence is 0.04, mixed with the base colour by the metallic share. A matte surface has no boundary.
// Sampling The Lambertian layer by the cosine of the direction, the boundary by the microfacets that the eye sees:
//          Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7 (2018). One of both is chosen by what it
//          is expected to reflect, and the density is that of the mixture.
//
// All directions are unit vectors in one frame, which lead away from the surface.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

/// The reflection of a surface at a point.
struct SurfaceReflection {
  glm::dvec3 normal{0};  ///< unit length, towards the eye
  glm::dvec3 base{1};    ///< linear RGB
  double roughness = 1;  ///< [kMinRoughness, 1] unless matte
  double metallic = 0;   ///< [0, 1]
  bool matte = true;     ///< Lambertian
};

/// The radiance towards the eye for radiance 1 from a direction, per steradian: the BRDF times the cosine of it.
glm::dvec3 reflected_share(const SurfaceReflection& surface, const glm::dvec3& to_eye, const glm::dvec3& to_light);

/// A direction from which reflected light may come, for three numbers in [0, 1). It can lie below the surface, from
/// where reflected_share() is 0.
glm::dvec3 sample_direction(const SurfaceReflection& surface, const glm::dvec3& to_eye, const glm::dvec3& random);

/// The density of sample_direction() per steradian at a direction above the surface.
double direction_density(const SurfaceReflection& surface, const glm::dvec3& to_eye, const glm::dvec3& to_light);

/// A frame whose z axis is a unit vector.
glm::dmat3 frame_of_axis(const glm::dvec3& axis);

}  // namespace simvis
