#include "engine/geometry/box_padding.h"

#include <algorithm>
#include <cmath>

namespace simvis {

// An item whose transform is not finite has no place: its box covers everything, and no ray hits the item itself.
Box padded_box(const glm::dvec3& low, const glm::dvec3& high, double padding) {
  const auto cut = [](double place, double otherwise) {
    return std::isnan(place) ? otherwise : std::clamp(place, -kFarthest, kFarthest);
  };
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = static_cast<float>(cut(low[axis] - padding, -kFarthest));
    box.high[axis] = static_cast<float>(cut(high[axis] + padding, kFarthest));
  }
  return box;
}

}  // namespace simvis
