// What sensors of forces do where physics moves nothing.
#pragma once

#include <simvis/attributes.h>

namespace simvis {

/// Sensors that a file of a robot brings have "nothing", because the same file is shown without physics too.
inline constexpr AttributeSpec kWithoutPhysicsRow{
    .name = "without_physics",
    .kind = AttributeKind::choice,
    .default_value = "error",
    .text = "error: physics that moves what is measured has to be there; nothing: without it there are no forces",
    .choices = "error nothing"};

inline bool needs_physics(const AttributeValues& attributes) {
  return attributes.choice(kWithoutPhysicsRow.name) == "error";
}

}  // namespace simvis
