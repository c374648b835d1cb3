#include "elements/dynamics/bullet/bullet_world.h"

#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "elements/dynamics/bullet/bullet_types.h"
#include "elements/dynamics/bullet/contact_manifolds.h"
#include "elements/dynamics/bullet/contact_solver.h"

namespace simvis {
namespace {

// Bullet removes the share d of a speed in a second; a rate c leaves e^-c of it.
double share_per_second(double rate_per_s) { return -std::expm1(-rate_per_s); }

// The passes of the solver end once no speed changes by more than this.
constexpr double kSolved_m_s = 1e-8;
// The share of an overlap that a step mends. Twice as much keeps towers of ten boxes trembling.
constexpr double kMendedShare = 0.1;

// Bullet also keeps points of bodies that are near. They count if a force acts across the gap; it is known only where
// the solver has looked at the point.
bool touches(const btPersistentManifold& manifold, const btManifoldPoint& point) {
  if (point.getDistance() <= 0) return true;
  return point.getDistance() <= manifold.getContactProcessingThreshold() && point.getAppliedImpulse() > 0;
}

// Bullet's boxes reach so far beyond the shapes.
constexpr double kBoxMargin_m = 0.02;

bool may_go_on(const btRigidBody& body) {
  const auto slow = [](const btVector3& v, double limit) { return v.length2() <= limit * limit; };  // false for NaN
  return slow(body.getLinearVelocity(), kMaxSpeed_m_s) && slow(body.getAngularVelocity(), kMaxSpeed_rad_s) &&
         std::isfinite(body.getWorldTransform().getOrigin().length2());
}

// Bullet also predicts how bodies that stand still will move. Nothing reads its prediction for links, whose boxes
// follow from their speeds instead.
template <typename World>
class AwakeWorld : public World {
 public:
  using World::World;
  void updateAabbs() override {
    for (int i = 0; i < this->m_collisionObjects.size(); ++i) {
      btCollisionObject& object = *this->m_collisionObjects[i];
      if (!this->m_forceUpdateAllAabbs && !object.isActive()) continue;
      const double way_m = object.getInternalType() == btCollisionObject::CO_FEATHERSTONE_LINK
                               ? way_in_step(object, this->getDispatchInfo().m_timeStep)
                               : 0;
      if (way_m > kBoxMargin_m) {
        set_box_of_way(object, way_m);
      } else {
        this->updateSingleAabb(&object);
      }
    }
  }
  void predictUnconstraintMotion(btScalar step_s) override {
    for (int i = 0; i < this->m_nonStaticRigidBodies.size(); ++i) {
      btRigidBody& body = *this->m_nonStaticRigidBodies[i];
      if (body.isStaticOrKinematicObject() || !body.isActive()) continue;
      body.applyDamping(step_s);
      body.predictIntegratedTransform(step_s, body.getInterpolationWorldTransform());
    }
  }

