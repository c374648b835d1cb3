#include "elements/dynamics/bullet/contact_algorithm.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "elements/dynamics/bullet/collision_filter.h"
#include "elements/dynamics/bullet/contact_manifolds.h"
#include "elements/dynamics/bullet/convex_contact.h"
#include "elements/dynamics/world/world.h"

namespace simvis {
namespace {

// Contacts are kept at this distance though nothing moves, of small bodies at this share of their radius.
constexpr double kRestReach_m = 1e-3, kRestReachShare = 0.01;
// Gravity and joints may change the speed by so much within a step.
constexpr double kMaxAcceleration_m_s2 = 20;

double radius_of(const btCollisionObject& object) { return object.getCollisionShape()->getAngularMotionDisc(); }

// How far the points of a body move in a step, seen from its centre.
double turn_in_step(const ObjectMotion& motion, double radius, double step_s) {
  return motion.angular_velocity.isZero() ? 0.0 : motion.angular_velocity.length() * radius * step_s;
}

ContactReach reach_of(const btCollisionObject& a, const btCollisionObject& b, double step_s) {
  const ObjectMotion motion_a = motion_of(a), motion_b = motion_of(b);
  ContactReach reach;
  reach.motion = (motion_a.velocity - motion_b.velocity) * step_s;
  const double radius_a = radius_of(a), radius_b = radius_of(b);
  reach.turn = turn_in_step(motion_a, radius_a, step_s) + turn_in_step(motion_b, radius_b, step_s);
  reach.rest =
      std::min(kRestReach_m, kRestReachShare * std::min(radius_a, radius_b)) + kMaxAcceleration_m_s2 * step_s * step_s;
  return reach;
}

struct Bounds {
  btVector3 low, high;
  bool overlaps(const Bounds& other) const { return TestAabbAgainstAabb2(low, high, other.low, other.high); }
};

Bounds bounds_in(const btTransform& frame_from_shape, const btCollisionShape& shape, double reach) {
  Bounds bounds;
  shape.getAabb(frame_from_shape, bounds.low, bounds.high);
  const btVector3 more(reach, reach, reach);
  bounds.low -= more;
  bounds.high += more;
  return bounds;
}

// A compound, and what collides with nothing, has no surface of its own.
ContactPiece piece_of(const btTransform& world_from_shape, const btCollisionShape& shape) {
  static const BulletSurface kNone;
  const void* const own = shape.getUserPointer();
  return {shape, world_from_shape, own == nullptr ? kNone : *static_cast<const BulletSurface*>(own),
          shape.getUserIndex()};
}

// Calls `visit` for each child of a compound that is near the other piece.
template <typename Visit>
void visit_children(const ContactPiece& whole, const ContactPiece& other, double reach, Visit&& visit) {
  const auto& compound = static_cast<const btCompoundShape&>(whole.shape);
  const Bounds near = bounds_in(whole.world_from_shape.inverse() * other.world_from_shape, other.shape, reach);
  const auto visit_child = [&](int child) {
    visit(piece_of(whole.world_from_shape * compound.getChildTransform(child), *compound.getChildShape(child)));
  };
  struct Collide : btDbvt::ICollide {
    const decltype(visit_child)& visit;
    explicit Collide(const decltype(visit_child)& each) : visit(each) {}
    void Process(const btDbvtNode* leaf) override { visit(leaf->dataAsInt); }
  } collide(visit_child);
  const btDbvt* const tree = compound.getDynamicAabbTree();
  tree->collideTV(tree->m_root, btDbvtVolume::FromMM(near.low, near.high), collide);
}

double friction_between(const SurfaceProperties& a, const SurfaceProperties& b) {
  return a.larger_friction && b.larger_friction ? std::max(a.friction, b.friction) : a.friction * b.friction;
}

// If both surfaces have rollers, those of a count.
void set_surface_motion(const ContactPiece& a, const ContactPiece& b, ContactPoint& contact) {
  const auto in_world = [](const ContactPiece& piece, const btVector3& of_piece) {
    return piece.world_from_shape.getBasis() * of_piece;
  };
  contact.slide =
      -in_world(a, a.surface.belt_m_s).cross(contact.normal) - in_world(b, b.surface.belt_m_s).cross(contact.normal);
  const ContactPiece& rolling = a.surface.roller_axis.isZero() ? b : a;
  contact.roller_axis = in_world(rolling, rolling.surface.roller_axis);
}

// All contacts of two bodies.
class ContactSearch {
 public:
  struct Pair {
    const CollisionFilter& filter;
    std::size_t id_a, id_b;
    bool collide(const ContactPiece& a, const ContactPiece& b) const {
      return a.surface.mask.meets(b.surface.mask) && !filter.are_apart({id_a, a.part}, {id_b, b.part});
    }
  };
  ContactSearch(const Pair& pair, const ContactReach& reach, std::vector<ContactPoint>& contacts)
      : pair_(pair), reach_(reach), contacts_(contacts) {}

