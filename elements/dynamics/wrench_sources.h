// What pushes bodies: forces and torques that are evaluated in each step of physics.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "elements/dynamics/dynamic_object.h"
#include "elements/dynamics/world/world.h"

namespace simvis {

/// A body or link at the beginning of a step.
struct PushedBody {
  BodyState state;
  const MassProperties& mass;  ///< in the frame of the body
  std::span<const CollisionShape> shapes;
  glm::dmat4 body_from_point{1.0};  ///< of the insertion point; rigid
  double sharing = 1;               ///< the number of sources that push this body or link

  /// A direction along the axes of the insertion point, in the world.
  glm::dvec3 direction(const glm::dvec3& of_point) const {
    return glm::dmat3(state.world_from_body) * (glm::dmat3(body_from_point) * of_point);
  }
  /// From the centre of mass to a place in the frame of the insertion point, along the axes of the world.
  glm::dvec3 arm_m(const glm::dvec3& point_m) const {
    return glm::dvec3(state.world_from_body * (body_from_point * glm::dvec4(point_m, 1))) - state.center_m;
  }
  /// The velocity of the place at this arm, in m/s along the axes of the world.
  glm::dvec3 velocity_at(const glm::dvec3& arm_m) const {
    return state.velocity_m_s + glm::cross(state.angular_velocity_rad_s, arm_m);
  }
};

/// The step for which a wrench is evaluated.
struct PhysicsStep {
  double begin_s = 0;  ///< time since the start of physics
  double length_s = 0;
  glm::dvec3 gravity_m_s2{0};
};

/// A force at a place `arm_m` from the centre of mass.
inline Wrench wrench_at(const glm::dvec3& arm_m, const glm::dvec3& force_n) {
  return {.force_n = force_n, .torque_nm = glm::cross(arm_m, force_n)};
}

/// A force and a torque that act on the body at an insertion point in each step of physics.
class WrenchSource {
 public:
  WrenchSource(std::string name, std::string point) : name_(std::move(name)), point_(std::move(point)) {}
  virtual ~WrenchSource() = default;
  /// Returns the mean of the wrench over the step, at the centre of mass and along the axes of the world. Called once
  /// in each step in which the body exists, in the order of the steps. `body` is valid during the call.
  virtual Wrench wrench(const PushedBody& body, const PhysicsStep& step) = 0;
  /// Called when all bodies have been put back to their start. The next step begins at 0 s.
  virtual void restart() {}

  const std::string& name() const { return name_; }
  const std::string& point() const { return point_; }

 private:
  std::string name_, point_;
};

/// All sources of a scene.
class WrenchSources {
 public:
  void add(WrenchSource& source);
  void remove(WrenchSource& source);
  void restart();
  /// Bodies have come or gone: the next find_bodies() looks for them again.
  void forget_bodies() { is_found_ = false; }
  /// Finds the bodies of all sources, if one has come or gone since the last call. A source whose body has gone pushes
  /// nothing.
  void find_bodies(std::span<DynamicObject* const> objects);
  /// Pushes all bodies. Called before each step, after find_bodies(). The sources act in the order of their names, not
  /// of their commands.
  void act(DynamicsWorld& world, const PhysicsStep& step) const;

 private:
  struct Acting {
    WrenchSource* source;
    WorldLink link;
    LinkParts parts;
    glm::dmat4 body_from_point;
    double sharing = 1;
  };
  std::vector<WrenchSource*> sources_;  // by name
  std::vector<Acting> acting_;
  bool is_found_ = false;
};

}  // namespace simvis
