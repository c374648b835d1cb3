// Flat parts of the surfaces of convex shapes.
#pragma once

#include <btBulletCollisionCommon.h>

#include <array>
#include <vector>

namespace simvis {

/// A face of a convex shape, counter-clockwise seen from outside; two points for the line on which a round shape lies;
/// one point for a shape that touches at points only.
struct ContactFace {
  static constexpr int kMaxPoints = 256;
  std::array<btVector3, kMaxPoints> points;
  int size = 0;
  btVector3 normal;  ///< outward, unit
};

/// A convex hull that has its faces. Its points lie `margin` inside, its faces have the full size.
class HullShape : public btConvexHullShape {
 public:
  struct Face {
    std::vector<btVector3> corners;  ///< counter-clockwise seen from outside
    btVector3 normal;
  };
  explicit HullShape(std::vector<Face> faces) : faces_(std::move(faces)) {}
  const Face& face_towards(const btVector3& direction) const;

 private:
  std::vector<Face> faces_;
};

/// The part of the surface whose outward normal is nearest to a direction of unit length, both in the world. A face
/// with more corners than kMaxPoints is thinned out.
void find_face(const btConvexShape& shape, const btTransform& world_from_shape, const btVector3& direction,
               ContactFace& face);

/// The part of `face` above or below `base`, along base.normal. Both are convex; `base` has at least three points.
void clip_face(const ContactFace& base, ContactFace& face);

}  // namespace simvis
