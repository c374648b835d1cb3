// Pulls of the page's pointers: damped springs between a point of a body and a point of the world.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

#include <simvis/state_archive.h>
#include "elements/dynamics/drawn_bodies.h"
#include "elements/dynamics/world/world.h"
#include "elements/sensed_physics.h"

namespace simvis {

class HandPulls {
 public:
  /// Replaces the pull of this puller. `parts` are those of the element that has the link, all of whose masses follow
  /// the hand. Throws InputError: a coordinate is beyond kMaxCoordinate_m.
  void set(std::uint64_t puller, const WorldLink& link, const DynamicParts& parts, const BodyPull& pull);
  void release(std::uint64_t puller) { pulls_.erase(puller); }
  void remove_body(std::size_t id);
  void clear() { pulls_.clear(); }
  void archive(StateArchive& state) { state(pulls_); }
  /// Before each step. The springs at one body or articulation share the strength of one: together they are not
  /// stiffer, so that a step of any length bears as many of them as one.
  void act(DynamicsWorld& world) const;

 private:
  struct Pull {
    WorldLink link;
    glm::dvec3 link_m{0}, target_m{0};
    double mass_kg = 0;  // of the whole element
    double reach_m = 0;  // the farthest from the centre of mass that it acts
    void archive(StateArchive& state) { state(link, link_m, target_m, mass_kg, reach_m); }
  };
  std::map<std::uint64_t, Pull> pulls_;  // by puller
};

}  // namespace simvis
