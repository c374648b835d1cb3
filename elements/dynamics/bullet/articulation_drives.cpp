// The drives of an articulation: by speed, position and effort, and the stiff springs and dampers that act as
// constraints.
#include <algorithm>
#include <cmath>
#include <utility>

#include "elements/dynamics/bullet/bullet_articulation.h"

namespace simvis {
namespace {

// Efforts that follow from the state before a step are unstable from a share of 2 for damping and of 4 for springs; far
// below that they are as good as others.
constexpr double kStiff = 0.5;

// The share of the effort with which a drive by position plans to brake. The rest is for what the plan leaves out:
// other joints that move at the same time.
constexpr double kBrakes = 0.8, kMinBrakes = 0.05;

// The speed at which a joint may be `distance` away from its target: gain * distance where this brakes by less than
// `deceleration`, else the speed from which that one brings it to the first range. Both join smoothly.
double approach_speed(double distance, double gain_per_s, double deceleration) {
  const double linear = deceleration / (gain_per_s * gain_per_s);
  return distance <= linear ? gain_per_s * distance : std::sqrt(2 * deceleration * (distance - linear / 2));
}

bool has_speed(const JointDrive& drive) {
  return drive.kind == JointDrive::Kind::speed || drive.kind == JointDrive::Kind::position;
}

double explicit_effort(const JointDrive& drive, const btMultiBody& body, int link) {
  if (drive.kind == JointDrive::Kind::effort) return drive.target;
  if (drive.kind != JointDrive::Kind::servo) return 0;
  const double effort = drive.stiffness * (drive.target - body.getJointPos(link)) +
                        drive.damping * (drive.target_speed - body.getJointVel(link)) + drive.feed_forward;
  return std::clamp(effort, drive.min_effort.value_or(-drive.max_effort), drive.max_effort);
}

}  // namespace

void BulletArticulation::drive(std::size_t link, const JointDrive& drive) {
  Link& own = links_[link];
  own.drive = drive;
  if (own.moves) drive_servo(link);
  const bool has_motor = has_speed(drive) || drive.friction > 0;
  if (!has_motor && own.motor) {
    world_.removeMultiBodyConstraint(own.motor.get());
    own.motor.reset();
  }
  if (!has_motor) return;
  if (!own.motor) {
    own.motor = std::make_unique<btMultiBodyJointMotor>(body_.get(), static_cast<int>(link), 0, 0);
    world_.addMultiBodyConstraint(own.motor.get());
    own.motor->finalizeMultiDof();
  }
  own.motor->setVelocityTarget(drive.kind == JointDrive::Kind::speed ? drive.target : 0);
  own.motor->setMaxAppliedImpulse((has_speed(drive) ? drive.max_effort : drive.friction) * step_s_);
}

// A motor without a speed to keep is the joint's friction.
double BulletArticulation::drive_effort(std::size_t link) const {
  const Link& own = links_[link];
  if (own.servo) return own.servo->getAppliedImpulse(0) / step_s_;
  if (has_speed(own.drive)) return own.motor->getAppliedImpulse(0) / step_s_;
  return own.drive_effort;
}

// The inertia that a joint moves, or its mass, with its rotor, in the pose of the start, with all other joints free.
double BulletArticulation::inertia(std::size_t link) const {
  const int dof = 6 + body_->getLink(static_cast<int>(link)).m_dofOffset;
  btAlignedObjectArray<btScalar> numbers;
  btAlignedObjectArray<btVector3> vectors;
  btAlignedObjectArray<btMatrix3x3> matrices;
  body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, numbers, vectors, matrices, false, false, false);
  std::vector<btScalar> effort(static_cast<std::size_t>(6 + body_->getNumDofs())), acceleration(effort.size());
  effort[static_cast<std::size_t>(dof)] = 1;
  body_->calcAccelerationDeltasMultiDof(effort.data(), acceleration.data(), numbers, vectors);
  return 1 / acceleration[static_cast<std::size_t>(dof)] + links_[link].rotor_inertia;
}

bool BulletArticulation::is_stiff(std::size_t link, double stiffness, double damping) {
  std::optional<double>& known = links_[link].inertia;
  if (!known) known = inertia(link);
  return step_s_ * (damping + step_s_ * stiffness) > kStiff * *known;
}

std::unique_ptr<BulletSoftJoint> BulletArticulation::make_soft(std::size_t link, const SoftJoint& soft) {
  auto made = std::make_unique<BulletSoftJoint>(*body_, static_cast<int>(link), soft, step_s_);
  world_.addMultiBodyConstraint(made.get());
  made->finalizeMultiDof();
  return made;
}

// Before the first step. What is not stiff keeps its explicit efforts, which lose no energy.
void BulletArticulation::soften_joints() {
  if (std::exchange(are_soft_, true)) return;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    Link& link = links_[i];
    const double damping = link.soft ? 0 : link.damping;
    if (!link.moves || (damping == 0 && link.stiffness == 0) || !is_stiff(i, link.stiffness, damping)) continue;
    soften(i);
  }
}

void BulletArticulation::soften(std::size_t index) {
  Link& link = links_[index];
  const SoftJoint soft{
      .stiffness = link.stiffness, .damping = link.damping, .rotor_inertia = link.rotor_inertia, .rest = link.rest};
  if (link.soft) {
    link.soft->set(soft);
  } else {
    link.soft = make_soft(index, soft);
  }
  link.is_soft_spring = true;
}

