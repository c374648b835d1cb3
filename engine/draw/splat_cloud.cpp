#include "engine/draw/splat_cloud.h"

#include <array>

namespace simvis {
namespace {

constexpr std::size_t kMaxCoefficients = harmonics_count(kMaxHarmonicsDegree);

// The values of all harmonics in a direction.
std::array<double, kMaxCoefficients> harmonics_along(const glm::dvec3& direction) {
  const double x = direction.x, y = direction.y, z = direction.z, xx = x * x, yy = y * y, zz = z * z;
  return {0.28209479177387814,
          -0.4886025119029199 * y,
          0.4886025119029199 * z,
          -0.4886025119029199 * x,
          1.092548430592079 * x * y,
          -1.092548430592079 * y * z,
          0.31539156525252005 * (2 * zz - xx - yy),
          -1.092548430592079 * x * z,
          0.5462742152960396 * (xx - yy),
          -0.5900435899266435 * y * (3 * xx - yy),
          2.890611442640554 * x * y * z,
          -0.4570457994644657 * y * (4 * zz - xx - yy),
          0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
          -0.4570457994644657 * x * (4 * zz - xx - yy),
          1.445305721320277 * z * (xx - yy),
          -0.5900435899266435 * x * (xx - 3 * yy)};
}

}  // namespace

glm::dvec3 splat_color(std::span<const glm::vec3> coefficients, const glm::dvec3& direction) {
  const std::array<double, kMaxCoefficients> values = harmonics_along(direction);
  glm::dvec3 color(0.5);
  for (std::size_t i = 0; i < coefficients.size(); ++i) color += values[i] * glm::dvec3(coefficients[i]);
  return glm::max(color, glm::dvec3(0));
}

}  // namespace simvis
