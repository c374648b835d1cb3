// The interface of a scene's physics for sensors (contacts, loads of joints, motions of bodies) and for the page
// (bodies, shapes, pulls). The element `physics` inserts an object of this class into the scene, where find_physics()
// finds it.
#pragma once

#include <cstddef>
#include <cstdint>
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
#include <simvis/progress.h>
#include <simvis/scene.h>
#include "engine/base/program_api.h"

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

/// A collision shape of a body. Meshes are left out: their collision shape is the mesh that is drawn.
struct DrawnShape {
  enum class Kind : std::uint8_t { box, sphere, capsule, cylinder, hull, plane } kind = Kind::box;
  glm::dmat4 body_from_shape{1.0};
  glm::dvec3 half_m{0};                    ///< box: half of the edges; sphere: the radius in x; capsule and cylinder,
                                           ///< along z: the radius in x, in z half of the length of the cylinder
  std::vector<glm::dvec3> points{};        ///< corners of a hull
  std::vector<std::uint32_t> triangles{};  ///< of a hull, three corners each
};

/// The joint in front of a link.
struct DrawnJoint {
  enum class Kind : std::uint8_t { fixed, revolute, prismatic, ball } kind = Kind::fixed;
  glm::dvec3 axis{0, 0, 1};  ///< unit length, in the body's frame, through its origin
};

/// A body, or a link of a robot or a vehicle.
struct DrawnBody {
  enum class Motion : std::uint8_t { fixed, kinematic, dynamic } motion = Motion::fixed;
  std::string element;     ///< the name of the element that adds it
  std::string name;        ///< the insertion point of the link, or of the element
  double mass_kg = 0;      ///< 0 unless the body is dynamic
  glm::dvec3 center_m{0};  ///< centre of mass, in the body's frame
  glm::dmat3 axes{1.0};    ///< of inertia, as columns, in the body's frame
  glm::dvec3 half_m{0};    ///< of the solid ellipsoid along these axes that has this mass and inertia
  std::vector<DrawnShape> shapes{};
  std::optional<DrawnJoint> joint{};
};

/// A contact of two bodies. All vectors are in the world frame.
struct DrawnContact {
  Contact contact;                      ///< its normal points from b to a
  std::optional<std::size_t> a{}, b{};  ///< indices in SensedPhysics::drawn_bodies(); empty: not among them
};

/// The poses and contacts of the bodies after the last step.
struct DrawnPhysics {
  std::vector<glm::dmat4> world_from_body;  ///< in the order of SensedPhysics::drawn_bodies()
  std::vector<DrawnContact> contacts;
};

/// A damped spring that pulls a body to a place of the world.
struct BodyPull {
  std::size_t body = 0;    ///< index in SensedPhysics::drawn_bodies()
  glm::dvec3 body_m{0};    ///< the end of the spring at the body, in the body's frame
  glm::dvec3 target_m{0};  ///< the other end, in the world
};

/// A contact of a body that was asked for.
struct PointContact {
  Contact contact;           ///< without ids
  std::string own, other{};  ///< insertion points of that body or link, and of the one that touches it; empty: removed
};

class SensedPhysics : public Group {
 public:
  /// Where the body at an insertion point touches others: all of an element's body, or a link of a robot. Empty if none
  /// stands there.
  virtual std::optional<std::vector<PointContact>> contacts_at(std::string_view point) const = 0;
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
  /// Where the body at a point is after the last step, and how it moves. The point need not be followed. Empty if no
  /// body is there, or before the first frame.
  virtual std::optional<StepMotion::At> state_of(std::string_view point) const = 0;
  /// All bodies and links. They stay the same until elements are added to the scene or removed; none before the first
  /// step.
  virtual std::vector<DrawnBody> drawn_bodies() const = 0;
  /// The poses of drawn_bodies(), and the contacts of the last step; empty before the first step.
  virtual DrawnPhysics drawn_state() const = 0;
  /// Pulls one body from the next step on, until the next call with this `puller`, a number that the caller chooses, or
  /// until all bodies are put back; empty: the puller lets go. Pullers of one body share the strength of one. Throws
  /// InputError: the world has not been made yet, there is no such body, no force moves it, or a coordinate is beyond
  /// kMaxCoordinate_m.
  virtual void pull(std::uint64_t puller, const std::optional<BodyPull>& pull) = 0;
  /// From now on, `progress` is called every 100 steps of a frame. If it throws, so does the frame; the steps that are
  /// left belong to the next one. Empty: nothing is called.
  virtual void report_to(ProgressCallback progress) = 0;
};

/// The physics of a scene; null if it has none.
SIMVIS_PROGRAM_API std::shared_ptr<SensedPhysics> find_physics(const Scene& scene);

}  // namespace simvis
