#include "sensors/event_camera/visible_faces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace simvis {
namespace {

// What is smaller than this share of a pixel is lost in rounding.
constexpr double kNoArea = 1e-15;

// Rounding of a corner, as a share of its distance: two products of matrices (12 u), three products with the place (6),
// and as much again for the plane through three such corners. u = 2^-53.
constexpr double kCornerRounding = 36 * 0x1p-53;
constexpr double kHalf = 0.5;
constexpr std::size_t kFacesPerLeaf = 8;

// A place is inside of a line if dot(line, (x, y, 1)) is at least 0.
double side(const glm::dvec3& line, const glm::dvec2& place) { return line.x * place.x + line.y * place.y + line.z; }

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Returns whether two boxes overlap. Boxes that only touch do not.
bool overlap(const auto& a, const auto& b) {
  return a.low.x < b.high.x && a.low.y < b.high.y && a.high.x > b.low.x && a.high.y > b.low.y;
}

// The line through two corners of a polygon that runs counter-clockwise; inside is to its left.
glm::dvec3 line_through(const glm::dvec2& from, const glm::dvec2& to) {
  const glm::dvec2 way = to - from;
  return {-way.y, way.x, way.y * from.x - way.x * from.y};
}

}  // namespace

void VisibleFaces::begin(const Pinhole& pinhole, double near_m, std::uint32_t column, std::uint32_t row) {
  pinhole_ = pinhole;
  near_m_ = near_m;
  centre_px_ = {column + kHalf - pinhole.cx_px, row + kHalf - pinhole.cy_px};
  points_.clear();
  faces_.clear();
}

glm::dvec3 VisibleFaces::direction(const glm::dvec2& place_px) const {
  return {(place_px.x + centre_px_.x) / pinhole_.fx_px, (place_px.y + centre_px_.y) / pinhole_.fy_px, 1};
}

void VisibleFaces::add(std::uint32_t triangle, const std::array<glm::dvec3, 3>& corners_m, bool both_sides) {
  const glm::dvec3 normal = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
  const double distance = glm::dot(normal, corners_m[0]);  // above 0: its back is seen
  if (distance == 0 || !std::isfinite(distance) || (distance > 0 && !both_sides)) return;
  std::array<glm::dvec3, 4> kept{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &a = corners_m[i], &b = corners_m[(i + 1) % 3];
    if (a.z >= near_m_) kept[count++] = a;
    if ((a.z >= near_m_) != (b.z >= near_m_)) kept[count++] = a + (near_m_ - a.z) / (b.z - a.z) * (b - a);
  }
  if (count < 3) return;
  // Most triangles that come near a pixel lie beside it at any one time.
  bool is_left = true, is_right = true, is_above = true, is_below = true;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = kept[i].z, x = pinhole_.fx_px * kept[i].x - centre_px_.x * z,
                 y = pinhole_.fy_px * kept[i].y - centre_px_.y * z;
    is_left = is_left && x <= -kHalf * z;
    is_right = is_right && x >= kHalf * z;
    is_above = is_above && y <= -kHalf * z;
    is_below = is_below && y >= kHalf * z;
  }
  if (is_left || is_right || is_above || is_below) return;
  Polygon polygon{points_.size(), count};
  for (std::size_t i = 0; i < count; ++i) {
    // Counter-clockwise in x and y, which is clockwise for the eye because y points down.
    const glm::dvec3& corner = kept[distance > 0 ? i : count - 1 - i];
    points_.push_back(glm::dvec2(pinhole_.fx_px * corner.x / corner.z, pinhole_.fy_px * corner.y / corner.z) -
                      centre_px_);
  }
  for (const glm::dvec3& line :
       {glm::dvec3(1, 0, kHalf), glm::dvec3(-1, 0, kHalf), glm::dvec3(0, 1, kHalf), glm::dvec3(0, -1, kHalf)}) {
    polygon = cut(polygon, line);
    if (polygon.count < 3) return;
  }
  if (measure(polygon).area <= kNoArea) return;
  Face face{.triangle = triangle, .polygon = polygon};
  const glm::dvec3 plane = normal / distance;
  const double reach_m = std::max({glm::length(corners_m[0]), glm::length(corners_m[1]), glm::length(corners_m[2])});
  face.inverse_depth = {plane.x / pinhole_.fx_px, plane.y / pinhole_.fy_px, glm::dot(plane, direction({0, 0}))};
  face.nearest = -INFINITY;
  face.farthest = INFINITY;
  face.low = glm::dvec2(INFINITY);
  face.high = glm::dvec2(-INFINITY);
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const glm::dvec2& point = points_[polygon.first + i];
    const double inverse = side(face.inverse_depth, point);
    face.nearest = std::max(face.nearest, inverse);
    face.farthest = std::min(face.farthest, inverse);
    face.low = glm::min(face.low, point);
    face.high = glm::max(face.high, point);
  }
  // A plane m . p = 1 that is displaced by e changes 1 / z by at most |m| e / z.
  face.rounding = glm::length(plane) * kCornerRounding * reach_m * face.nearest;
  faces_.push_back(face);
}

