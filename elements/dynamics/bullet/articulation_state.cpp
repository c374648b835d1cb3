// The state of an articulation between two steps.
#include <algorithm>
#include <iterator>

#include "elements/dynamics/bullet/bullet_archive.h"
#include "elements/dynamics/bullet/bullet_articulation.h"
#include "elements/dynamics/bullet/bullet_types.h"

namespace simvis {
namespace {

void archive_drive_of(StateArchive& state, JointDrive& drive) {
  state.choice(drive.kind, JointDrive::Kind::position);
  state(drive.target, drive.max_effort, drive.min_effort, drive.stiffness, drive.damping, drive.feed_forward,
        drive.target_speed, drive.gain_per_s, drive.max_speed, drive.friction);
}

void archive_base(StateArchive& state, btMultiBody& body) {
  btVector3 place = body.getBasePos(), speed = body.getBaseVel(), turn_rate = body.getBaseOmega();
  btQuaternion turn = body.getWorldToBaseRot();
  for (btVector3* const each : {&place, &speed, &turn_rate}) archive_finite(state, *each);
  archive_finite(state, turn);
  if (!state.is_reading()) return;
  body.setBasePos(place);
  body.setWorldToBaseRot(turn);
  body.setBaseVel(speed);
  body.setBaseOmega(turn_rate);
}

void archive_joint(StateArchive& state, btMultiBody& body, int link) {
  btMultibodyLink& own = body.getLink(link);
  btScalar place[7] = {}, speed[6] = {};
  static_assert(sizeof place == sizeof own.m_jointPos);
  std::copy_n(own.m_jointPos, own.m_posVarCount, place);
  if (own.m_dofCount > 0) std::copy_n(body.getJointVelMultiDof(link), own.m_dofCount, speed);
  for (int i = 0; i < own.m_posVarCount; ++i) archive_finite(state, place[i]);
  for (int i = 0; i < own.m_dofCount; ++i) archive_finite(state, speed[i]);
  if (state.is_reading() && own.m_dofCount > 0) {
    body.setJointPosMultiDof(link, place);
    body.setJointVelMultiDof(link, speed);
  }
  archive_finite(state, own.m_cachedWorldTransform);
}

}  // namespace

std::vector<btMultiBodyConstraint*> BulletArticulation::constraints() const {
  std::vector<btMultiBodyConstraint*> all;
  for (const auto& gear : gears_) all.push_back(gear.get());
  for (const Link& link : links_) {
    for (btMultiBodyConstraint* const each :
         {static_cast<btMultiBodyConstraint*>(link.motor.get()), static_cast<btMultiBodyConstraint*>(link.soft.get()),
          static_cast<btMultiBodyConstraint*>(link.servo.get()),
          static_cast<btMultiBodyConstraint*>(link.ball_damper.get()),
          static_cast<btMultiBodyConstraint*>(link.limit.get())}) {
      if (each != nullptr) all.push_back(each);
    }
  }
  return all;
}

template <typename Constraint>
void BulletArticulation::take_out(std::unique_ptr<Constraint>& constraint) {
  if (constraint) world_.removeMultiBodyConstraint(constraint.get());
  constraint.reset();
}

void BulletArticulation::archive(StateArchive& state) {
  archive_base(state, *body_);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    archive_joint(state, *body_, static_cast<int>(i));
    Link& link = links_[i];
    state(link.measured, link.load.origin_m, link.load.force_n, link.load.torque_nm, link.drive_effort);
    archive_drive(state, i);
  }
  state(are_soft_);
  measures_loads_ = std::ranges::any_of(links_, &Link::measured);
}

// The constraints of a drive come and go: those that are there follow from what they were for.
void BulletArticulation::archive_drive(StateArchive& state, std::size_t index) {
  Link& link = links_[index];
  JointDrive wanted = link.drive;
  std::optional<double> inertia = link.inertia;
  bool has_soft = link.soft != nullptr, is_soft_spring = link.is_soft_spring, has_servo = link.servo != nullptr;
  archive_drive_of(state, wanted);
  state(inertia, has_soft, is_soft_spring, has_servo);
  if (!state.is_reading()) return;
  state.require(link.moves || (!has_soft && !has_servo && wanted.kind == JointDrive::Kind::none));
  state.require(has_soft || !is_soft_spring);
  if (has_soft != (link.soft != nullptr) || is_soft_spring != link.is_soft_spring) {
    take_out(link.soft);
    link.is_soft_spring = false;
    if (is_soft_spring) {
      state.require(link.stiffness > 0 || link.damping > 0 || link.rotor_inertia > 0);
      soften(index);
    } else if (has_soft) {
      state.require(link.damping > 0 || link.rotor_inertia > 0);
      link.soft = make_soft(index, {.damping = link.damping, .rotor_inertia = link.rotor_inertia});
    }
  }
  link.inertia = inertia;
  if (!has_servo) take_out(link.servo);
  if (has_servo && !link.servo) link.servo = make_soft(index, {.stiffness = 1});
  drive(index, wanted);
  if (has_servo != (link.servo != nullptr)) state.require(false);
  link.inertia = inertia;
}

}  // namespace simvis