// A stiff servo is a soft constraint, others give their effort in apply().
void BulletArticulation::drive_servo(std::size_t link) {
  Link& own = links_[link];
  const JointDrive& drive = own.drive;
  const bool is_servo = drive.kind == JointDrive::Kind::servo && drive.stiffness >= 0 && drive.damping >= 0 &&
                        drive.stiffness + drive.damping > 0;
  if (!is_servo || !(own.servo || is_stiff(link, drive.stiffness, drive.damping))) {
    if (own.servo) world_.removeMultiBodyConstraint(own.servo.get());
    own.servo.reset();
    return;
  }
  // A spring that rests elsewhere, or a damper that rests at another speed, adds the same effort everywhere. The one
  // that is stronger within a step takes it, so that no rest is far away.
  const bool has_spring = step_s_ * drive.stiffness >= drive.damping;
  const SoftJoint soft{.stiffness = drive.stiffness,
                       .damping = drive.damping,
                       .rest = drive.target + (has_spring ? drive.feed_forward / drive.stiffness : 0),
                       .speed = drive.target_speed + (has_spring ? 0 : drive.feed_forward / drive.damping),
                       .min_effort = std::max(drive.min_effort.value_or(-drive.max_effort), -BT_LARGE_FLOAT),
                       .max_effort = std::min(drive.max_effort, BT_LARGE_FLOAT)};
  if (own.servo) {
    own.servo->set(soft);
  } else {
    own.servo = make_soft(link, soft);
  }
}

// Places are relative to the base, so that a robot far from the world's origin loses no digits.
void BulletArticulation::find_carried() {
  carried_.assign(links_.size(), {});
  for (std::size_t i = links_.size(); i-- > 0;) {
    const int index = static_cast<int>(i);
    const btTransform& frame = body_->getLink(index).m_cachedWorldTransform;
    const btVector3 place = frame.getOrigin() - body_->getBaseWorldTransform().getOrigin();
    const double mass = body_->getLinkMass(index);
    const btVector3& moments = body_->getLinkInertia(index);
    Carried& own = carried_[i];
    own.mass += mass;
    own.moment += mass * place;
    const btMatrix3x3& axes = frame.getBasis();
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        double turned = mass * ((a == b ? place.length2() : 0) - place[a] * place[b]);
        for (int c = 0; c < 3; ++c) turned += axes[a][c] * moments[c] * axes[b][c];
        own.inertia[a][b] += turned;
      }
    }
    const int parent = body_->getParent(index);
    if (parent < 0) continue;
    Carried& front = carried_[static_cast<std::size_t>(parent)];
    front.mass += own.mass;
    front.moment += own.moment;
    front.inertia += own.inertia;
  }
}

// Returns the deceleration that a drive can reach on the way to its target, from its effort and the work of gravity.
// All other joints stand.
double BulletArticulation::deceleration(std::size_t link, double way) const {
  const Carried& own = carried_[link];
  const btMultibodyLink& joint = body_->getLink(static_cast<int>(link));
  const btTransform& frame = joint.m_cachedWorldTransform;
  const double effort = links_[link].drive.max_effort;
  const btVector3 gravity = world_.getGravity();
  double inertia = own.mass, weight = 0;  // the work of the weight
  if (joint.m_jointType == btMultibodyLink::ePrismatic) {
    weight = own.mass * gravity.dot(frame.getBasis() * joint.m_axes[0].m_bottomVec) * way;
  } else {
    const btVector3 axis = frame.getBasis() * joint.m_axes[0].m_topVec,
                    pivot =
                        frame * links_[link].frame_from_link.getOrigin() - body_->getBaseWorldTransform().getOrigin(),
                    arm = own.moment - own.mass * pivot;
    inertia = axis.dot(own.inertia * axis) - 2 * (own.moment.dot(pivot) - own.moment.dot(axis) * pivot.dot(axis)) +
              own.mass * (pivot.length2() - pivot.dot(axis) * pivot.dot(axis));
    weight = gravity.dot(arm.rotate(axis, way) - arm);
  }
  return std::max(kBrakes * effort - weight / std::abs(way), kMinBrakes * effort) /
         (inertia + links_[link].rotor_inertia);
}

void BulletArticulation::drive_by_position() {
  bool is_found = false;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    if (link.drive.kind != JointDrive::Kind::position || !link.moves) continue;
    const JointDrive& drive = link.drive;
    const double way = drive.target - body_->getJointPos(static_cast<int>(i));
    double speed = std::min(drive.gain_per_s * std::abs(way), drive.max_speed);
    if (speed > kRestSpeed_rad_s) {
      if (!std::exchange(is_found, true)) find_carried();
      speed = std::min(speed, approach_speed(std::abs(way), drive.gain_per_s, deceleration(i, way)));
    }
    link.motor->setVelocityTarget(drive.target_speed + std::copysign(speed, way));
  }
}

void BulletArticulation::apply() {
  soften_joints();
  drive_by_position();
  if (measures_loads_) before_ = branches();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    Link& link = links_[i];
    const int index = static_cast<int>(i);
    if (link.is_ball) apply_ball(i);
    if (!link.moves) continue;
    if (link.soft) link.soft->begin_step(body_->getJointVel(index));
    link.drive_effort = link.servo ? 0 : explicit_effort(link.drive, *body_, index);
    double effort = link.drive_effort;
    if (link.damping > 0 && !link.soft) effort -= link.damping * body_->getJointVel(index);
    if (link.stiffness > 0 && !link.is_soft_spring) effort -= link.stiffness * (body_->getJointPos(index) - link.rest);
    if (effort != 0) body_->addJointTorque(index, effort);
  }
}

}  // namespace simvis
