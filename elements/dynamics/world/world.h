// A world of rigid bodies and jointed bodies: descriptions in, poses out. Elements know this interface only; the engine
// behind it lies in a module of its own, see engine_module.h.
//
// Units    metres, kilograms, seconds, radians, newtons.
// Frames   world_from_X is rigid. A body's frame is the user's choice; its centre of mass lies anywhere in it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/state_archive.h>
#include "scenegraph/collision_mask.h"

namespace simvis {

struct MassProperties {
  double mass_kg = 0;
  glm::dvec3 center_m{0};         ///< centre of mass, in the body's frame
  glm::dmat3 inertia_kg_m2{0.0};  ///< about the centre of mass, along the axes of the body's frame
};

enum class CollisionKind : std::uint8_t { box, sphere, capsule, cylinder, hull, mesh, plane };

/// A contact uses the product of the numbers of the two surfaces. Surfaces whose masks do not meet have none.
struct SurfaceProperties {
  double friction = 0.7, restitution = 0;
  bool larger_friction = false;  ///< of two surfaces that both say so, the larger friction counts
  CollisionMask mask{};
  bool operator==(const SurfaceProperties&) const = default;
};

/// How a surface moves along itself while its shape stays, as that of a belt, a track or a wheel with rollers. In the
/// frame of the body or link.
struct SurfaceMotion {
  /// Axis about which the belt turns, a unit vector times m/s: {0, s, 0} carries what lies on top along +x at s. The
  /// surface moves at cross(belt_m_s, its outward normal).
  glm::dvec3 belt_m_s{0};
  std::optional<glm::dvec3> roller_axis{};  ///< friction acts along it only, since rollers turn about it; unit length.
                                            ///< None: friction acts along all directions
  bool operator==(const SurfaceMotion&) const = default;
  void archive(StateArchive& state) {
    state.finite(belt_m_s);
    state(roller_axis);
    if (roller_axis) state.require(std::isfinite(glm::dot(*roller_axis, *roller_axis)));
  }
};

/// A piece of a body's surface. Only bodies that no force moves may have a mesh or a plane, which is z = 0 and solid
/// below.
struct CollisionShape {
  CollisionKind kind = CollisionKind::box;
  glm::dmat4 body_from_shape{1.0};
  /// box: half of the edges; sphere: the radius in x; capsule and cylinder, along z: the radius in x, in z half of the
  /// length of the cylinder.
  glm::dvec3 half_m{0};
  std::vector<glm::dvec3> points{};            ///< corners of a hull or a mesh
  std::vector<std::uint32_t> triangles{};      ///< three corners each; those of a hull are closed and seen from outside
                                               ///< counter-clockwise
  std::optional<SurfaceProperties> surface{};  ///< none: that of the body or link
  int part = 0;  ///< the part of the body or articulation to which it belongs, see WorldPart
};

enum class BodyKind : std::uint8_t { fixed, kinematic, dynamic };

struct BodyDesc {
  BodyKind kind = BodyKind::dynamic;
  glm::dmat4 world_from_body{1.0};
  MassProperties mass{};  ///< of a dynamic body
  std::vector<CollisionShape> shapes{};
  SurfaceProperties surface{};
  double linear_damping_per_s = 0, angular_damping_per_s = 0;
  bool has_weight = true;                                 ///< of a dynamic body: gravity acts on it
  glm::dvec3 velocity_m_s{0}, angular_velocity_rad_s{0};  ///< of the centre of mass, along the axes of the world
};

struct BodyState {
  glm::dmat4 world_from_body{1.0};
  glm::dvec3 center_m{0};                                 ///< the centre of mass, in the world
  glm::dvec3 velocity_m_s{0}, angular_velocity_rad_s{0};  ///< of the centre of mass, along the axes of the world
};

enum class JointKind : std::uint8_t { fixed, revolute, prismatic, ball };

/// The part of a jointed body that one joint moves. Positions are in rad or m, efforts in N m or N.
struct LinkDesc {
  int parent = -1;                    ///< index of an earlier link; -1: the base
  glm::dmat4 parent_from_joint{1.0};  ///< parent_from_link at position 0
  JointKind joint = JointKind::fixed;
  glm::dvec3 axis{0, 0, 1};  ///< unit length, in the link's frame, through its origin
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  double position = 0;             ///< at the start
  glm::dquat turn{1, 0, 0, 0};     ///< of a ball at the start: its rotation behind parent_from_joint; it has no axis
                                   ///< and no limits, and its `rest` is no turn
  double damping = 0;              ///< effort per speed
  bool damps_new_speed = false;    ///< the speed at the end of a step, which no damping makes unstable; else the one
                                   ///< at its beginning
  double stiffness = 0, rest = 0;  ///< of a spring: effort per distance from `rest`
  double rotor_inertia = 0;        ///< effort per acceleration of the joint alone, as of a geared motor; for a revolute
                                   ///< or prismatic joint. With a rotor, `damping` acts on the new speed
  MassProperties mass{};
  std::vector<CollisionShape> shapes{};
  SurfaceProperties surface{};
};

/// The position of `follower` is multiplier * that of `leader` + offset; both joints feel the force. Both move.
struct CoupledJoints {
  std::size_t follower = 0, leader = 0;  ///< indices of links
  double multiplier = 1, offset = 0;
};

struct ArticulationDesc {
  bool fixed_base = true;
  glm::dmat4 world_from_base{1.0};
  MassProperties mass{};  ///< of the base
  std::vector<CollisionShape> shapes{};
  SurfaceProperties surface{};
  std::vector<LinkDesc> links{};
  std::vector<CoupledJoints> coupled{};
  bool links_collide = false;  ///< with each other, except for a link and its parent
  struct PartPair {
    int a = 0, b = 0;
    auto operator<=>(const PartPair&) const = default;
  };
  std::vector<PartPair> apart{};  ///< parts that do not collide with each other
};

/// A body, or a link of an articulation.
struct WorldLink {
  std::size_t id = 0;
  int link = -1;  ///< -1: the base of an articulation, or a body
  auto operator<=>(const WorldLink&) const = default;
  void archive(StateArchive& state) { state(id, link); }
};

/// The shapes of a body or articulation that have one number: a link of a file, of which fixed joints may join several
/// to one link of an articulation.
struct WorldPart {
  std::size_t id = 0;
  int part = 0;
  auto operator<=>(const WorldPart&) const = default;
  void archive(StateArchive& state) { state(id, part); }
};

/// A constraint between two bodies or links, besides the joints of an articulation. Kinematic and fixed bodies may be
/// one of the two.
struct ConstraintDesc {
  /// A point keeps the origins together, for links of articulations only; fixed keeps the whole frames together.
  enum class Kind : std::uint8_t { point, fixed } kind = Kind::point;
  WorldLink a{};
  std::optional<WorldLink> b{};                     ///< none: the world, where a stands now
  glm::dmat4 a_from_joint{1.0}, b_from_joint{1.0};  ///< rigid
  bool collide = true;                              ///< the two with each other
};

/// How a joint is driven until the next call. Speed: up to `max_effort`, towards `target`. Effort: `target`. Servo: the
/// effort `stiffness` * (`target` - position) + `damping` * (`target_speed` - speed) + `feed_forward`, from
/// `min_effort` to `max_effort`. Position: as speed, towards `target_speed` + `gain_per_s` * (`target` - position),
/// where the second term is at most `max_speed`, and so slow that `max_effort` stops the joint at the target if the
/// others stand.
struct JointDrive {
  enum class Kind : std::uint8_t { none, speed, effort, servo, position } kind = Kind::none;
  double target = 0, max_effort = 0;
  std::optional<double> min_effort{};                   ///< of a servo; none: -max_effort
  double stiffness = 0, damping = 0, feed_forward = 0;  ///< of a servo
  double target_speed = 0;                              ///< of a servo and a position
  double gain_per_s = 0, max_speed = 0;                 ///< of a position
  double friction = 0;  ///< effort of the joint's own friction, except with a drive by speed or
                        ///< position
};

struct JointState {
  double position = 0, speed = 0;
  double effort = 0;  ///< of its drive, the mean of the last step
};

struct WorldDesc {
  glm::dvec3 gravity_m_s2{0};
  double step_s = 0;
  int iterations = 0;  ///< of the solver of contacts, joints and limits, in each step
};

/// Two bodies that touch or overlap.
struct WorldContact {
  std::size_t body_a = 0, body_b = 0;  ///< ids
  int link_a = -1, link_b = -1;        ///< of an articulation; -1: its base, or a body
  glm::dvec3 point_m{0};               ///< midway between both surfaces
  glm::dvec3 normal{0, 0, 1};          ///< from b towards a
  double depth_m = 0;                  ///< above 0: they overlap by so much; below 0: a force acts across a gap
  double force_n = 0;                  ///< along the normal, mean of the last step
};

/// The force and the torque that a link exerts on its parent, as means over the last step. All vectors have the axes of
/// the world.
struct LinkLoad {
  glm::dvec3 origin_m{0};   ///< the joint's origin, in the world
  glm::dvec3 force_n{0};    ///< on the parent
  glm::dvec3 torque_nm{0};  ///< on the parent, about the joint's origin
};

/// A force at the centre of mass of a body or link, and a torque. Both have the axes of the world.
struct Wrench {
  glm::dvec3 force_n{0}, torque_nm{0};
};

/// Ids     of bodies and articulations, from one count, never given twice.
/// Errors  no function but archive() throws; a broken precondition asserts or is undefined.
/// Results the same calls give the same bytes on one machine.
/// Threads one thread at a time.
class DynamicsWorld {
 public:
  virtual ~DynamicsWorld() = default;
  virtual std::size_t add_body(const BodyDesc& body) = 0;
  virtual std::size_t add_articulation(const ArticulationDesc& articulation) = 0;
  /// Its constraints go with it.
  virtual void remove(std::size_t id) = 0;
  /// Returns its id, from a count of constraints, never given twice. A body that it holds does not sleep.
  virtual std::size_t add_constraint(const ConstraintDesc& constraint) = 0;
  /// Does nothing for one that has gone with a body.
  virtual void remove_constraint(std::size_t constraint) = 0;
  /// From now on, two parts do not collide.
  virtual void keep_apart(const WorldPart& a, const WorldPart& b) = 0;

