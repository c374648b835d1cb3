#include "elements/dynamics/bullet/contact_manifolds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elements/dynamics/bullet/bullet_archive.h"

namespace simvis {
namespace {

constexpr double kSamePoint_m = 1e-7, kSameNormal = 0.9999;  // of neighbouring triangles, at their common edge
constexpr double kOneManifold = 0.995;                       // normals within 6 degrees share one
constexpr double kSameContact_m = 0.02;                      // a contact moves less in a step

using ContactGroup = std::vector<const ContactPoint*>;

bool is_one_group(const ContactPoint& a, const ContactPoint& b) {
  return a.normal.dot(b.normal) > kOneManifold && a.friction == b.friction && a.restitution == b.restitution &&
         a.slide == b.slide && a.roller_axis == b.roller_axis;
}

bool is_same(const ContactPoint& a, const ContactPoint& b) {
  return (a.on_b - b.on_b).length2() < kSamePoint_m * kSamePoint_m && a.normal.dot(b.normal) > kSameNormal;
}

void add_to_group(const ContactPoint& contact, ContactGroup& group) {
  for (const ContactPoint*& other : group) {
    if (!is_same(*other, contact)) continue;
    if (contact.distance < other->distance) other = &contact;
    return;
  }
  group.push_back(&contact);
}

std::vector<ContactGroup> groups_of(std::span<const ContactPoint> contacts) {
  std::vector<ContactGroup> groups;
  for (const ContactPoint& contact : contacts) {
    auto group =
        std::ranges::find_if(groups, [&](const ContactGroup& each) { return is_one_group(*each.front(), contact); });
    if (group == groups.end()) group = groups.emplace(groups.end());
    add_to_group(contact, *group);
  }
  return groups;
}

// The first of the contacts with the most of a measure; rounding does not choose among equal ones.
template <typename Measure>
const ContactPoint* most_of(const ContactGroup& group, double least, Measure&& measure) {
  constexpr double kMore = 1 + 1e-9;
  const ContactPoint* most = nullptr;
  for (const ContactPoint* const contact : group) {
    const double value = measure(*contact);
    if (value <= least * kMore) continue;
    least = value;
    most = contact;
  }
  return most;
}

// Returns the contact that touches first among this one and those near it. A contact behind the first, such as one of
// another piece of the same body, touches only after the first has sunk deep.
const ContactPoint* first_to_touch(const ContactGroup& group, const ContactPoint& contact) {
  constexpr double kSooner_m = 1e-6;
  const ContactPoint* first = &contact;
  double least = contact.distance - kSooner_m;
  for (const ContactPoint* const each : group) {
    if (each->distance >= least) continue;
    const btVector3 way = each->on_b - contact.on_b;
    const double aside = (way - contact.normal.dot(way) * contact.normal).length();
    if (each->distance + aside >= least) continue;
    least = each->distance + aside;
    first = each;
  }
  return first;
}

// The deepest, the one farthest from it, and those farthest to both sides of the line between them.
ContactGroup most_important(const ContactGroup& group) {
  constexpr std::size_t kMaxPoints = 4;  // of a manifold
  if (group.size() <= kMaxPoints) return group;
  constexpr double kEqualDepth_m = 1e-6, kOnLine_m2 = 1e-12;
  const double deepest = (*std::ranges::min_element(group, {}, &ContactPoint::distance))->distance;
  const ContactPoint* const first =
      *std::ranges::find_if(group, [&](const ContactPoint* each) { return each->distance <= deepest + kEqualDepth_m; });
  ContactGroup kept = {first};
  const ContactPoint* const second =
      most_of(group, 0, [&](const ContactPoint& each) { return (each.on_b - first->on_b).length2(); });
  if (second == nullptr) return kept;
  kept.push_back(second);
  const btVector3 side = first->normal.cross(second->on_b - first->on_b);
  for (const double sign : {1.0, -1.0}) {
    const auto aside = [&](const ContactPoint& each) { return sign * side.dot(each.on_b - first->on_b); };
    if (const ContactPoint* const outer = most_of(group, kOnLine_m2, aside)) kept.push_back(outer);
  }
  for (const ContactPoint*& each : kept) each = first_to_touch(group, *each);
  std::ranges::sort(kept);
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

// Flags of a point that Bullet does not know: its m_contactMotion, which Bullet then does not read, is that of the
// surface along the two directions of btPlaneSpace1(), and its m_frictionCFM the angle of the rollers' axis from the
// first one.
constexpr int kMoves = 1 << 16, kRolls = 1 << 17;

void set_moving_surface(const ContactPoint& contact, btManifoldPoint& point) {
  constexpr double kAcrossSurface = 1e-6;  // of a unit axis; rollers that stand on the surface hold nothing
  btVector3 x, y;
  btPlaneSpace1(contact.normal, x, y);
  point.m_contactMotion1 = contact.slide.dot(x);
  point.m_contactMotion2 = contact.slide.dot(y);
  point.m_contactPointFlags |= kMoves;
  const double along_x = contact.roller_axis.dot(x), along_y = contact.roller_axis.dot(y);
  if (std::hypot(along_x, along_y) <= kAcrossSurface) return;
  point.m_frictionCFM = std::atan2(along_y, along_x);
  point.m_contactPointFlags |= kRolls;
}

void take_over_impulse(const btManifoldPoint& from, btManifoldPoint& to) {
  to.m_appliedImpulse = from.m_appliedImpulse;
  to.m_appliedImpulseLateral1 = from.m_appliedImpulseLateral1;
  to.m_appliedImpulseLateral2 = from.m_appliedImpulseLateral2;
  to.m_lateralFrictionDir1 = from.m_lateralFrictionDir1;
  to.m_lateralFrictionDir2 = from.m_lateralFrictionDir2;
  to.m_prevRHS = from.m_prevRHS;
  to.m_lifeTime = from.m_lifeTime + 1;
}

// Each old contact gives its impulse away once.
void take_over_impulses(std::vector<btManifoldPoint>& old, btPersistentManifold& manifold) {
  for (int i = 0; i < manifold.getNumContacts() && !old.empty(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    const auto distance = [&](const btManifoldPoint& each) {
      return (each.m_localPointA - point.m_localPointA).length2();
    };
    const auto nearest = std::ranges::min_element(old, {}, distance);
    if (distance(*nearest) > kSameContact_m * kSameContact_m) continue;
    take_over_impulse(*nearest, point);
    old.erase(nearest);
  }
}

// The default constructor of Bullet leaves numbers unset that its solver reads.
const btManifoldPoint kNoPoint(btVector3(0, 0, 0), btVector3(0, 0, 0), btVector3(0, 0, 1), 0);

// What the next step reads of a contact: it makes contacts anew and takes over their impulses.
void archive_point(StateArchive& state, btManifoldPoint& point) {
  for (btVector3* const each :
       {&point.m_localPointA, &point.m_localPointB, &point.m_positionWorldOnA, &point.m_positionWorldOnB,
        &point.m_normalWorldOnB, &point.m_lateralFrictionDir1, &point.m_lateralFrictionDir2}) {
    archive_finite(state, *each);
  }
  for (double* const each :
       {&point.m_distance1, &point.m_combinedFriction, &point.m_combinedRestitution, &point.m_appliedImpulse,
        &point.m_appliedImpulseLateral1, &point.m_appliedImpulseLateral2, &point.m_prevRHS, &point.m_contactERP,
        &point.m_contactMotion1, &point.m_contactMotion2, &point.m_frictionCFM}) {
    archive_finite(state, *each);
  }
  state(point.m_contactPointFlags, point.m_lifeTime);
}

}  // namespace

std::optional<MovingSurface> moving_surface(const btManifoldPoint& point) {
  if ((point.m_contactPointFlags & kMoves) == 0) return std::nullopt;
  btVector3 x, y;
  btPlaneSpace1(point.m_normalWorldOnB, x, y);
  MovingSurface surface{.slide = point.m_contactMotion1 * x + point.m_contactMotion2 * y};
  if ((point.m_contactPointFlags & kRolls) != 0) {
    const double angle = point.m_frictionCFM;
    surface.roller_axis = std::cos(angle) * x + std::sin(angle) * y;
  }
  return surface;
}

ContactManifolds::~ContactManifolds() {
  for (btPersistentManifold* const manifold : manifolds_) dispatcher_.releaseManifold(manifold);
}

void ContactManifolds::add_to(btManifoldArray& manifolds) const {
  for (btPersistentManifold* const manifold : manifolds_) manifolds.push_back(manifold);
}

void ContactManifolds::add(std::size_t manifold, const ContactPoint& contact) {
  btManifoldPoint point(a_.getWorldTransform().invXform(contact.on_a), b_.getWorldTransform().invXform(contact.on_b),
                        contact.normal, contact.distance);
  point.m_positionWorldOnA = contact.on_a;
  point.m_positionWorldOnB = contact.on_b;
  point.m_combinedFriction = contact.friction;
  point.m_combinedRestitution = contact.restitution;
  if (!contact.slide.isZero() || !contact.roller_axis.isZero()) set_moving_surface(contact, point);
  manifolds_[manifold]->addManifoldPoint(point);
}

void ContactManifolds::replace(std::span<const ContactPoint> contacts) {
  std::vector<btManifoldPoint> old;
  for (btPersistentManifold* const manifold : manifolds_) {
    for (int i = 0; i < manifold->getNumContacts(); ++i) old.push_back(manifold->getContactPoint(i));
    manifold->clearManifold();
  }
  const std::vector<ContactGroup> groups = groups_of(contacts);
  while (manifolds_.size() < groups.size()) manifolds_.push_back(dispatcher_.getNewManifold(&a_, &b_));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const ContactPoint* const contact : most_important(groups[g])) add(g, *contact);
    take_over_impulses(old, *manifolds_[g]);
  }
}

void ContactManifolds::archive(StateArchive& state) {
  std::vector<std::vector<btManifoldPoint>> all;
  for (const btPersistentManifold* const manifold : manifolds_) {
    std::vector<btManifoldPoint>& points = all.emplace_back();
    for (int i = 0; i < manifold->getNumContacts(); ++i) points.push_back(manifold->getContactPoint(i));
  }
  std::size_t count = all.size();
  state.count(count, sizeof(std::uint64_t));
  all.resize(count);
  for (std::vector<btManifoldPoint>& points : all) {
    std::size_t size = points.size();
    state.count(size, 1);
    state.require(size <= MANIFOLD_CACHE_SIZE);
    points.resize(size, kNoPoint);
    for (btManifoldPoint& point : points) archive_point(state, point);
  }
  if (!state.is_reading()) return;
  while (manifolds_.size() < all.size()) manifolds_.push_back(dispatcher_.getNewManifold(&a_, &b_));
  for (std::size_t i = 0; i < manifolds_.size(); ++i) {
    manifolds_[i]->clearManifold();
    for (const btManifoldPoint& point : all[i]) manifolds_[i]->addManifoldPoint(point);
  }
}

}  // namespace simvis