  void visit(const ContactPiece& a, const ContactPiece& b) {
    if (a.shape.isCompound()) {
      visit_children(a, b, reach_.length(), [&](const ContactPiece& child) { visit(child, b); });
    } else if (b.shape.isCompound()) {
      visit_children(b, a, reach_.length(), [&](const ContactPiece& child) { visit(a, child); });
    } else if (pair_.collide(a, b)) {
      visit_pieces(a, b);
    }
  }

 private:
  void visit_pieces(const ContactPiece& a, const ContactPiece& b) {
    if (b.shape.isConvex() && !a.shape.isConvex()) {
      visit_swapped(a, b);
    } else if (a.shape.isConvex()) {
      visit_convex(a, b);
    }
  }

  void visit_swapped(const ContactPiece& a, const ContactPiece& b) {
    ContactReach reach = reach_;
    reach.motion = -reach.motion;
    const std::size_t first = contacts_.size();
    ContactSearch(pair_, reach, contacts_).visit_convex(b, a);
    for (std::size_t i = first; i < contacts_.size(); ++i) {
      std::swap(contacts_[i].on_a, contacts_[i].on_b);
      contacts_[i].normal = -contacts_[i].normal;
      contacts_[i].slide = -contacts_[i].slide;
    }
  }

  void visit_convex(const ContactPiece& convex, const ContactPiece& other) {
    const std::size_t first = contacts_.size();
    if (other.shape.isConvex()) {
      add_convex_contacts(convex, other, reach_, std::nullopt, contacts_);
    } else if (other.shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
      add_plane_contacts(convex, other, reach_, contacts_);
    } else if (other.shape.getShapeType() == TRIANGLE_MESH_SHAPE_PROXYTYPE) {
      visit_mesh(convex, other);
    }
    const bool moves = convex.surface.moves() || other.surface.moves();
    for (std::size_t i = first; i < contacts_.size(); ++i) {
      if (moves) set_surface_motion(convex, other, contacts_[i]);
      contacts_[i].friction = friction_between(convex.surface, other.surface);
      contacts_[i].restitution = convex.surface.restitution * other.surface.restitution;
    }
  }

  void visit_mesh(const ContactPiece& convex, const ContactPiece& other) {
    struct EachTriangle : btTriangleCallback {
      const ContactPiece &convex, &other;
      const ContactReach& reach;
      std::vector<ContactPoint>& contacts;
      Bounds near;
      EachTriangle(const ContactPiece& a, const ContactPiece& b, const ContactReach& within,
                   std::vector<ContactPoint>& found)
          : convex(a), other(b), reach(within), contacts(found) {}
      void processTriangle(btVector3* corners, int, int index) override {
        Bounds bounds{corners[0], corners[0]};
        for (const int i : {1, 2}) {
          bounds.low.setMin(corners[i]);
          bounds.high.setMax(corners[i]);
        }
        if (!near.overlaps(bounds)) return;
        btTriangleShape triangle(corners[0], corners[1], corners[2]);
        triangle.setMargin(0);
        add_convex_contacts(convex, {triangle, other.world_from_shape, other.surface, other.part}, reach,
                            MeshTriangle{static_cast<const MeshShape&>(other.shape), index}, contacts);
      }
    } each(convex, other, reach_, contacts_);
    each.near = bounds_in(other.world_from_shape.inverse() * convex.world_from_shape, convex.shape, reach_.length());
    static_cast<const MeshShape&>(other.shape).processAllTriangles(&each, each.near.low, each.near.high);
  }