  /// Sets how the surface of a part moves from the next step on. Before the first call it does not move and has no
  /// rollers. A new motion wakes what sleeps on the body.
  virtual void move_surface(const WorldPart& part, const SurfaceMotion& motion) = 0;

  /// A dynamic body, or the base of an articulation, stands at this pose and rests; a kinematic body arrives there at
  /// the end of the next step.
  virtual void move(std::size_t id, const glm::dmat4& world_from_body) = 0;
  virtual void drive(std::size_t articulation, std::size_t link, const JointDrive& drive) = 0;
  /// A joint stands at this position and rests.
  virtual void place_joint(std::size_t articulation, std::size_t link, double position) = 0;
  virtual void place_ball(std::size_t articulation, std::size_t link, const glm::dquat& turn) = 0;

  /// Acts on a dynamic body, or on a link or a free base, during the next step only, besides all others that act on it.
  /// A body on which a force or a torque other than 0 acts does not stay asleep.
  virtual void push(const WorldLink& link, const Wrench& wrench) = 0;

  /// One step. Returns the id of a body that cannot go on: its state is not finite, or faster than kMaxSpeed.
  virtual std::optional<std::size_t> step() = 0;

  virtual BodyState state(const WorldLink& link) const = 0;
  BodyState state(std::size_t id) const { return state(WorldLink{.id = id}); }
  virtual JointState joint(std::size_t articulation, std::size_t link) const = 0;
  virtual glm::dquat ball(std::size_t articulation, std::size_t link) const = 0;  ///< its rotation, as LinkDesc::turn
  /// Whether load() is measured in the next steps; not at first.
  virtual void measure_load(std::size_t articulation, std::size_t link, bool on) = 0;
  virtual LinkLoad load(std::size_t articulation, std::size_t link) const = 0;  ///< zero if it is not measured
  virtual std::vector<WorldContact> contacts() const = 0;                       ///< of the last step
  virtual std::vector<WorldContact> touching() = 0;  ///< as the bodies stand now, before the next step
  /// The next body or articulation gets this id, which is above all others and below 2^31.
  virtual void number_from(std::size_t id) = 0;
  /// Writes the state between two steps with all constraints, or replaces it by that of a world with the same bodies
  /// and articulations, which were added by the same descriptions and have the same ids. Further steps then give the
  /// same bytes. Throws InputError for a state that is not possible; another call has to replace it then.
  virtual void archive(StateArchive& state) = 0;

