#include "elements/dynamics/bullet/bullet_articulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "elements/dynamics/bullet/bullet_types.h"
#include "elements/dynamics/bullet/collision_filter.h"
#include "elements/dynamics/world/mass.h"

namespace simvis {
namespace {

// Bullet cuts joint speeds at this; it lies above what counts as exploded.
constexpr double kCutSpeed = 10 * kMaxSpeed_rad_s;

}  // namespace

BulletFrame bullet_frame(const MassProperties& mass) {
  const PrincipalInertia inertia = principal_inertia(mass.inertia_kg_m2);
  const btTransform body_from_frame(to_bullet(inertia.axes), to_bullet(mass.center_m));
  return {body_from_frame.inverse(), to_bullet(inertia.diagonal_kg_m2)};
}

BulletArticulation::BulletArticulation(const ArticulationDesc& desc, btMultiBodyDynamicsWorld& world, double step_s,
                                       int id)
    : world_(world), step_s_(step_s), fixed_base_(desc.fixed_base), links_(desc.links.size()) {
  const BulletFrame base = bullet_frame(desc.mass);
  base_.frame_from_link = base.frame_from_body;
  body_ = std::make_unique<btMultiBody>(static_cast<int>(desc.links.size()), desc.mass.mass_kg, base.inertia,
                                        desc.fixed_base, false);
  body_->setHasSelfCollision(desc.links_collide);
  body_->setLinearDamping(0);
  body_->setAngularDamping(0);
  body_->setMaxCoordinateVelocity(kCutSpeed);
  body_->setMaxAppliedImpulse(BT_LARGE_FLOAT);
  for (std::size_t i = 0; i < desc.links.size(); ++i) add_link(static_cast<int>(i), desc.links[i]);
  body_->finalizeMultiDof();
  world_.addMultiBody(body_.get());
  body_->setBaseWorldTransform(to_bullet(desc.world_from_base) * base_.frame_from_link.inverse());
  add_collider(-1, desc.shapes, desc.surface, base_, id);
  for (std::size_t i = 0; i < desc.links.size(); ++i) {
    const LinkDesc& link = desc.links[i];
    if (links_[i].moves) body_->setJointPos(static_cast<int>(i), link.position);
    if (links_[i].is_ball) set_ball(i, link.turn);
    add_collider(static_cast<int>(i), link.shapes, link.surface, links_[i], id);
    if ((link.damping > 0 && link.damps_new_speed) || link.rotor_inertia > 0) add_damper(i);
    if (!links_[i].moves || !(std::isfinite(link.lower) || std::isfinite(link.upper))) continue;
    links_[i].limit = std::make_unique<btMultiBodyJointLimitConstraint>(
        body_.get(), static_cast<int>(i), std::max(link.lower, -BT_LARGE_FLOAT), std::min(link.upper, BT_LARGE_FLOAT));
    world_.addMultiBodyConstraint(links_[i].limit.get());
    links_[i].limit->finalizeMultiDof();
  }
  for (const CoupledJoints& joints : desc.coupled) couple(joints);
  place_colliders();
}

void BulletArticulation::add_damper(std::size_t link) {
  Link& own = links_[link];
  const int index = static_cast<int>(link);
  if (own.moves) own.soft = make_soft(link, {.damping = own.damping, .rotor_inertia = own.rotor_inertia});
  if (!own.is_ball) return;
  own.ball_damper = std::make_unique<BulletBallDamper>(*body_, index, own.damping, step_s_);
  world_.addMultiBodyConstraint(own.ball_damper.get());
  own.ball_damper->finalizeMultiDof();
}

// Bullet turns a ball about the axes of its own frame of the link.
void BulletArticulation::set_ball(std::size_t link, const glm::dquat& turn) const {
  const btQuaternion frame = links_[link].frame_from_link.getRotation();
  const btQuaternion own = frame * btQuaternion(turn.x, turn.y, turn.z, turn.w) * frame.inverse();
  const btScalar numbers[] = {own.x(), own.y(), own.z(), own.w()};
  body_->setJointPosMultiDof(static_cast<int>(link), numbers);
}

glm::dquat BulletArticulation::ball(std::size_t link) const {
  if (!links_[link].is_ball) return {1, 0, 0, 0};
  const btScalar* const numbers = body_->getJointPosMultiDof(static_cast<int>(link));
  const btQuaternion frame = links_[link].frame_from_link.getRotation();
  const btQuaternion turn = frame.inverse() * btQuaternion(numbers[0], numbers[1], numbers[2], numbers[3]) * frame;
  return glm::normalize(glm::dquat(turn.w(), turn.x(), turn.y(), turn.z()));
}

// Bullet's gear holds position a + ratio * position b at a target.
void BulletArticulation::couple(const CoupledJoints& joints) {
  const btMatrix3x3 axes = btMatrix3x3::getIdentity();
  auto gear = std::make_unique<btMultiBodyGearConstraint>(body_.get(), static_cast<int>(joints.follower), body_.get(),
                                                          static_cast<int>(joints.leader), btVector3(0, 0, 0),
                                                          btVector3(0, 0, 0), axes, axes);
  constexpr double kCorrection = 0.2;  // the share of a distance that a step takes back, as in Bullet's contacts
  gear->setGearRatio(-joints.multiplier);
  gear->setRelativePositionTarget(joints.offset);
  gear->setErp(kCorrection);
  gear->setMaxAppliedImpulse(BT_LARGE_FLOAT);
  world_.addMultiBodyConstraint(gear.get());
  gear->finalizeMultiDof();
  gears_.push_back(std::move(gear));
}

BulletArticulation::~BulletArticulation() {
  for (const auto& gear : gears_) world_.removeMultiBodyConstraint(gear.get());
  for (Link& link : links_) {
    if (link.motor) world_.removeMultiBodyConstraint(link.motor.get());
    if (link.soft) world_.removeMultiBodyConstraint(link.soft.get());
    if (link.servo) world_.removeMultiBodyConstraint(link.servo.get());
    if (link.ball_damper) world_.removeMultiBodyConstraint(link.ball_damper.get());
    if (link.limit) world_.removeMultiBodyConstraint(link.limit.get());
    if (link.collider) world_.removeCollisionObject(link.collider.get());
  }
  if (base_.collider) world_.removeCollisionObject(base_.collider.get());
  world_.removeMultiBody(body_.get());
}

void BulletArticulation::add_link(int index, const LinkDesc& desc) {
  Link& own = links_[static_cast<std::size_t>(index)];
  const BulletFrame frame = bullet_frame(desc.mass);
  own.frame_from_link = frame.frame_from_body;
  own.is_ball = desc.joint == JointKind::ball;
  own.moves = desc.joint != JointKind::fixed && !own.is_ball;
  own.damping = desc.damping;
  own.stiffness = desc.stiffness;
  own.rest = desc.rest;
  own.rotor_inertia = own.moves ? desc.rotor_inertia : 0;
  const btTransform parent_frame =
      desc.parent < 0 ? base_.frame_from_link : links_[static_cast<std::size_t>(desc.parent)].frame_from_link;
  const btTransform parent_from_link = parent_frame * to_bullet(desc.parent_from_joint);
  const btQuaternion turn = (parent_from_link * own.frame_from_link.inverse()).getRotation().inverse();
  const btVector3 axis = own.frame_from_link.getBasis() * to_bullet(desc.axis);
  const btVector3 pivot = parent_from_link.getOrigin();
  const btVector3 center = -own.frame_from_link.getOrigin();  // from the joint to the centre of mass
  switch (desc.joint) {
    case JointKind::fixed:
      body_->setupFixed(index, desc.mass.mass_kg, frame.inertia, desc.parent, turn, pivot, center);
      break;
    case JointKind::ball:
      body_->setupSpherical(index, desc.mass.mass_kg, frame.inertia, desc.parent, turn, pivot, center, true);
      break;
    case JointKind::revolute:
      body_->setupRevolute(index, desc.mass.mass_kg, frame.inertia, desc.parent, turn, axis, pivot, center, true);
      break;
    case JointKind::prismatic:
      body_->setupPrismatic(index, desc.mass.mass_kg, frame.inertia, desc.parent, turn, axis, pivot, center, true);
      break;
  }
}

void BulletArticulation::add_collider(int link, std::span<const CollisionShape> shapes,
                                      const SurfaceProperties& surface, Link& own, int id) {
  const bool collides = !shapes.empty();
  if (!collides && link < 0 && fixed_base_) return;
  own.shape = std::make_unique<BulletShape>(shapes, surface, own.frame_from_link);
  own.collider = std::make_unique<btMultiBodyLinkCollider>(body_.get(), link);
  own.collider->setCollisionShape(own.shape->get());
  own.collider->setUserIndex(id);
  set_mask(*own.collider, own.shape->mask());
  const bool stands = fixed_base_ && link < 0;
  if (stands) own.collider->setCollisionFlags(own.collider->getCollisionFlags() | btCollisionObject::CF_STATIC_OBJECT);
  int group = btBroadphaseProxy::DefaultFilter, others = btBroadphaseProxy::AllFilter;
  if (stands) {
    group = btBroadphaseProxy::StaticFilter;
    others = btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter;
  }
  // Bullet drives only joints, and holds only links, that have a collider.
  if (!collides) group = others = 0;
  world_.addCollisionObject(own.collider.get(), group, others);
  if (link < 0) {
    body_->setBaseCollider(own.collider.get());
  } else {
    body_->getLink(link).m_collider = own.collider.get();
  }
}

void BulletArticulation::place_links() const {
  btAlignedObjectArray<btQuaternion> rotations;
  btAlignedObjectArray<btVector3> origins;
  body_->forwardKinematics(rotations, origins);
}

void BulletArticulation::place_colliders() {
  btAlignedObjectArray<btQuaternion> rotations;
  btAlignedObjectArray<btVector3> origins;
  body_->forwardKinematics(rotations, origins);
  body_->updateCollisionObjectWorldTransforms(rotations, origins);
  if (base_.collider) world_.updateSingleAabb(base_.collider.get());
  for (const Link& link : links_) {
    if (link.collider) world_.updateSingleAabb(link.collider.get());
  }
}

void BulletArticulation::move(const glm::dmat4& world_from_base) {
  body_->setBaseWorldTransform(to_bullet(world_from_base) * base_.frame_from_link.inverse());
  body_->setBaseVel({0, 0, 0});
  body_->setBaseOmega({0, 0, 0});
  place_colliders();
}

void BulletArticulation::move_surface(int part, const SurfaceMotion& motion) {
  if (base_.shape) base_.shape->move_surface(part, motion);
  for (const Link& link : links_) {
    if (link.shape) link.shape->move_surface(part, motion);
  }
}

void BulletArticulation::place_joint(std::size_t link, double position) {
  if (!links_[link].moves) return;
  body_->setJointPos(static_cast<int>(link), position);
  body_->setJointVel(static_cast<int>(link), 0);
  place_colliders();
}

void BulletArticulation::place_ball(std::size_t link, const glm::dquat& turn) {
  if (!links_[link].is_ball) return;
  set_ball(link, turn);
  const btScalar rest[] = {0, 0, 0};
  body_->setJointVelMultiDof(static_cast<int>(link), rest);
  place_colliders();
}

// A spring turns back by the shortest way.
void BulletArticulation::apply_ball(std::size_t link) const {
  const Link& own = links_[link];
  const int index = static_cast<int>(link);
  const btScalar* const numbers = body_->getJointPosMultiDof(index);
  const btScalar* const speed = body_->getJointVelMultiDof(index);
  btQuaternion turn(numbers[0], numbers[1], numbers[2], numbers[3]);
  if (turn.w() < 0) turn = -turn;
  const btVector3 half(turn.x(), turn.y(), turn.z());  // the axis times the sine of half the angle
  const double sine = half.length(), angle = 2 * std::atan2(sine, turn.w());
  const double damping = own.ball_damper ? 0 : own.damping;
  btScalar torque[3];
  for (int i = 0; i < 3; ++i) {
    torque[i] = (sine > 0 ? -own.stiffness * angle * half[i] / sine : 0) - damping * speed[i];
  }
  body_->addJointTorqueMultiDof(index, torque);
}

bool BulletArticulation::may_go_on() const {
  const auto slow = [](const btVector3& v, double limit) { return v.length2() <= limit * limit; };  // false for NaN
  if (!slow(body_->getBaseVel(), kMaxSpeed_m_s) || !slow(body_->getBaseOmega(), kMaxSpeed_rad_s)) return false;
  if (!std::isfinite(body_->getBasePos().length2()) || !std::isfinite(body_->getWorldToBaseRot().length2()))
    return false;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (links_[i].is_ball) {
      const btScalar* const speed = body_->getJointVelMultiDof(static_cast<int>(i));
      if (!slow({speed[0], speed[1], speed[2]}, kMaxSpeed_rad_s)) return false;
    }
    if (!links_[i].moves) continue;
    const JointState state = joint(i);
    if (!std::isfinite(state.position) || !(std::abs(state.speed) <= kMaxSpeed_rad_s)) return false;
  }
  return true;
}

