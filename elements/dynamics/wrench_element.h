// What pushes bodies: elements that exert a force and a torque on the body, or on the link of a robot, at whose
// insertion point they stand. To add one, write a class in a pair of files of elements/dynamics/forces/.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/element.h>
#include <simvis/pose.h>
#include "elements/dynamics/drawn_bodies.h"
#include "elements/dynamics/world/world.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// Limits of attributes that such elements share. The forces and torques of finite values are finite.
inline constexpr AttributeLimits kPushedPlace{.min = -kMaxCoordinate_m, .max = kMaxCoordinate_m},
    kPushingForce{.min = -1e12, .max = 1e12}, kLagTime{.min = 0, .max = 1e6};
inline constexpr AttributeUnit kDegreesPerSecond{"deg/s", glm::radians(1.0)};  ///< of a member in rad/s

/// The unit vector of an attribute that is a direction. Throws InputError at the attribute: it has no length.
glm::dvec3 unit_axis(const ElementContext& context, std::string_view attribute);

class DynamicObject;
class DynamicScene;

/// A body or link at the beginning of a step.
struct PushedBody {
  BodyState state;
  const MassProperties& mass;  ///< in the frame of the body
  std::span<const CollisionShape> shapes;
  glm::dmat4 body_from_point{1.0};  ///< of the insertion point; rigid

  /// A direction along the axes of the insertion point, in the world.
  glm::dvec3 direction(const glm::dvec3& of_point) const {
    return glm::dmat3(state.world_from_body) * (glm::dmat3(body_from_point) * of_point);
  }
  /// From the centre of mass to a place in the frame of the insertion point, along the axes of the world.
  glm::dvec3 arm_m(const glm::dvec3& point_m) const {
    return glm::dvec3(state.world_from_body * (body_from_point * glm::dvec4(point_m, 1))) - state.center_m;
  }
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

/// An element whose force and torque act in each step of physics.
class WrenchElement : public Element {
 public:
  ~WrenchElement() override;
  /// Returns the mean over the step. `body` is valid during the call. Called once for each step, in their order.
  virtual Wrench wrench(const PushedBody& body, const PhysicsStep& step) = 0;
  /// All bodies are put back to their start; the next step begins at 0 s.
  virtual void restart() {}

  const std::string& name() const { return name_; }
  const std::string& point() const { return point_; }

 protected:
  /// Throws InputError at the command: no physics, no body at the insertion point, or one that no force moves.
  explicit WrenchElement(const ElementContext& context);
  /// The body or link at the insertion point of the command, for checks in constructors.
  LinkParts body(const ElementContext& context) const;

 private:
  std::shared_ptr<DynamicScene> dynamic_;
  std::string name_, point_;
};

/// A force at a place `arm_m` from the centre of mass.
inline Wrench wrench_at(const glm::dvec3& arm_m, const glm::dvec3& force_n) {
  return {.force_n = force_n, .torque_nm = glm::cross(arm_m, force_n)};
}

/// All such elements of a scene.
class WrenchElements {
 public:
  void add(WrenchElement& element);
  void remove(WrenchElement& element);
  void restart();
  /// Bodies have come or gone: the next find_bodies() looks for them again.
  void forget_bodies() { is_found_ = false; }
  /// Those whose body has gone push nothing.
  void find_bodies(std::span<DynamicObject* const> objects);
  /// Before each step, after find_bodies(). Elements act in the order of their names, not of their commands.
  void act(DynamicsWorld& world, const PhysicsStep& step) const;

 private:
  struct Acting {
    WrenchElement* element;
    WorldLink link;
    LinkParts parts;
    glm::dmat4 body_from_point;
  };
  std::vector<WrenchElement*> elements_;  // by name
  std::vector<Acting> acting_;
  bool is_found_ = false;
};

}  // namespace simvis
