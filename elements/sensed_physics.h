// The questions of sensors to the physics of a scene: contacts and loads of joints. The element `physics` inserts an
// object of this class into the scene, where find_physics() finds it.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/node.h>
#include <simvis/pose.h>
#include <simvis/scene.h>

namespace simvis {

/// A body of physics in its last step. World frame.
struct StepMotion {
  /// Before the step, and after it.
  struct At {
    glm::dmat4 world_from_body{1.0};
    glm::dvec3 center_m{0},         ///< centre of mass
        velocity_m_s{0},            ///< of the centre of mass
        angular_velocity_rad_s{0};  ///< about the axes of the world

    glm::dvec3 velocity_of(const glm::dvec3& place_m) const {
      return velocity_m_s + glm::cross(angular_velocity_rad_s, place_m - center_m);
    }
  };
  At before{}, after{};
  double step_s = 0;  ///< 0: no step has been made

  /// The mean acceleration in the step of a place that is given in the frame of the body, which is rigid.
  glm::dvec3 acceleration_m_s2(const glm::dvec3& body_m) const {
    const auto velocity = [&](const At& at) {
      return at.velocity_of(glm::dvec3(at.world_from_body * glm::dvec4(body_m, 1)));
    };
    return (velocity(after) - velocity(before)) / step_s;
  }
};

class SensedPhysics : public Group {
 public:
  /// Where the body at an insertion point touches others: all of an element's body, or a link of a robot. Empty if none
  /// stands there.
  virtual std::optional<std::vector<Contact>> contacts_at(std::string_view point) const = 0;
  /// The elements of type joint whose loads are measured in all further steps; no others are.
  virtual void measure_loads(std::set<std::string, std::less<>> joints) = 0;
  /// Empty if no robot of physics has a joint of this element. Zero before the first step.
  virtual std::optional<JointLoad> load_of(std::string_view joint) const = 0;
  /// Whether a body, or a link of one, is at an insertion point.
  virtual bool moves(std::string_view point) const = 0;
  /// The points whose motions are measured in all further steps; no others are.
  virtual void follow_points(std::set<std::string, std::less<>> points) = 0;
  /// The last step of the body at a point. Empty if there is none, before the first frame, or if the point is not
  /// followed.
  virtual std::optional<StepMotion> motion_of(std::string_view point) const = 0;
};

/// The physics of a scene; null if it has none.
std::shared_ptr<SensedPhysics> find_physics(const Scene& scene);

}  // namespace simvis
