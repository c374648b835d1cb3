#include "program/datasets/rigid_text.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include <simvis/attributes.h>

namespace simvis {
namespace {

// In metres, and as a difference of the entries of rotations.
constexpr double kSamePlace = 1e-6;

}  // namespace

bool is_same_place(const glm::dmat4& a, const glm::dmat4& b) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(std::abs(a[column][row] - b[column][row]) <= kSamePlace)) return false;
    }
  }
  return true;
}

std::string twelve_numbers(const glm::dmat4& a_from_b) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += (text.empty() ? "" : " ") + format_number(a_from_b[column][row]);
    }
  }
  return text;
}

Record rigid_record(const glm::dmat4& a_from_b) {
  Record twelve = Record::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) twelve.push_back(a_from_b[column][row]);
  }
  return twelve;
}

glm::dmat4 rigid_of(const Record& twelve) {
  glm::dmat4 matrix(1);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      matrix[column][row] = twelve.at(static_cast<std::size_t>(4 * row + column)).get<double>();
    }
  }
  return matrix;
}

glm::dvec4 quaternion_xyzw(const glm::dmat4& a_from_b) {
  const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(a_from_b)));
  return (q.w < 0 ? -1.0 : 1.0) * glm::dvec4(q.x, q.y, q.z, q.w);
}

}  // namespace simvis