 private:
  void set_box_of_way(btCollisionObject& object, double way_m) {
    btVector3 low, high;
    object.getCollisionShape()->getAabb(object.getWorldTransform(), low, high);
    const btVector3 more(way_m, way_m, way_m);
    this->getBroadphase()->setAabb(object.getBroadphaseHandle(), low - more, high + more, this->getDispatcher());
  }
};

}  // namespace

BulletWorld::BulletWorld(const WorldDesc& desc) : desc_(desc) { make_world(false); }

void BulletWorld::make_world(bool jointed) {
  for (const auto& [id, body] : bodies_) world_->removeRigidBody(body.rigid.get());
  world_.reset();
  if (jointed) {
    auto solver = std::make_unique<ContactSolver<btMultiBodyConstraintSolver>>();
    auto world = std::make_unique<AwakeWorld<btMultiBodyDynamicsWorld>>(&dispatcher_, &broadphase_, solver.get(),
                                                                        &configuration_);
    jointed_ = world.get();
    solver_ = std::move(solver);
    world_ = std::move(world);
  } else {
    jointed_ = nullptr;
    solver_ = std::make_unique<ContactSolver<btSequentialImpulseConstraintSolver>>();
    world_ = std::make_unique<AwakeWorld<btDiscreteDynamicsWorld>>(&dispatcher_, &broadphase_, solver_.get(),
                                                                   &configuration_);
  }
  world_->setGravity(to_bullet(desc_.gravity_m_s2));
  btContactSolverInfo& info = world_->getSolverInfo();
  info.m_numIterations = desc_.iterations;
  info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  info.m_erp2 = kMendedShare;
  info.m_warmstartingFactor = 1;  // see start_contacts()
  info.m_splitImpulse = false;
  info.m_leastSquaresResidualThreshold = kSolved_m_s * kSolved_m_s;
  info.m_minimumSolverBatchSize = 1;      // what touches nothing of an island has no effect on it
  world_->setForceUpdateAllAabbs(false);  // those of bodies at rest stay
  for (const auto& [id, body] : bodies_) world_->addRigidBody(body.rigid.get());
}

BulletWorld::~BulletWorld() {
  for (const auto& [id, each] : constraints_) jointed_->removeMultiBodyConstraint(each.made.get());
  broadphase_.remove_pairs(dispatcher_);
  for (const auto& [id, body] : bodies_) world_->removeRigidBody(body.rigid.get());
  articulations_.clear();
}

std::size_t BulletWorld::add_body(const BodyDesc& desc) {
  const bool moves = desc.kind == BodyKind::dynamic;
  const BulletFrame frame = moves ? bullet_frame(desc.mass) : BulletFrame{btTransform::getIdentity(), {0, 0, 0}};
  Body body{desc.kind,
            frame.frame_from_body,
            std::make_unique<BulletShape>(desc.shapes, desc.surface, frame.frame_from_body),
            {}};
  btRigidBody::btRigidBodyConstructionInfo info(moves ? desc.mass.mass_kg : 0, nullptr, body.shape->get(),
                                                frame.inertia);
  info.m_startWorldTransform = to_bullet(desc.world_from_body) * frame.frame_from_body.inverse();
  info.m_linearDamping = share_per_second(desc.linear_damping_per_s);
  info.m_angularDamping = share_per_second(desc.angular_damping_per_s);
  body.rigid = std::make_unique<btRigidBody>(info);
  body.rigid->setLinearVelocity(to_bullet(desc.velocity_m_s));
  body.rigid->setAngularVelocity(to_bullet(desc.angular_velocity_rad_s));
  if (moves) body.rigid->setSleepingThresholds(kRestSpeed_m_s, kRestSpeed_rad_s);
  if (desc.kind == BodyKind::kinematic) body.rigid->setActivationState(DISABLE_DEACTIVATION);
  body.rigid->setUserIndex(static_cast<int>(next_id_));
  set_mask(*body.rigid, body.shape->mask());
  if (!desc.has_weight) body.rigid->setFlags(body.rigid->getFlags() | BT_DISABLE_WORLD_GRAVITY);
  int flags = body.rigid->getCollisionFlags();
  if (desc.kind == BodyKind::kinematic) {
    flags = (flags & ~btCollisionObject::CF_STATIC_OBJECT) | btCollisionObject::CF_KINEMATIC_OBJECT;
  }
  body.rigid->setCollisionFlags(flags);
  filter_masks(desc.shapes, desc.surface);
  world_->addRigidBody(body.rigid.get());
  bodies_.emplace(next_id_, std::move(body));
  return next_id_++;
}

std::size_t BulletWorld::add_articulation(const ArticulationDesc& desc) {
  if (jointed_ == nullptr) make_world(true);
  filter_masks(desc.shapes, desc.surface);
  for (const LinkDesc& link : desc.links) filter_masks(link.shapes, link.surface);
  if (!desc.apart.empty()) use_filter();
  for (const ArticulationDesc::PartPair& pair : desc.apart) {
    filter_.keep_apart({next_id_, pair.a}, {next_id_, pair.b});
  }
  articulations_.emplace(
      next_id_, std::make_unique<BulletArticulation>(desc, *jointed_, desc_.step_s, static_cast<int>(next_id_)));
  return next_id_++;
}

void BulletWorld::use_filter() { broadphase_.getOverlappingPairCache()->setOverlapFilterCallback(&filter_); }

// Objects of which all masks have all bits are what Bullet compares without a filter.
void BulletWorld::filter_masks(std::span<const CollisionShape> shapes, const SurfaceProperties& surface) {
  const bool has_masks = std::ranges::any_of(shapes, [&](const CollisionShape& shape) {
    return (shape.surface ? shape.surface->mask : surface.mask) != CollisionMask();
  });
  if (has_masks) use_filter();
}

btCollisionObject* BulletWorld::collider(const WorldLink& link) const {
  const auto body = bodies_.find(link.id);
  if (body != bodies_.end()) return body->second.rigid.get();
  return articulations_.at(link.id)->collider(link.link);
}

// Bullet asks the filter for new pairs only; those that it has leave here.
void BulletWorld::keep_apart(const WorldPart& a, const WorldPart& b) {
  filter_.keep_apart(a, b);
  use_filter();
  struct LeavesFiltered : btOverlapCallback {
    const CollisionFilter& filter;
    explicit LeavesFiltered(const CollisionFilter& by) : filter(by) {}
    bool processOverlap(btBroadphasePair& pair) override {
      return !filter.needBroadphaseCollision(pair.m_pProxy0, pair.m_pProxy1);
    }
  } leaves_filtered(filter_);
  broadphase_.getOverlappingPairCache()->processAllOverlappingPairs(&leaves_filtered, &dispatcher_);
}

ConstrainedFrame BulletWorld::frame_of(const WorldLink& link, const glm::dmat4& link_from_joint) const {
  const btTransform joint = to_bullet(link_from_joint);
  if (const auto found = bodies_.find(link.id); found != bodies_.end()) {
    const Body& body = found->second;
    return {.rigid = body.rigid.get(), .frame_from_joint = body.frame_from_body * joint};
  }
  const BulletArticulation& links = *articulations_.at(link.id);
  return {.links = &links.body(), .link = link.link, .frame_from_joint = links.frame_from_link(link.link) * joint};
}

std::size_t BulletWorld::add_constraint(const ConstraintDesc& desc) {
  make_constraint(next_constraint_, desc, std::nullopt);
  return next_constraint_++;
}

void BulletWorld::make_constraint(std::size_t id, const ConstraintDesc& desc,
                                  const std::optional<btTransform>& world_from_joint) {
  if (jointed_ == nullptr) make_world(true);
  const ConstrainedFrame a = frame_of(desc.a, desc.a_from_joint);
  const btTransform place = world_from_joint.value_or(a.world_from_joint());
  const ConstrainedFrame b =
      desc.b ? frame_of(*desc.b, desc.b_from_joint) : ConstrainedFrame{.frame_from_joint = place};
  std::unique_ptr<btMultiBodyConstraint> made;
  if (desc.kind == ConstraintDesc::Kind::fixed) {
    made = std::make_unique<FixedConstraint>(a, b);
  } else {
    const btVector3 &pivot_a = a.frame_from_joint.getOrigin(), &pivot_b = b.frame_from_joint.getOrigin();
    made = b.links == nullptr
               ? std::make_unique<btMultiBodyPoint2Point>(a.links, a.link, static_cast<btRigidBody*>(nullptr), pivot_a,
                                                          pivot_b)
               : std::make_unique<btMultiBodyPoint2Point>(a.links, a.link, b.links, b.link, pivot_a, pivot_b);
    made->setMaxAppliedImpulse(BT_LARGE_FLOAT);
  }
  jointed_->addMultiBodyConstraint(made.get());
  made->finalizeMultiDof();
  if (!desc.collide && desc.b) filter_.hold(desc.a, *desc.b);
  constraints_.emplace(id, Constraint{desc, place, std::move(made)});
}

void BulletWorld::take_out(const Constraint& constraint) {
  const ConstraintDesc& desc = constraint.desc;
  if (!desc.collide && desc.b) filter_.release(desc.a, *desc.b);
  jointed_->removeMultiBodyConstraint(constraint.made.get());
}

void BulletWorld::remove_constraint(std::size_t constraint) {
  const auto found = constraints_.find(constraint);
  if (found == constraints_.end()) return;
  take_out(found->second);
  constraints_.erase(found);
}

void BulletWorld::wake_constrained() {
  const auto wake = [&](const WorldLink& link) {
    const auto body = bodies_.find(link.id);
    if (body != bodies_.end() && body->second.kind == BodyKind::dynamic) body->second.rigid->activate(true);
  };
  for (const auto& [id, each] : constraints_) {
    wake(each.desc.a);
    if (each.desc.b) wake(*each.desc.b);
  }
}

void BulletWorld::remove(std::size_t id) {
  std::erase_if(constraints_, [&](const auto& each) {
    const ConstraintDesc& desc = each.second.desc;
    if (desc.a.id != id && !(desc.b && desc.b->id == id)) return false;
    take_out(each.second);
    return true;
  });
  filter_.remove(id);
  std::erase_if(surface_motions_, [&](const auto& each) { return each.first.id == id; });
  wakes_all_ = true;
  if (const auto body = bodies_.find(id); body != bodies_.end()) {
    world_->removeRigidBody(body->second.rigid.get());
    bodies_.erase(body);
    return;
  }
  articulations_.erase(id);
}

// Bullet keeps the contacts of a pair for some steps after its bodies have parted, and would take those of a body that
// is put elsewhere for deep ones.
void BulletWorld::leave_contacts(std::size_t id) {
  const auto leave = [&](btCollisionObject* object) {
    if (object == nullptr || object->getBroadphaseHandle() == nullptr) return;
    broadphase_.getOverlappingPairCache()->cleanProxyFromPairs(object->getBroadphaseHandle(), &dispatcher_);
  };
  leave(collider({id, -1}));
  const auto jointed = articulations_.find(id);
  if (jointed == articulations_.end()) return;
  for (std::size_t link = 0; link < jointed->second->links(); ++link) leave(collider({id, static_cast<int>(link)}));
}

void BulletWorld::move_surface(const WorldPart& part, const SurfaceMotion& motion) {
  SurfaceMotion& known = surface_motions_[part];
  if (known == motion) return;
  known = motion;
  set_surface(part, motion);
  if (const auto body = bodies_.find(part.id); body != bodies_.end()) wake_touching(*body->second.rigid);
}

void BulletWorld::set_surface(const WorldPart& part, const SurfaceMotion& motion) {
  if (const auto body = bodies_.find(part.id); body != bodies_.end()) {
    body->second.shape->move_surface(part.part, motion);
  } else {
    articulations_.at(part.id)->move_surface(part.part, motion);
  }
}

// No articulation sleeps, so bodies that touch one are awake.
void BulletWorld::wake_touching(const btRigidBody& body) {
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
    if (manifold.getNumContacts() == 0 || (manifold.getBody0() != &body && manifold.getBody1() != &body)) continue;
    manifold.getBody0()->activate();
    manifold.getBody1()->activate();
  }
}

