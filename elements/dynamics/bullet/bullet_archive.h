// Values of Bullet in the state of a world.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <LinearMath/btTransform.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <simvis/state_archive.h>

namespace simvis {

/// The index that means: no object.
inline constexpr std::uint32_t kNoNumber = std::numeric_limits<std::uint32_t>::max();

/// Returns the index of an object in a list that contains it.
template <typename List, typename Object>
std::uint32_t number_of(const List& all, const Object* object) {
  return static_cast<std::uint32_t>(std::ranges::find(all, object) - std::begin(all));
}

/// Returns true if `numbers` is a permutation of 0 to size - 1.
inline bool is_order(const std::vector<std::uint32_t>& numbers) {
  std::vector<bool> is_found(numbers.size());
  for (const std::uint32_t number : numbers) {
    if (number >= numbers.size() || is_found[number]) return false;
    is_found[number] = true;
  }
  return true;
}

/// As StateArchive::finite().
inline void archive_finite(StateArchive& state, double& number) { state.finite(number); }
inline void archive_finite(StateArchive& state, btVector3& vector) {
  for (int i = 0; i < 3; ++i) archive_finite(state, vector[i]);
}
inline void archive_finite(StateArchive& state, btQuaternion& turn) {
  for (int i = 0; i < 4; ++i) archive_finite(state, turn[i]);
}
inline void archive_finite(StateArchive& state, btMatrix3x3& matrix) {
  for (int i = 0; i < 3; ++i) archive_finite(state, matrix[i]);
}
inline void archive_finite(StateArchive& state, btTransform& transform) {
  archive_finite(state, transform.getBasis());
  archive_finite(state, transform.getOrigin());
}
inline void archive_finite(StateArchive& state, btDbvtVolume& box) {
  archive_finite(state, box.tMins());
  archive_finite(state, box.tMaxs());
}

}  // namespace simvis
