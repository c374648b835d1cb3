// Gaussian splats: many small Gaussians in space that show a captured scene (Kerbl et al. 2023). Plain data in host
// memory, as meshes are.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace simvis {

/// A Gaussian in space: exp(-m^2 / 2), where m is the distance from the centre in standard deviations.
///
/// Frames   the mesh's.
struct Splat {
  glm::vec3 center{0};
  glm::vec3 sigma{1};              ///< standard deviations along its axes; above 0 at least along one, and finite
  glm::vec4 rotation{0, 0, 0, 1};  ///< mesh_from_splat, a unit quaternion x, y, z, w
  float opacity = 1;               ///< [0, 1], the share of the light that its centre stops

  bool operator==(const Splat&) const = default;
};

/// The encoding of the colours of splats. Mixtures of them have the same encoding.
enum class SplatEncoding : std::uint8_t {
  srgb,   ///< as in pictures, IEC 61966-2-1: what splats are usually trained with
  linear  ///< linear light
};

/// The highest degree of spherical harmonics.
inline constexpr std::uint32_t kMaxHarmonicsDegree = 3;
/// The number of coefficients of the degrees from 0 to `degree`, of each channel.
constexpr std::uint32_t harmonics_count(std::uint32_t degree) { return (degree + 1) * (degree + 1); }

/// The largest size of a coefficient. Those of captured scenes are below 10; up to this one, colours are finite in
/// linear light too.
inline constexpr float kMaxHarmonic = 1e6f;

/// The largest number of splats of a file.
inline constexpr std::size_t kMaxSplats = 4'000'000;

/// The splats of one mesh. Immutable once shared.
struct SplatCloud {
  SplatEncoding encoding = SplatEncoding::srgb;
  std::uint32_t degree = 0;  ///< of the harmonics, at most kMaxHarmonicsDegree
  std::vector<Splat> splats;
  /// Red, green and blue coefficients, harmonics_count(degree) of each splat, in the order of splat_color().
  std::vector<glm::vec3> harmonics;

  bool operator==(const SplatCloud&) const = default;
};

/// Whether the coefficients of the three channels are finite and at most kMaxHarmonic in size.
inline bool is_harmonic(const glm::vec3& coefficients) {
  return glm::all(glm::lessThanEqual(glm::abs(coefficients), glm::vec3(kMaxHarmonic)));
}

/// The red, green and blue of a splat that is seen along a direction: 0.5 plus the sum of its real spherical harmonics
/// with the Condon-Shortley phase, by degree and in each from order -degree to degree, as in KHR_gaussian_splatting and
/// in the files of Kerbl et al.; not below 0. `direction` is a unit vector from the camera to the splat in the frame of
/// the mesh. `coefficients` are those of the splat.
glm::dvec3 splat_color(std::span<const glm::vec3> coefficients, const glm::dvec3& direction);

}  // namespace simvis
