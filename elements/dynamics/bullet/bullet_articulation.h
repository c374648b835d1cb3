// A body with joints: Bullet's btMultiBody, in joint coordinates.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyGearConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <memory>
#include <optional>
#include <vector>

#include "elements/dynamics/bullet/bullet_ball_damper.h"
#include "elements/dynamics/bullet/bullet_shape.h"
#include "elements/dynamics/bullet/bullet_soft_joint.h"
#include "elements/dynamics/world/world.h"

namespace simvis {

class BulletArticulation {
 public:
  /// `id` is what its colliders carry as their user index.
  BulletArticulation(const ArticulationDesc& desc, btMultiBodyDynamicsWorld& world, double step_s, int id);
  ~BulletArticulation();
  BulletArticulation(const BulletArticulation&) = delete;
  BulletArticulation& operator=(const BulletArticulation&) = delete;

  void move(const glm::dmat4& world_from_base);
  void drive(std::size_t link, const JointDrive& drive);
  void move_surface(int part, const SurfaceMotion& motion);
  void place_joint(std::size_t link, double position);
  void place_ball(std::size_t link, const glm::dquat& turn);
  /// Before each step: what holds for one step only.
  void apply();
  /// A force on a link, -1 for the base, and its torque about the world's origin.
  struct Wrench {
    btVector3 force{0, 0, 0}, torque{0, 0, 0};
  };
  bool measures_loads() const { return measures_loads_; }
  /// After each step: the loads, by the forces that contacts exerted on each link.
  void find_loads(std::span<const Wrench> contacts, const btVector3& gravity);
  bool may_go_on() const;
  /// The pose and the speeds of a link; of the base for -1.
  BodyState state(int link) const;
  JointState joint(std::size_t link) const;
  glm::dquat ball(std::size_t link) const;
  std::size_t links() const { return links_.size(); }
  void measure_load(std::size_t link, bool on);
  LinkLoad load(std::size_t link) const { return links_[link].load; }
  /// The collider of a link, or of the base for -1, which is null if nothing of it collides.
  btMultiBodyLinkCollider* collider(int link) const {
    return link < 0 ? base_.collider.get() : links_[static_cast<std::size_t>(link)].collider.get();
  }
  btMultiBody& body() const { return *body_; }
  /// From a link's frame, or that of the base, to Bullet's.
  const btTransform& frame_from_link(int link) const {
    return link < 0 ? base_.frame_from_link : links_[static_cast<std::size_t>(link)].frame_from_link;
  }
  /// Bullet's frame of a link or the base, as it stands.
  btTransform world_from_frame(int link) const {
    return link < 0 ? body_->getBaseWorldTransform() : body_->getLink(link).m_cachedWorldTransform;
  }

 private:
  // A link with all links behind it; the angular momentum and the moment of mass are about the world's origin.
  struct Branch {
    double mass = 0;
    btVector3 momentum{0, 0, 0}, angular_momentum{0, 0, 0}, moment{0, 0, 0};
  };
  std::vector<Branch> branches() const;

  // The load of a joint: its link and all links behind it. The moment of mass and the inertia are about the base.
  struct Carried {
    double mass = 0;
    btVector3 moment{0, 0, 0};
    btMatrix3x3 inertia{0, 0, 0, 0, 0, 0, 0, 0, 0};
  };
  void find_carried();
  double deceleration(std::size_t link, double way) const;
  void drive_by_position();
  double drive_effort(std::size_t link) const;

  struct Link {
    btTransform frame_from_link;  // from the link's frame to Bullet's: centre of mass, principal axes
    bool moves = false;           // along or about an axis
    bool is_ball = false;         // moves about all
    double damping = 0, stiffness = 0, rest = 0, rotor_inertia = 0;
    JointDrive drive;
    double drive_effort = 0;  // of a drive that acts as an effort, in the last step
    std::unique_ptr<BulletShape> shape;
    std::unique_ptr<btMultiBodyLinkCollider> collider;
    bool measured = false;
    LinkLoad load;  // of the last step, if it is measured
    std::unique_ptr<btMultiBodyJointLimitConstraint> limit;
    std::unique_ptr<btMultiBodyJointMotor> motor;
    std::unique_ptr<BulletBallDamper> ball_damper;
    std::unique_ptr<BulletSoftJoint> soft, servo;  // what does not act as an effort: spring, damper, rotor; the drive
    bool is_soft_spring = false;                   // `soft` has the spring too
    std::optional<double> inertia;                 // see inertia(); set when it is first needed
  };
  void add_link(int index, const LinkDesc& desc);
  void couple(const CoupledJoints& joints);
  void add_damper(std::size_t link);
  void set_ball(std::size_t link, const glm::dquat& turn) const;
  void apply_ball(std::size_t link) const;
  double inertia(std::size_t link) const;
  bool is_stiff(std::size_t link, double stiffness, double damping);
  std::unique_ptr<BulletSoftJoint> make_soft(std::size_t link, const SoftJoint& soft);
  void soften_joints();
  void drive_servo(std::size_t link);
  void add_collider(int link, std::span<const CollisionShape> shapes, const SurfaceProperties& surface, Link& own,
                    int id);
  void place_links() const;
  void place_colliders();

  btMultiBodyDynamicsWorld& world_;
  double step_s_;
  bool fixed_base_;
  std::unique_ptr<btMultiBody> body_;
  Link base_;
  std::vector<Link> links_;
  std::vector<std::unique_ptr<btMultiBodyGearConstraint>> gears_;
  bool are_soft_ = false;  // joints that need it
  bool measures_loads_ = false;
  std::vector<Branch> before_;    // the step, if loads are measured
  std::vector<Carried> carried_;  // by each link's joint, now; while a drive by position is under way
};

/// Bullet's frame of a body: its origin is the centre of mass, its axes are those of the inertia.
struct BulletFrame {
  btTransform frame_from_body;
  btVector3 inertia;
};
BulletFrame bullet_frame(const MassProperties& mass);

}  // namespace simvis