void BulletWorld::move(std::size_t id, const glm::dmat4& world_from_body) {
  const auto found = bodies_.find(id);
  if (found != bodies_.end() && found->second.kind == BodyKind::kinematic) {
    // Its speed follows from where it was.
    found->second.rigid->setWorldTransform(to_bullet(world_from_body) * found->second.frame_from_body.inverse());
    return;
  }
  leave_contacts(id);
  wakes_all_ = true;
  if (found == bodies_.end()) return articulations_.at(id)->move(world_from_body);
  Body& body = found->second;
  const btTransform world_from_frame = to_bullet(world_from_body) * body.frame_from_body.inverse();
  body.rigid->setWorldTransform(world_from_frame);
  body.rigid->setInterpolationWorldTransform(world_from_frame);
  world_->updateSingleAabb(body.rigid.get());
  body.rigid->setLinearVelocity({0, 0, 0});
  body.rigid->setAngularVelocity({0, 0, 0});
}

void BulletWorld::drive(std::size_t articulation, std::size_t link, const JointDrive& drive) {
  articulations_.at(articulation)->drive(link, drive);
}

void BulletWorld::place_joint(std::size_t articulation, std::size_t link, double position) {
  leave_contacts(articulation);
  articulations_.at(articulation)->place_joint(link, position);
}

