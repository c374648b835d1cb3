// Between glm and Bullet.
#pragma once

#include <LinearMath/btTransform.h>

#include <glm/glm.hpp>

#include "elements/dynamics/world/world.h"

namespace simvis {

inline btVector3 to_bullet(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
inline glm::dvec3 to_glm(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline btMatrix3x3 to_bullet(const glm::dmat3& m) {
  return {m[0][0], m[1][0], m[2][0], m[0][1], m[1][1], m[2][1], m[0][2], m[1][2], m[2][2]};
}
inline btTransform to_bullet(const glm::dmat4& rigid) {
  return btTransform(to_bullet(glm::dmat3(rigid)), to_bullet(glm::dvec3(rigid[3])));
}
inline glm::dmat4 to_glm(const btTransform& transform) {
  glm::dmat4 m(1.0);
  for (int column = 0; column < 3; ++column) m[column] = glm::dvec4(to_glm(transform.getBasis().getColumn(column)), 0);
  m[3] = glm::dvec4(to_glm(transform.getOrigin()), 1);
  return m;
}

}  // namespace simvis