  /// Dynamic bodies and articulations that the next step has to move. Dynamic bodies that touch others and have been
  /// slower than kRestSpeed for 2 s, all of those that touch each other, stand still and cost nothing until something
  /// that moves touches them, or a body is moved or removed.
  virtual std::size_t awake() const = 0;
};

/// What is slower rests. Contacts tremble by a hundredth of it, and by more in single steps.
inline constexpr double kRestSpeed_m_s = 1e-3, kRestSpeed_rad_s = 1e-3;

/// A body that is faster has exploded: no robot moves at 10 km/s or turns 16,000 times a second.
inline constexpr double kMaxSpeed_m_s = 1e4, kMaxSpeed_rad_s = 1e5;

class DynamicsEngine {
 public:
  virtual ~DynamicsEngine() = default;
  virtual std::unique_ptr<DynamicsWorld> make_world(const WorldDesc& desc) const = 0;
  /// The convex hull of points as a CollisionShape with closed triangles. Empty if they lie in one plane.
  virtual std::optional<CollisionShape> convex_hull(std::span<const glm::dvec3> points) const = 0;
  /// Convex hulls that together resemble a mesh with three corners for each triangle, seen from outside
  /// counter-clockwise. Where a hull is not flush with the surface, it lies up to about `concavity_m` in front of it; a
  /// large mesh is simplified first. A flat piece becomes a plate behind its surface, half as thick. Hulls may overlap.
  virtual std::vector<CollisionShape> convex_pieces(std::span<const glm::dvec3> points,
                                                    std::span<const std::uint32_t> triangles,
                                                    double concavity_m) const = 0;
};

}  // namespace simvis