void BulletWorld::place_ball(std::size_t articulation, std::size_t link, const glm::dquat& turn) {
  leave_contacts(articulation);
  articulations_.at(articulation)->place_ball(link, turn);
}

void BulletWorld::wake_all() {
  for (const auto& [id, body] : bodies_) {
    if (body.kind == BodyKind::dynamic) body.rigid->activate(true);
  }
}

// A body that floats slowly touches nothing, and goes on. So does one that touches a moving surface.
void BulletWorld::keep_moving_awake() {
  std::vector<btRigidBody*> tired;
  for (const auto& [id, body] : bodies_) {
    if (body.rigid->getActivationState() == WANTS_DEACTIVATION) tired.push_back(body.rigid.get());
  }
  if (tired.empty()) return;
  std::set<const btCollisionObject*> touching, carried;
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      if (!touches(manifold, manifold.getContactPoint(p))) continue;
      touching.insert({manifold.getBody0(), manifold.getBody1()});
      const std::optional<MovingSurface> surface = moving_surface(manifold.getContactPoint(p));
      if (surface && !surface->slide.isZero()) carried.insert({manifold.getBody0(), manifold.getBody1()});
    }
  }
  for (btRigidBody* const body : tired) {
    if (!touching.contains(body) || carried.contains(body)) body->activate(true);
  }
}

