// The state of a world between two steps. Bullet's results depend on the order of its lists, so they are part of it.
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "elements/dynamics/bullet/bullet_archive.h"
#include "elements/dynamics/bullet/bullet_types.h"
#include "elements/dynamics/bullet/bullet_world.h"
#include "elements/dynamics/bullet/contact_manifolds.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxIds = std::size_t{1} << 31;

void archive_object(StateArchive& state, btCollisionObject& object) {
  btTransform place = object.getWorldTransform(), next_place = object.getInterpolationWorldTransform();
  btVector3 speed = object.getInterpolationLinearVelocity(), turn_rate = object.getInterpolationAngularVelocity();
  int activation = object.getActivationState();
  double still_s = object.getDeactivationTime();
  archive_finite(state, place);
  archive_finite(state, next_place);
  archive_finite(state, speed);
  archive_finite(state, turn_rate);
  state(activation);
  archive_finite(state, still_s);
  state.require(activation >= ACTIVE_TAG && activation <= DISABLE_SIMULATION);
  if (!state.is_reading()) return;
  object.setWorldTransform(place);
  object.setInterpolationWorldTransform(next_place);
  object.setInterpolationLinearVelocity(speed);
  object.setInterpolationAngularVelocity(turn_rate);
  object.forceActivationState(activation);
  object.setDeactivationTime(still_s);
}

// The inertia along the axes of the world follows a body that is put elsewhere one step later.
void archive_rigid(StateArchive& state, btRigidBody& body) {
  btVector3 speed = body.getLinearVelocity(), turn_rate = body.getAngularVelocity();
  archive_finite(state, speed);
  archive_finite(state, turn_rate);
  archive_finite(state, const_cast<btMatrix3x3&>(body.getInvInertiaTensorWorld()));
  if (!state.is_reading()) return;
  body.setLinearVelocity(speed);
  body.setAngularVelocity(turn_rate);
}

void archive_constraint(StateArchive& state, ConstraintDesc& desc, btTransform& world_from_joint) {
  const auto archive_link = [&](WorldLink& link) { state(link.id, link.link); };
  bool has_b = desc.b.has_value();
  state.choice(desc.kind, ConstraintDesc::Kind::fixed);
  archive_link(desc.a);
  state(has_b);
  if (has_b != desc.b.has_value()) desc.b.emplace();
  if (has_b) archive_link(*desc.b);
  state.finite(desc.a_from_joint, desc.b_from_joint);
  state(desc.collide);
  archive_finite(state, world_from_joint);
}

}  // namespace

// Returns the collision objects: bodies by id, then articulations by id, each with its base first.
std::vector<btCollisionObject*> BulletWorld::objects() const {
  std::vector<btCollisionObject*> all;
  for (const auto& [id, body] : bodies_) all.push_back(body.rigid.get());
  for (const auto& [id, articulation] : articulations_) {
    for (int link = -1; link < static_cast<int>(articulation->links()); ++link) {
      if (btCollisionObject* const collider = articulation->collider(link)) all.push_back(collider);
    }
  }
  return all;
}

std::vector<btMultiBodyConstraint*> BulletWorld::all_constraints() const {
  std::vector<btMultiBodyConstraint*> all;
  for (const auto& [id, articulation] : articulations_) {
    const std::vector<btMultiBodyConstraint*> own = articulation->constraints();
    all.insert(all.end(), own.begin(), own.end());
  }
  for (const auto& [id, constraint] : constraints_) all.push_back(constraint.made.get());
  return all;
}

void BulletWorld::archive(StateArchive& state) {
  bool is_jointed = jointed_ != nullptr;
  state(is_jointed, wakes_all_, next_id_, next_constraint_);
  state.require((is_jointed || articulations_.empty()) && next_id_ < kMaxIds);
  for (const std::size_t id : {bodies_.empty() ? 0 : bodies_.rbegin()->first + 1,
                               articulations_.empty() ? 0 : articulations_.rbegin()->first + 1}) {
    state.require(next_id_ >= id);
  }
  if (state.is_reading()) {
    for (const auto& [id, constraint] : constraints_) take_out(constraint);
    constraints_.clear();
    if (is_jointed != (jointed_ != nullptr)) make_world(is_jointed);
    broadphase_.remove_pairs(dispatcher_);
  }
  for (const auto& [id, body] : bodies_) archive_rigid(state, *body.rigid);
  for (const auto& [id, articulation] : articulations_) articulation->archive(state);
  for (btCollisionObject* const object : objects()) archive_object(state, *object);
  archive_surfaces(state);
  archive_constraints(state);
  archive_impulses(state);
  archive_orders(state);
  broadphase_.archive(state, objects());
  archive_contacts(state);
}

