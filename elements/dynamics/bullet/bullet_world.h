// A world of Bullet.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "elements/dynamics/bullet/bullet_articulation.h"
#include "elements/dynamics/bullet/bullet_shape.h"
#include "elements/dynamics/bullet/collision_filter.h"
#include "elements/dynamics/bullet/contact_algorithm.h"
#include "elements/dynamics/bullet/fixed_constraint.h"
#include "elements/dynamics/bullet/ordered_broadphase.h"
#include "elements/dynamics/world/world.h"

namespace simvis {

class BulletWorld : public DynamicsWorld {
 public:
  explicit BulletWorld(const WorldDesc& desc);
  ~BulletWorld() override;

  std::size_t add_body(const BodyDesc& body) override;
  std::size_t add_articulation(const ArticulationDesc& articulation) override;
  void remove(std::size_t id) override;
  std::size_t add_constraint(const ConstraintDesc& constraint) override;
  void remove_constraint(std::size_t constraint) override;
  void keep_apart(const WorldPart& a, const WorldPart& b) override;
  void move_surface(const WorldPart& part, const SurfaceMotion& motion) override;
  void move(std::size_t id, const glm::dmat4& world_from_body) override;
  void drive(std::size_t articulation, std::size_t link, const JointDrive& drive) override;
  void place_joint(std::size_t articulation, std::size_t link, double position) override;
  void place_ball(std::size_t articulation, std::size_t link, const glm::dquat& turn) override;
  void push(const WorldLink& link, const Wrench& wrench) override;
  std::optional<std::size_t> step() override;
  BodyState state(const WorldLink& link) const override;
  JointState joint(std::size_t articulation, std::size_t link) const override;
  glm::dquat ball(std::size_t articulation, std::size_t link) const override;
  void measure_load(std::size_t articulation, std::size_t link, bool on) override;
  LinkLoad load(std::size_t articulation, std::size_t link) const override;
  std::vector<WorldContact> contacts() const override;
  std::vector<WorldContact> touching() override;
  void number_from(std::size_t id) override { next_id_ = id; }
  void archive(StateArchive& state) override;
  std::size_t awake() const override;

 private:
  struct Body {
    BodyKind kind;
    btTransform frame_from_body;
    std::unique_ptr<BulletShape> shape;
    std::unique_ptr<btRigidBody> rigid;
  };

  void make_world(bool jointed);
  void use_filter();
  void filter_masks(std::span<const CollisionShape> shapes, const SurfaceProperties& surface);
  btCollisionObject* collider(const WorldLink& link) const;
  ConstrainedFrame frame_of(const WorldLink& link, const glm::dmat4& link_from_joint) const;
  void find_loads();
  void leave_contacts(std::size_t id);
  void wake_all();
  void keep_moving_awake();
  void set_surface(const WorldPart& part, const SurfaceMotion& motion);
  void wake_touching(const btRigidBody& body);
  std::vector<btCollisionObject*> objects() const;
  std::vector<btMultiBodyConstraint*> all_constraints() const;
  void archive_surfaces(StateArchive& state);
  void archive_constraints(StateArchive& state);
  void archive_impulses(StateArchive& state);
  void archive_orders(StateArchive& state);
  void archive_contacts(StateArchive& state);
  btBroadphasePair& archive_pair(StateArchive& state, std::span<btCollisionObject* const> all, int place);

  WorldDesc desc_;
  CollisionFilter filter_;
  ContactConfiguration configuration_{filter_};
  btCollisionDispatcher dispatcher_{&configuration_};
  OrderedBroadphase broadphase_;
  std::unique_ptr<btSequentialImpulseConstraintSolver> solver_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  btMultiBodyDynamicsWorld* jointed_ = nullptr;  // world_, once there are joints; the plain one is faster
  std::size_t next_id_ = 0;
  bool wakes_all_ = false;  // the next step
  std::map<std::size_t, Body> bodies_;
  std::map<std::size_t, std::unique_ptr<BulletArticulation>> articulations_;
  struct Constraint {
    ConstraintDesc desc;
    btTransform world_from_joint;  // without a second body: where the first one stood
    std::unique_ptr<btMultiBodyConstraint> made;
  };
  void make_constraint(std::size_t id, const ConstraintDesc& desc, const std::optional<btTransform>& world_from_joint);
  void take_out(const Constraint& constraint);
  void wake_constrained();
  std::map<std::size_t, Constraint> constraints_;  // by id
  std::size_t next_constraint_ = 0;
  std::map<WorldPart, SurfaceMotion> surface_motions_;  // those that have been set
};

}  // namespace simvis