std::size_t BulletWorld::awake() const {
  const auto is_awake = [&](const auto& each) {
    return each.second.kind == BodyKind::dynamic && (wakes_all_ || each.second.rigid->isActive());
  };
  return articulations_.size() + static_cast<std::size_t>(std::ranges::count_if(bodies_, is_awake));
}

// Bullet forgets forces and torques at the end of a step.
void BulletWorld::push(const WorldLink& link, const Wrench& wrench) {
  const btVector3 force = to_bullet(wrench.force_n), torque = to_bullet(wrench.torque_nm);
  if (const auto found = bodies_.find(link.id); found != bodies_.end()) {
    btRigidBody& body = *found->second.rigid;
    if (!body.isActive() && !(force.isZero() && torque.isZero())) body.activate(true);
    body.applyCentralForce(force);
    body.applyTorque(torque);
    return;
  }
  btMultiBody& body = articulations_.at(link.id)->body();
  if (link.link < 0) {
    body.addBaseForce(force);
    body.addBaseTorque(torque);
  } else {
    body.addLinkForce(link.link, force);
    body.addLinkTorque(link.link, torque);
  }
}

std::optional<std::size_t> BulletWorld::step() {
  if (std::exchange(wakes_all_, false)) wake_all();
  wake_constrained();
  for (const auto& [id, articulation] : articulations_) {
    articulation->apply();
    set_link_speeds(articulation->body());
  }
  world_->stepSimulation(desc_.step_s, 0);
  keep_moving_awake();
  find_loads();
  for (const auto& [id, body] : bodies_) {
    if (body.kind == BodyKind::dynamic && !may_go_on(*body.rigid)) return id;
  }
  for (const auto& [id, articulation] : articulations_) {
    if (!articulation->may_go_on()) return id;
  }
  return std::nullopt;
}

