// What the elements `body`, `robot` and `vehicle` put into the world of physics, and where it stands in the scene.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/location.h>
#include "elements/dynamics/drawn_bodies.h"
#include "elements/dynamics/world/world.h"

namespace simvis {

/// Something that an element puts into the world.
class DynamicObject {
 public:
  virtual ~DynamicObject() = default;
  /// Adds itself to the world as it stands at the start, and returns its id. `world_from_point` is the pose of its
  /// insertion point now, its own transform included; it is rigid.
  virtual std::size_t enter(DynamicsWorld& world, const glm::dmat4& world_from_point) = 0;
  /// Called before the steps of a frame, and then before each step `share` of the way through them, up to 1.
  virtual void begin_steps(DynamicsWorld& world, const glm::dmat4& world_from_point) = 0;
  virtual void before_step(DynamicsWorld& /*world*/, double /*share*/) {}
  /// The body and the links that enter() adds; valid as long as the object.
  virtual DynamicParts parts() const = 0;

  /// Returns the link that forces move and that an insertion point moves with, or -1 for the base or the body itself.
  /// Empty: no link of this object moves with it.
  virtual std::optional<int> link_at(std::string_view insertion_point) const {
    return insertion_point == point ? std::optional(-1) : std::nullopt;
  }
  /// The pose of an insertion point, for which link_at() returns a link, in the frame of that link.
  virtual glm::dmat4 body_from_point(std::string_view /*insertion_point*/) const { return glm::dmat4(1); }
  /// Returns true for the insertion points of the body and of all its links, those that stand still included.
  virtual bool has_any(std::string_view insertion_point) const { return insertion_point == point; }
  /// Returns true if the insertion point moves with this link, or for -1 with the base or the body itself.
  virtual bool has_part(std::string_view insertion_point, int /*link*/) const { return insertion_point == point; }
  /// Returns an insertion point that moves with a link, or for -1 with the base or the body itself.
  virtual std::string point_of(int /*link*/) const { return point; }
  std::string name, point;  ///< of the element, and its insertion point
  std::string carrier{};    ///< the element `pose` of its file that places it; it stands while physics moves the body
  Location where;           ///< of its command
  struct MovedLink {
    std::string joint;     ///< the name of the element of type joint in front of it, or of a fixed joint
    std::size_t link = 0;  ///< in ArticulationDesc::links
  };
  std::vector<MovedLink> moved_links;  ///< of a robot
  std::optional<std::size_t> id;       ///< in the world; DynamicScene sets it
  bool stands = false;                 ///< nothing but a new value moves it
  bool follows_scene = false;          ///< begin_steps() needs the pose of its point in each frame
};

/// A body, or a link of one; as the default the world.
struct StandingBody {
  const DynamicObject* object = nullptr;
  int link = -1;  ///< -1: the base, or the body itself
  /// Whether forces move it.
  bool is_moved() const { return object != nullptr && object->parts().of_link(link).mass != nullptr; }
};

/// What stands at an insertion point; empty if nothing does.
std::optional<StandingBody> find_body(std::span<DynamicObject* const> objects, std::string_view insertion_point);

}  // namespace simvis