  const Pair& pair_;
  const ContactReach& reach_;
  std::vector<ContactPoint>& contacts_;
};

class ContactAlgorithm : public btCollisionAlgorithm {
 public:
  ContactAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const CollisionFilter& filter,
                   const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b)
      : btCollisionAlgorithm(info),
        filter_(filter),
        manifolds_(*info.m_dispatcher1, *a.getCollisionObject(), *b.getCollisionObject()) {}

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult*) override {
    const ContactReach reach = reach_of(*a->getCollisionObject(), *b->getCollisionObject(), info.m_timeStep);
    thread_local std::vector<ContactPoint> contacts;
    contacts.clear();
    const WorldLink link_a = world_link_of(*a->getCollisionObject()), link_b = world_link_of(*b->getCollisionObject());
    if (!filter_.are_held(link_a, link_b)) {
      ContactSearch({filter_, link_a.id, link_b.id}, reach, contacts)
          .visit(piece_of(a->getWorldTransform(), *a->getCollisionShape()),
                 piece_of(b->getWorldTransform(), *b->getCollisionShape()));
    }
    manifolds_.replace(contacts);
  }
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override { manifolds_.add_to(manifolds); }

 private:
  const CollisionFilter& filter_;
  ContactManifolds manifolds_;
};

struct CreateContactAlgorithm : btCollisionAlgorithmCreateFunc {
  explicit CreateContactAlgorithm(const CollisionFilter& own) : filter(own) {}
  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    return new (info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(ContactAlgorithm)))
        ContactAlgorithm(info, filter, *a, *b);
  }
  const CollisionFilter& filter;
};

}  // namespace

ObjectMotion motion_of(const btCollisionObject& object) {
  if (object.isStaticObject()) return {{0, 0, 0}, {0, 0, 0}};
  if (const btRigidBody* const body = btRigidBody::upcast(&object)) {
    return {body->getLinearVelocity(), body->getAngularVelocity()};
  }
  return {object.getInterpolationLinearVelocity(), object.getInterpolationAngularVelocity()};
}

double way_in_step(const btCollisionObject& object, double step_s) {
  const ObjectMotion motion = motion_of(object);
  return motion.velocity.length() * step_s + turn_in_step(motion, radius_of(object), step_s);
}

void set_link_speeds(btMultiBody& body) {
  const auto links = static_cast<std::size_t>(body.getNumLinks());
  thread_local std::vector<btVector3> turn, speed;
  turn.resize(links + 1);
  speed.resize(links + 1);
  body.compTreeLinkVelocities(turn.data(), speed.data());
  const auto set = [&](btMultiBodyLinkCollider* collider, std::size_t index) {
    if (collider == nullptr) return;
    const btMatrix3x3& world_from_link = collider->getWorldTransform().getBasis();
    collider->setInterpolationLinearVelocity(world_from_link * speed[index]);
    collider->setInterpolationAngularVelocity(world_from_link * turn[index]);
  };
  set(body.getBaseCollider(), 0);
  for (int i = 0; i < body.getNumLinks(); ++i) set(body.getLink(i).m_collider, static_cast<std::size_t>(i) + 1);
}

ContactConfiguration::ContactConfiguration(const CollisionFilter& filter)
    : btDefaultCollisionConfiguration([] {
        btDefaultCollisionConstructionInfo info;
        info.m_customCollisionAlgorithmMaxElementSize = sizeof(ContactAlgorithm);
        return info;
      }()),
      create_(std::make_unique<CreateContactAlgorithm>(filter)) {}

ContactConfiguration::~ContactConfiguration() = default;

btCollisionAlgorithmCreateFunc* ContactConfiguration::getCollisionAlgorithmCreateFunc(int shape_a, int shape_b) {
  if (shape_a == EMPTY_SHAPE_PROXYTYPE || shape_b == EMPTY_SHAPE_PROXYTYPE) {
    return btDefaultCollisionConfiguration::getCollisionAlgorithmCreateFunc(shape_a, shape_b);
  }
  return create_.get();
}

}  // namespace simvis
