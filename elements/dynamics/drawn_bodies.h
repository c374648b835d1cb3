// The bodies, shapes and joints of physics elements in the form in which the page draws them.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "elements/dynamics/world/world.h"
#include "elements/sensed_physics.h"

namespace simvis {

/// A body, or a link. The pointer and the span are valid as long as the element that adds it.
struct LinkParts {
  const MassProperties* mass = nullptr;  ///< null: no force moves it
  std::span<const CollisionShape> shapes;
};

/// The body and the links that an element adds to the physics world. The pointer and the spans are valid as long as the
/// element.
struct DynamicParts {
  BodyKind kind = BodyKind::dynamic;
  const MassProperties* mass = nullptr;    ///< of the body, or of the base; not null if `kind` is dynamic
  std::span<const CollisionShape> shapes;  ///< of the body, or of the base
  std::span<const LinkDesc> links{};

  /// Returns a link, or for -1 the body or the base.
  LinkParts of_link(int link) const;
  /// The sum of the masses that forces move.
  double moved_mass_kg() const;
};

/// Appends to `bodies` the body or the base of an element, then its links in their order. `point_of(link)` returns an
/// insertion point that moves with a link, or for -1 with the body or the base.
void append_drawn_bodies(const std::string& element, const DynamicParts& parts,
                         const std::function<std::string(int)>& point_of, std::vector<DrawnBody>& bodies);

}  // namespace simvis