// Bullet keeps no friction of contacts with links, so that it counts as load of the joint in front.
void BulletWorld::find_loads() {
  for (const auto& [id, articulation] : articulations_) {
    if (!articulation->measures_loads()) continue;
    std::vector<BulletArticulation::Wrench> contacts(articulation->links());
    const auto add = [&, own = id](const btCollisionObject& object, const btVector3& at, const btVector3& force) {
      const auto [id_of_object, link] = world_link_of(object);
      if (id_of_object != own || link < 0) return;
      BulletArticulation::Wrench& wrench = contacts[static_cast<std::size_t>(link)];
      wrench.force += force;
      wrench.torque += at.cross(force);
    };
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      for (int p = 0; p < manifold.getNumContacts(); ++p) {
        const btManifoldPoint& point = manifold.getContactPoint(p);
        if (!touches(manifold, point)) continue;
        const btVector3 force = point.m_normalWorldOnB * (point.getAppliedImpulse() / desc_.step_s);
        add(*manifold.getBody0(), point.getPositionWorldOnA(), force);
        add(*manifold.getBody1(), point.getPositionWorldOnB(), -force);
      }
    }
    articulation->find_loads(contacts, to_bullet(desc_.gravity_m_s2));
  }
}

BodyState BulletWorld::state(const WorldLink& link) const {
  const auto found = bodies_.find(link.id);
  if (found == bodies_.end()) return articulations_.at(link.id)->state(link.link);
  const Body& body = found->second;
  return {.world_from_body = to_glm(body.rigid->getWorldTransform() * body.frame_from_body),
          .center_m = to_glm(body.rigid->getWorldTransform().getOrigin()),
          .velocity_m_s = to_glm(body.rigid->getLinearVelocity()),
          .angular_velocity_rad_s = to_glm(body.rigid->getAngularVelocity())};
}

JointState BulletWorld::joint(std::size_t articulation, std::size_t link) const {
  return articulations_.at(articulation)->joint(link);
}

glm::dquat BulletWorld::ball(std::size_t articulation, std::size_t link) const {
  return articulations_.at(articulation)->ball(link);
}

void BulletWorld::measure_load(std::size_t articulation, std::size_t link, bool on) {
  articulations_.at(articulation)->measure_load(link, on);
}

LinkLoad BulletWorld::load(std::size_t articulation, std::size_t link) const {
  return articulations_.at(articulation)->load(link);
}

std::vector<WorldContact> BulletWorld::touching() {
  world_->performDiscreteCollisionDetection();
  return contacts();
}

std::vector<WorldContact> BulletWorld::contacts() const {
  std::vector<WorldContact> contacts;
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold =
        *const_cast<btCollisionDispatcher&>(dispatcher_).getManifoldByIndexInternal(i);
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      const btManifoldPoint& point = manifold.getContactPoint(p);
      if (!touches(manifold, point)) continue;
      const btVector3 to_middle = point.m_normalWorldOnB * (point.getDistance() / 2);
      const WorldLink a = world_link_of(*manifold.getBody0()), b = world_link_of(*manifold.getBody1());
      contacts.push_back({.body_a = a.id,
                          .body_b = b.id,
                          .link_a = a.link,
                          .link_b = b.link,
                          .point_m = to_glm(point.getPositionWorldOnB() + to_middle),
                          .normal = to_glm(point.m_normalWorldOnB),
                          .depth_m = -point.getDistance(),
                          .force_n = point.getAppliedImpulse() / desc_.step_s});
    }
  }
  return contacts;
}

}  // namespace simvis