// Surfaces that the state does not have stop.
void BulletWorld::archive_surfaces(StateArchive& state) {
  std::map<WorldPart, SurfaceMotion> motions = surface_motions_;
  state(motions);
  if (!state.is_reading()) return;
  for (const auto& [part, motion] : motions) {
    state.require(bodies_.contains(part.id) || articulations_.contains(part.id));
  }
  for (const auto& [part, motion] : surface_motions_) motions.try_emplace(part);
  for (const auto& [part, motion] : motions) set_surface(part, motion);
  surface_motions_ = std::move(motions);
}

void BulletWorld::archive_constraints(StateArchive& state) {
  const auto has = [&](const WorldLink& link) {
    if (bodies_.contains(link.id)) return link.link == -1;
    const auto found = articulations_.find(link.id);
    return found != articulations_.end() && link.link >= -1 && link.link < static_cast<int>(found->second->links());
  };
  const auto moves = [&](const WorldLink& link) {
    const auto body = bodies_.find(link.id);
    if (body != bodies_.end()) return body->second.kind == BodyKind::dynamic;
    return link.link >= 0 || !articulations_.at(link.id)->body().hasFixedBase();
  };
  std::size_t count = constraints_.size();
  state.count(count, 1);
  auto next = constraints_.begin();
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t id = 0;
    ConstraintDesc desc;
    btTransform world_from_joint = btTransform::getIdentity();
    if (!state.is_reading()) {
      id = next->first;
      desc = next->second.desc;
      world_from_joint = next->second.world_from_joint;
      ++next;
    }
    state(id);
    archive_constraint(state, desc, world_from_joint);
    if (!state.is_reading()) continue;
    state.require(jointed_ != nullptr && id < next_constraint_ && !constraints_.contains(id) && has(desc.a));
    state.require(!desc.b || (has(*desc.b) && *desc.b != desc.a));
    state.require(moves(desc.a) || (desc.b && moves(*desc.b)));
    state.require(desc.kind == ConstraintDesc::Kind::fixed || articulations_.contains(desc.a.id));
    make_constraint(id, desc, world_from_joint);
  }
}

void BulletWorld::archive_impulses(StateArchive& state) {
  for (btMultiBodyConstraint* const constraint : all_constraints()) {
    for (int row = 0; row < constraint->getNumRows(); ++row) {
      double impulse = constraint->getAppliedImpulse(row);
      archive_finite(state, impulse);
      constraint->internalSetAppliedImpulse(row, impulse);
    }
  }
}

// Bullet fills the place of an object that is removed with the last one of the list.
void BulletWorld::archive_orders(StateArchive& state) {
  const std::vector<btCollisionObject*> all = objects();
  btCollisionObjectArray& order = world_->getCollisionObjectArray();
  std::vector<std::uint32_t> numbers;
  numbers.reserve(static_cast<std::size_t>(order.size()));
  for (int i = 0; i < order.size(); ++i) numbers.push_back(number_of(all, order[i]));
  const auto archive_order = [&](std::size_t size) {
    state(numbers);
    state.require(numbers.size() == size && is_order(numbers));
  };
  archive_order(all.size());
  for (int i = 0; i < order.size(); ++i) {
    order[i] = all[numbers[static_cast<std::size_t>(i)]];
    order[i]->setWorldArrayIndex(i);
  }
  if (jointed_ == nullptr) return;
  std::vector<btMultiBody*> bodies;
  for (const auto& [id, articulation] : articulations_) bodies.push_back(&articulation->body());
  numbers.clear();
  for (int i = 0; i < jointed_->getNumMultibodies(); ++i)
    numbers.push_back(number_of(bodies, jointed_->getMultiBody(i)));
  archive_order(bodies.size());
  if (state.is_reading()) {
    for (btMultiBody* const body : bodies) jointed_->removeMultiBody(body);
    for (const std::uint32_t number : numbers) jointed_->addMultiBody(bodies[number]);
  }
  const std::vector<btMultiBodyConstraint*> constraints = all_constraints();
  numbers.clear();
  for (int i = 0; i < jointed_->getNumMultiBodyConstraints(); ++i) {
    numbers.push_back(number_of(constraints, jointed_->getMultiBodyConstraint(i)));
  }
  archive_order(constraints.size());
  if (!state.is_reading()) return;
  for (btMultiBodyConstraint* const constraint : constraints) jointed_->removeMultiBodyConstraint(constraint);
  for (const std::uint32_t number : numbers) jointed_->addMultiBodyConstraint(constraints[number]);
}