// The part of a polygon inside of a line.
VisibleFaces::Polygon VisibleFaces::cut(const Polygon& polygon, const glm::dvec3& line) {
  return place(polygon, line) == Place::inside ? polygon : kept_part(polygon, 1);
}

// Sets sides_ to the sides of the corners.
VisibleFaces::Place VisibleFaces::place(const Polygon& polygon, const glm::dvec3& line) {
  sides_.resize(polygon.count);
  double least = INFINITY, most = -INFINITY;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    sides_[i] = side(line, points_[polygon.first + i]);
    least = std::min(least, sides_[i]);
    most = std::max(most, sides_[i]);
  }
  if (least >= 0) return Place::inside;
  return most <= 0 ? Place::outside : Place::across;
}

// Returns the part of the polygon of the last place() where sides_ has this sign, as new points.
VisibleFaces::Polygon VisibleFaces::kept_part(const Polygon& polygon, double sign) {
  Polygon kept{points_.size(), 0};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const std::size_t next = i + 1 < polygon.count ? i + 1 : 0;
    const glm::dvec2 a = points_[polygon.first + i], b = points_[polygon.first + next];
    const double at_a = sign * sides_[i], at_b = sign * sides_[next];
    if (at_a >= 0) points_.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) points_.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  kept.count = points_.size() - kept.first;
  return kept;
}

VisibleFaces::Lead VisibleFaces::lead(const Face& face, const Face& other, const Polygon& polygon) const {
  const glm::dvec3 nearer = other.inverse_depth - face.inverse_depth;
  Lead lead{INFINITY, -INFINITY};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const double here = side(nearer, points_[polygon.first + i]);
    lead.least = std::min(lead.least, here);
    lead.most = std::max(lead.most, here);
  }
  return lead;
}

// Whether an edge of `other` has all of a polygon outside, as that of a neighbour in a mesh has.
bool VisibleFaces::is_beside(const Polygon& polygon, const Polygon& other) const {
  for (std::size_t i = 0; i < other.count; ++i) {
    const glm::dvec3 line = line_through(points_[other.first + i], points_[other.first + (i + 1) % other.count]);
    const auto first = points_.begin() + static_cast<std::ptrdiff_t>(polygon.first);
    if (std::all_of(first, first + static_cast<std::ptrdiff_t>(polygon.count),
                    [&](const glm::dvec2& point) { return side(line, point) <= kNoArea; })) {
      return true;
    }
  }
  return false;
}

// Whether `other`, whose bounds overlap those of the face, hides some of it; sets where. Beyond its own corners the
// plane of a narrow triangle is wrong by more than their rounding, so planes that are close are compared where both
// are.
bool VisibleFaces::hides(const Face& face, const Face& other, std::size_t order, std::size_t other_order,
                         Polygon& hidden) {
  const double same = face.rounding + other.rounding;
  if (other.nearest < face.farthest - same) return false;
  hidden = other.polygon;
  Lead ahead = lead(face, other, other.polygon);
  if (ahead.most < -same) return false;
  if (ahead.least > same) return true;
  if (is_beside(face.polygon, other.polygon) || is_beside(other.polygon, face.polygon)) return false;
  Polygon both = face.polygon;
  for (std::size_t i = 0; i < other.polygon.count && both.count >= 3; ++i) {
    const glm::dvec3 line =
        line_through(points_[other.polygon.first + i], points_[other.polygon.first + (i + 1) % other.polygon.count]);
    if (line.x != 0 || line.y != 0) both = cut(both, line);
  }
  if (both.count < 3) return false;
  ahead = lead(face, other, both);
  if (ahead.least >= -same && ahead.most <= same) return order > other_order;
  if (ahead.least >= -same) return true;
  if (ahead.most <= same) return false;
  hidden = cut(both, other.inverse_depth - face.inverse_depth);
  return hidden.count >= 3;
}

void VisibleFaces::subtract(const Polygon& hidden) {
  const Piece bounds = piece_of(hidden);
  if (std::ranges::none_of(pieces_, [&](const Piece& piece) { return overlap(piece, bounds); })) return;
  next_pieces_.clear();
  for (const Piece& whole : pieces_) {
    const std::size_t pieces_before = next_pieces_.size(), points_before = points_.size();
    if (overlap(whole, bounds) && subtract(hidden, whole)) continue;
    next_pieces_.resize(pieces_before);
    points_.resize(points_before);
    next_pieces_.push_back(whole);
  }
  std::swap(pieces_, next_pieces_);
}

