// Which part of a pixel's square each triangle covers, exactly: hidden surfaces are removed by cutting polygons.
//
// Method   Each triangle is cut at the plane z = near and to the square. Its inverse depth 1 / z is affine in the
//          image, so where one triangle hides another is bounded by a straight line, also where the two penetrate each
//          other. From each triangle's polygon the parts are cut away in which another one is nearer. What remains are
//          convex polygons, whose area and centroid have closed forms.
// Rounding areas are wrong by some 2^-50 of a pixel. Faces that are nowhere farther from each other, where both are in
//          the square, than the rounding of their corners coincide: the one that was added first is seen. So it does
//          not depend on which corner a triangle begins with, on its winding or on how a wall is divided.
// Frames   V = view frame: x right, y down, z forward. Places in the square are in pixels from its centre.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

/// The part of the square that shows one triangle.
struct VisibleFace {
  std::uint32_t triangle = 0;  ///< as given to add()
  double area = 0;             ///< share of the square, above 0
  glm::dvec2 centroid_px{0};   ///< of the part
};

class VisibleFaces {
 public:
  /// Starts a square: that of the pixel in `column` and `row` of an image of this pinhole.
  void begin(const Pinhole& pinhole, double near_m, std::uint32_t column, std::uint32_t row);
  /// Adds a triangle, V. Without `both_sides` it is not seen if its corners run clockwise in the image.
  void add(std::uint32_t triangle, const std::array<glm::dvec3, 3>& corners_m, bool both_sides);
  /// What is seen of the triangles.
  const std::vector<VisibleFace>& find();
  /// The direction through a place in the square: V, z = 1.
  glm::dvec3 direction(const glm::dvec2& place_px) const;

 private:
  struct Polygon {
    std::size_t first = 0, count = 0;  // in points_
  };
  struct Face {
    std::uint32_t triangle = 0;
    Polygon polygon;
    glm::dvec3 inverse_depth{0};       // 1 / z = dot(inverse_depth, (x, y, 1))
    double nearest = 0, farthest = 0;  // 1 / z in the polygon
    double rounding = 0;               // of these
    glm::dvec2 low{0}, high{0};        // its bounds
  };
  /// What is left of a face, with its bounds.
  struct Piece {
    Polygon polygon;
    glm::dvec2 low{0}, high{0};
  };
  struct Part {
    double area = 0;
    glm::dvec2 moment{0};
  };
  /// The side of a line on which a polygon lies.
  enum class Place { inside, outside, across };
  Place place(const Polygon& polygon, const glm::dvec3& line);
  Polygon kept_part(const Polygon& polygon, double sign);
  Polygon cut(const Polygon& polygon, const glm::dvec3& line);
  /// How much larger the inverse depth of `other` is than that of the face in the corners of a polygon.
  struct Lead {
    double least = 0, most = 0;
  };
  Lead lead(const Face& face, const Face& other, const Polygon& polygon) const;
  bool is_beside(const Polygon& polygon, const Polygon& other) const;
  bool hides(const Face& face, const Face& other, std::size_t order, std::size_t other_order, Polygon& hidden);
  void subtract(const Polygon& hidden);
  bool subtract(const Polygon& hidden, const Piece& whole);
  /// A node of the tree of the boxes around all faces. Its children follow it.
  struct Node {
    glm::dvec2 low{0}, high{0};
    std::size_t first = 0, end = 0;  // in in_tree_
    std::size_t after = 0;           // the first node that is not below this one
  };
  void add_node(std::size_t first, std::size_t end);
  void find_neighbours(const Face& face);
  Part measure(const Polygon& polygon) const;
  Piece piece_of(const Polygon& polygon) const;

  Pinhole pinhole_;
  double near_m_ = 0;
  glm::dvec2 centre_px_{0};
  std::vector<glm::dvec2> points_;
  std::vector<Face> faces_;
  std::vector<Piece> pieces_, next_pieces_;
  std::vector<VisibleFace> visible_;
  std::vector<double> sides_;  // of the corners of the polygon of the last place()
  std::vector<Node> nodes_;
  std::vector<std::size_t> in_tree_, neighbours_;  // faces: all in the order of the tree, those beside one
};

}  // namespace simvis
