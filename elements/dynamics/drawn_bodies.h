// The bodies of an element of physics as people see them.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "dynamics/world.h"
#include "elements/sensed_physics.h"

namespace simvis {

/// What an element puts into the world. It is valid as long as the element.
struct DynamicParts {
  BodyKind kind = BodyKind::dynamic;
  const MassProperties* mass = nullptr;    ///< of the body, or of the base
  std::span<const CollisionShape> shapes;  ///< of the body, or of the base
  std::span<const LinkDesc> links{};
};

/// Adds the body of an element, or its base, and then its links in their order. `point_of(link)` is an insertion point
/// that moves with a link; -1: with the body or the base.
void append_drawn_bodies(const std::string& element, const DynamicParts& parts,
                         const std::function<std::string(int)>& point_of, std::vector<DrawnBody>& bodies);

}  // namespace simvis
