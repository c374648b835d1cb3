#include "scenegraph/language/pose_attribute.h"

#include <cmath>

#include <simvis/attributes.h>
#include <simvis/pose.h>

namespace simvis {

std::optional<glm::dmat4> pose_offset(const Command& command) {
  const CommandAttribute* attribute = command.find(kPoseOffset);
  if (attribute == nullptr) return std::nullopt;
  double v[6];
  if (!parse_numbers(attribute->value, v)) {
    fail_at(attribute->where, "attribute \"pose_offset\": " + in_quotes(attribute->value) +
                                  " is not allowed, expected six finite numbers: x y z (m) roll pitch yaw (deg)");
  }
  for (int i = 0; i < 3; ++i) {
    if (std::abs(v[i]) > kMaxCoordinate_m) {
      fail_at(attribute->where, "attribute \"pose_offset\": " + format_number(v[i]) +
                                    " is not allowed, expected x y z from " + format_number(-kMaxCoordinate_m) +
                                    " to " + format_number(kMaxCoordinate_m) + " (m)");
    }
  }
  return matrix_from_degrees({v[0], v[1], v[2]}, v[3], v[4], v[5]);
}

}  // namespace simvis