// The pairs in their order, each with its contacts, and then the order of all manifolds.
void BulletWorld::archive_contacts(StateArchive& state) {
  const std::vector<btCollisionObject*> all = objects();
  btOverlappingPairCache& cache = *broadphase_.getOverlappingPairCache();
  std::size_t count = static_cast<std::size_t>(cache.getNumOverlappingPairs());
  state.count(count, 1);
  std::vector<btPersistentManifold*> manifolds;
  for (std::size_t i = 0; i < count; ++i) {
    btBroadphasePair& pair = archive_pair(state, all, static_cast<int>(i));
    ContactManifolds* const contacts = pair.m_algorithm == nullptr ? nullptr : manifolds_of(*pair.m_algorithm);
    if (contacts == nullptr) continue;
    contacts->archive(state);
    btManifoldArray own;
    contacts->add_to(own);
    for (int k = 0; k < own.size(); ++k) manifolds.push_back(own[k]);
  }
  std::vector<std::uint32_t> places;
  places.reserve(manifolds.size());
  for (const btPersistentManifold* const manifold : manifolds) {
    places.push_back(static_cast<std::uint32_t>(manifold->m_index1a));
  }
  state(places);
  state.require(places.size() == manifolds.size() && is_order(places) &&
                dispatcher_.getNumManifolds() == static_cast<int>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    dispatcher_.getInternalManifoldPointer()[places[i]] = manifolds[i];
    manifolds[i]->m_index1a = static_cast<int>(places[i]);
  }
}

// Makes the pair at this place if it is read, with the algorithm that it had.
btBroadphasePair& BulletWorld::archive_pair(StateArchive& state, std::span<btCollisionObject* const> all, int place) {
  btOverlappingPairCache& cache = *broadphase_.getOverlappingPairCache();
  const auto object = [](const btBroadphaseProxy* proxy) {
    return static_cast<btCollisionObject*>(proxy->m_clientObject);
  };
  std::uint32_t a = 0, b = 0;
  bool has_algorithm = false;
  if (!state.is_reading()) {
    const btBroadphasePair& pair = cache.getOverlappingPairArray()[place];
    a = number_of(all, object(pair.m_pProxy0));
    b = number_of(all, object(pair.m_pProxy1));
    has_algorithm = pair.m_algorithm != nullptr;
  }
  state(a, b, has_algorithm);
  if (!state.is_reading()) return cache.getOverlappingPairArray()[place];
  state.require(a != b && a < all.size() && b < all.size());
  btBroadphasePair* const pair = cache.addOverlappingPair(all[a]->getBroadphaseHandle(), all[b]->getBroadphaseHandle());
  state.require(pair != nullptr && cache.getNumOverlappingPairs() == place + 1);
  if (!has_algorithm) return *pair;
  const auto wrapped = [](const btCollisionObject& each) {
    return btCollisionObjectWrapper(nullptr, each.getCollisionShape(), &each, each.getWorldTransform(), -1, -1);
  };
  const btCollisionObjectWrapper one = wrapped(*object(pair->m_pProxy0)), other = wrapped(*object(pair->m_pProxy1));
  pair->m_algorithm = dispatcher_.findAlgorithm(&one, &other, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  return *pair;
}

}  // namespace simvis