// Appends what is left of a piece to next_pieces_. Returns false if nothing of it is hidden: it then stays as it is,
// since lines through all pieces would cut them into ever more.
bool VisibleFaces::subtract(const Polygon& hidden, const Piece& whole) {
  Polygon piece = whole.polygon;
  for (std::size_t i = 0; i < hidden.count; ++i) {
    const glm::dvec3 line = line_through(points_[hidden.first + i], points_[hidden.first + (i + 1) % hidden.count]);
    if (line.x == 0 && line.y == 0) continue;
    const Place at = place(piece, line);
    if (at == Place::outside) return false;
    if (at == Place::inside) continue;
    const Polygon outside = kept_part(piece, -1);
    if (outside.count >= 3 && measure(outside).area > kNoArea) next_pieces_.push_back(piece_of(outside));
    piece = kept_part(piece, 1);
  }
  return piece.count >= 3 && measure(piece).area > kNoArea;
}

VisibleFaces::Piece VisibleFaces::piece_of(const Polygon& polygon) const {
  Piece piece{polygon, glm::dvec2(INFINITY), glm::dvec2(-INFINITY)};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    piece.low = glm::min(piece.low, points_[polygon.first + i]);
    piece.high = glm::max(piece.high, points_[polygon.first + i]);
  }
  return piece;
}

VisibleFaces::Part VisibleFaces::measure(const Polygon& polygon) const {
  Part part;
  const glm::dvec2 origin = points_[polygon.first];
  for (std::size_t i = 1; i + 1 < polygon.count; ++i) {
    const glm::dvec2 a = points_[polygon.first + i] - origin, b = points_[polygon.first + i + 1] - origin;
    const double area = cross(a, b) / 2;
    part.area += area;
    part.moment += area * (origin + (a + b) / 3.0);
  }
  return part;
}

// Appends a tree over the bounds of these faces of in_tree_: nodes come before their children.
void VisibleFaces::add_node(std::size_t first, std::size_t end) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({.low = glm::dvec2(INFINITY), .high = glm::dvec2(-INFINITY), .first = first, .end = end});
  glm::dvec2 least_centre(INFINITY), most_centre(-INFINITY);
  for (std::size_t i = first; i < end; ++i) {
    const Face& face = faces_[in_tree_[i]];
    nodes_[node].low = glm::min(nodes_[node].low, face.low);
    nodes_[node].high = glm::max(nodes_[node].high, face.high);
    least_centre = glm::min(least_centre, face.low + face.high);
    most_centre = glm::max(most_centre, face.low + face.high);
  }
  if (end - first > kFacesPerLeaf) {
    const glm::dvec2 spread = most_centre - least_centre;
    const glm::length_t axis = spread.x > spread.y ? 0 : 1;
    const std::size_t middle = first + (end - first) / 2;
    const auto at = [&](std::size_t i) { return in_tree_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(end), [&](std::size_t a, std::size_t b) {
      return faces_[a].low[axis] + faces_[a].high[axis] < faces_[b].low[axis] + faces_[b].high[axis];
    });
    add_node(first, middle);
    add_node(middle, end);
  }
  nodes_[node].after = nodes_.size();
}

// Those whose bounds overlap, in the order of add(): others hide nothing of the face. A square may hold hundreds of
// thousands of small triangles.
void VisibleFaces::find_neighbours(const Face& face) {
  neighbours_.clear();
  for (std::size_t i = 0; i < nodes_.size();) {
    const Node& node = nodes_[i];
    if (!overlap(node, face)) {
      i = node.after;
      continue;
    }
    ++i;
    if (node.end - node.first > kFacesPerLeaf) continue;
    for (std::size_t k = node.first; k < node.end; ++k) {
      if (overlap(faces_[in_tree_[k]], face)) neighbours_.push_back(in_tree_[k]);
    }
  }
  std::ranges::sort(neighbours_);
}

const std::vector<VisibleFace>& VisibleFaces::find() {
  // What lies behind a face that covers the whole square is hidden.
  double covered = -INFINITY;
  for (const Face& face : faces_) {
    const double surely = face.farthest - face.rounding;
    if (surely > covered && measure(face.polygon).area >= 1 - kNoArea) covered = surely;
  }
  std::erase_if(faces_, [&](const Face& face) { return face.nearest + face.rounding < covered; });
  nodes_.clear();
  in_tree_.resize(faces_.size());
  std::iota(in_tree_.begin(), in_tree_.end(), std::size_t{0});
  add_node(0, faces_.size());
  visible_.clear();
  const std::size_t kept_points = points_.size();
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    points_.resize(kept_points);
    pieces_.assign(1, {faces_[i].polygon, faces_[i].low, faces_[i].high});
    find_neighbours(faces_[i]);
    for (const std::size_t k : neighbours_) {
      Polygon hidden;
      if (k != i && hides(faces_[i], faces_[k], i, k, hidden)) subtract(hidden);
      if (pieces_.empty()) break;
    }
    Part sum;
    for (const Piece& piece : pieces_) {
      const Part part = measure(piece.polygon);
      sum.area += part.area;
      sum.moment += part.moment;
    }
    if (sum.area > kNoArea) visible_.push_back({faces_[i].triangle, sum.area, sum.moment / sum.area});
  }
  return visible_;
}

}  // namespace simvis