BodyState BulletArticulation::state(int link) const {
  if (link < 0) {
    return {.world_from_body = to_glm(body_->getBaseWorldTransform() * base_.frame_from_link),
            .center_m = to_glm(body_->getBaseWorldTransform().getOrigin()),
            .velocity_m_s = to_glm(body_->getBaseVel()),
            .angular_velocity_rad_s = to_glm(body_->getBaseOmega())};
  }
  const auto index = static_cast<std::size_t>(link);
  std::vector<btVector3> turn(links_.size() + 1), speed(links_.size() + 1);  // along the axes of each
  body_->compTreeLinkVelocities(turn.data(), speed.data());
  place_links();
  const btTransform& frame = body_->getLink(link).m_cachedWorldTransform;
  return {.world_from_body = to_glm(frame * links_[index].frame_from_link),
          .center_m = to_glm(frame.getOrigin()),
          .velocity_m_s = to_glm(frame.getBasis() * speed[index + 1]),
          .angular_velocity_rad_s = to_glm(frame.getBasis() * turn[index + 1])};
}

JointState BulletArticulation::joint(std::size_t link) const {
  if (!links_[link].moves) return {};
  const int index = static_cast<int>(link);
  return {body_->getJointPos(index), body_->getJointVel(index), drive_effort(link)};
}

