#include "program/live/glb_matrix.h"

#include <algorithm>
#include <cmath>

namespace simvis::live {
namespace {

// Cosine of the angle between two columns. Khronos' validator allows 10^-5 or so; rounding makes 10^-16.
constexpr double kSquare = 1e-9;

bool is_square(const glm::dmat3& m) {
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 a = m[i], b = m[(i + 1) % 3];
    if (std::abs(glm::dot(a, b)) > kSquare * glm::length(a) * glm::length(b)) return false;
  }
  return true;
}

// One-sided Jacobi: turns the columns of `m` in pairs until they are square to each other, and returns the product of
// the turns. Three columns need a few rounds.
glm::dmat3 make_square(glm::dmat3& m) {
  constexpr int kMaxRounds = 60;
  glm::dmat3 turns(1);
  for (int round = 0; round < kMaxRounds && !is_square(m); ++round) {
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      const double mixed = glm::dot(m[p], m[q]);
      if (mixed == 0) continue;
      const double zeta = (glm::dot(m[q], m[q]) - glm::dot(m[p], m[p])) / (2 * mixed);
      const double t = (zeta < 0 ? -1 : 1) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
      const double c = 1 / std::sqrt(1 + t * t), s = c * t;
      for (glm::dmat3* const each : {&m, &turns}) {
        const glm::dvec3 a = (*each)[p], b = (*each)[q];
        (*each)[p] = c * a - s * b;
        (*each)[q] = s * a + c * b;
      }
    }
  }
  return turns;
}

}  // namespace

std::vector<glm::dmat4> gltf_nodes_of(const glm::dmat4& matrix) {
  glm::dmat3 linear(matrix);
  if (!(std::abs(glm::determinant(linear)) > 0)) return {};
  if (is_square(linear)) return {matrix};
  const glm::dmat3 turns = make_square(linear);  // linear of `matrix` times `turns` is now square
  glm::dmat4 outer(linear);
  outer[3] = matrix[3];
  return {outer, glm::dmat4(glm::transpose(turns))};
}

glm::dmat4 turn_of_light(const glm::dvec3& direction) {
  const glm::dvec3 back = -direction;
  const glm::dvec3 aside = std::abs(back.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(aside, back));
  return glm::dmat4(glm::dmat3(x, glm::cross(back, x), back));
}

}  // namespace simvis::live