void BulletArticulation::measure_load(std::size_t link, bool on) {
  links_[link].measured = on;
  if (!on) links_[link].load = {};
  measures_loads_ = std::ranges::any_of(links_, &Link::measured);
}

std::vector<BulletArticulation::Branch> BulletArticulation::branches() const {
  const std::size_t count = links_.size();
  std::vector<btVector3> turn(count + 1), speed(count + 1);  // of the base and the links, along their own axes
  body_->compTreeLinkVelocities(turn.data(), speed.data());
  place_links();
  std::vector<Branch> branches(count);
  for (std::size_t i = count; i-- > 0;) {
    const int index = static_cast<int>(i);
    const btTransform& world_from_frame = body_->getLink(index).m_cachedWorldTransform;
    const btVector3& place = world_from_frame.getOrigin();
    const double mass = body_->getLinkMass(index);
    const btVector3 momentum = world_from_frame.getBasis() * speed[i + 1] * mass;
    Branch& own = branches[i];
    own.mass += mass;
    own.momentum += momentum;
    own.angular_momentum +=
        place.cross(momentum) + world_from_frame.getBasis() * (body_->getLinkInertia(index) * turn[i + 1]);
    own.moment += mass * place;
    const int parent = body_->getParent(index);
    if (parent < 0) continue;
    Branch& front = branches[static_cast<std::size_t>(parent)];
    front.mass += own.mass;
    front.momentum += own.momentum;
    front.angular_momentum += own.angular_momentum;
    front.moment += own.moment;
  }
  return branches;
}

// Three forces change the momentum of a branch: its weight, its contacts, and that of the joint in front of it. The
// joint's force is what the other two leave over. Bullet's own joint feedback is not used: it lacks the torque of
// drives about the joint's axis and the centrifugal force.
void BulletArticulation::find_loads(std::span<const Wrench> contacts, const btVector3& gravity) {
  const std::vector<Branch> now = branches();
  std::vector<Wrench> on_branch(contacts.begin(), contacts.end());
  for (std::size_t i = links_.size(); i-- > 0;) {
    const int parent = body_->getParent(static_cast<int>(i));
    if (parent >= 0) {
      on_branch[static_cast<std::size_t>(parent)].force += on_branch[i].force;
      on_branch[static_cast<std::size_t>(parent)].torque += on_branch[i].torque;
    }
    Link& link = links_[i];
    if (!link.measured) continue;
    const Branch& before = before_[i];
    const btVector3 force = (now[i].momentum - before.momentum) / step_s_ - before.mass * gravity - on_branch[i].force;
    const btVector3 torque = (now[i].angular_momentum - before.angular_momentum) / step_s_ -
                             before.moment.cross(gravity) - on_branch[i].torque;
    const btVector3 origin =
        body_->getLink(static_cast<int>(i)).m_cachedWorldTransform * link.frame_from_link.getOrigin();
    link.load = {to_glm(origin), to_glm(-force), to_glm(origin.cross(force) - torque)};
  }
}

}  // namespace simvis
