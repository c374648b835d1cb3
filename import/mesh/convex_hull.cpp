#include "import/mesh/convex_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace simvis {
namespace {

constexpr std::size_t kStepsOfFace = 50;  // that a face costs which is replaced, in distances of points

constexpr double kHullRounding = 1e-10;  // of the size: far above the rounding of doubles, far below that of floats

// Quickhull (Barber, Dobkin, Huhdanpaa, 1996): each face keeps the points that it sees; the farthest one of a face
// replaces all faces that it sees by triangles between their outline and itself.
class Quickhull {
 public:
  Quickhull(std::span<const glm::dvec3> points, std::size_t max_steps) : points_(points), max_steps_(max_steps) {}

  std::optional<std::vector<std::uint32_t>> run() {
    std::vector<std::uint32_t> triangles;
    if (!start()) return triangles;
    while (!open_.empty()) {
      if (steps_ > max_steps_) return std::nullopt;
      const std::size_t face = open_.back();
      open_.pop_back();
      if (faces_[face].is_there && !faces_[face].outside.empty()) extend(face);
    }
    for (const Face& face : faces_) {
      if (face.is_there) triangles.insert(triangles.end(), face.corners.begin(), face.corners.end());
    }
    return triangles;
  }

 private:
  struct Face {
    std::array<std::uint32_t, 3> corners{};
    std::array<std::size_t, 3> neighbours{};  // across the edge from a corner to the next
    glm::dvec3 normal{0};
    double offset = 0;
    std::vector<std::uint32_t> outside{};
    bool is_there = true;
  };

  double distance(const Face& face, std::uint32_t point) const {
    return glm::dot(face.normal, points_[point]) - face.offset;
  }

  Face face_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    Face face{.corners = {a, b, c}};
    const glm::dvec3 across = glm::cross(points_[b] - points_[a], points_[c] - points_[a]);
    const double length = glm::length(across);
    if (length > 0) face.normal = across / length;
    face.offset = glm::dot(face.normal, points_[a]);
    return face;
  }

  // The point for which a measure is largest.
  template <typename Measure>
  std::uint32_t farthest(const Measure& measure) const {
    std::uint32_t best = 0;
    double most = -1;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const double value = measure(points_[i]);
      if (!(value > most)) continue;
      most = value;
      best = i;
    }
    return best;
  }

  // A tetrahedron of points far from each other.
  bool start() {
    if (points_.size() < 4) return false;
    const glm::dvec3 first = points_[0];
    const std::uint32_t a = farthest([&](const glm::dvec3& p) { return glm::length(p - first); });
    const std::uint32_t b = farthest([&](const glm::dvec3& p) { return glm::length(p - points_[a]); });
    const glm::dvec3 along = points_[b] - points_[a];
    tolerance_ = kHullRounding * glm::length(along);
    if (!(tolerance_ > 0)) return false;
    const glm::dvec3 unit = glm::normalize(along);
    const std::uint32_t c =
        farthest([&](const glm::dvec3& p) { return glm::length(glm::cross(p - points_[a], unit)); });
    Face base = face_of(a, b, c);
    const std::uint32_t d =
        farthest([&](const glm::dvec3& p) { return std::abs(glm::dot(base.normal, p) - base.offset); });
    if (!(std::abs(distance(base, d)) > tolerance_)) return false;
    const bool sees = distance(base, d) > 0;
    const std::array<std::uint32_t, 4> v = sees ? std::array{a, c, b, d} : std::array{a, b, c, d};
    faces_ = {face_of(v[0], v[1], v[2]), face_of(v[0], v[3], v[1]), face_of(v[1], v[3], v[2]),
              face_of(v[2], v[3], v[0])};
    faces_[0].neighbours = {1, 2, 3};
    faces_[1].neighbours = {3, 2, 0};
    faces_[2].neighbours = {1, 3, 0};
    faces_[3].neighbours = {2, 1, 0};
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < points_.size(); ++i) all.push_back(i);
    distribute(all, {0, 1, 2, 3});
    return true;
  }

  // Gives points to the first of new faces that sees them; those that no face sees are inside.
  void distribute(const std::vector<std::uint32_t>& points, const std::vector<std::size_t>& faces) {
    for (const std::uint32_t point : points) {
      for (const std::size_t face : faces) {
        ++steps_;
        if (distance(faces_[face], point) <= tolerance_) continue;
        faces_[face].outside.push_back(point);
        break;
      }
    }
    open_.insert(open_.end(), faces.begin(), faces.end());
  }

  struct OutlineEdge {
    std::uint32_t to = 0;
    std::size_t beyond = 0;  // the face on the other side, which stays
  };

  void extend(std::size_t first) {
    std::vector<std::uint32_t>& outside = faces_[first].outside;
    steps_ += outside.size();
    const auto far =
        std::ranges::max_element(outside, {}, [&](std::uint32_t point) { return distance(faces_[first], point); });
    const std::uint32_t apex = *far;
    std::vector<std::size_t> seen{first};
    std::map<std::uint32_t, OutlineEdge> outline;  // by the corner from which an edge runs
    faces_[first].is_there = false;
    bool is_simple = true;
    for (std::size_t next = 0; next < seen.size(); ++next) {
      for (std::size_t edge = 0; edge < 3; ++edge) {
        const std::size_t beyond = faces_[seen[next]].neighbours[edge];
        if (!faces_[beyond].is_there) continue;
        if (distance(faces_[beyond], apex) > tolerance_) {
          faces_[beyond].is_there = false;
          seen.push_back(beyond);
        }
      }
    }
    steps_ += kStepsOfFace * seen.size();
    for (const std::size_t face : seen) {
      for (std::size_t edge = 0; edge < 3; ++edge) {
        const Face& own = faces_[face];
        if (!faces_[own.neighbours[edge]].is_there) continue;
        const OutlineEdge made{own.corners[(edge + 1) % 3], own.neighbours[edge]};
        is_simple = outline.emplace(own.corners[edge], made).second && is_simple;
      }
    }
    if (!is_simple || !replace(seen, outline, apex)) {
      // Rounding has made an outline that touches itself: the point is as good as on the hull.
      for (const std::size_t face : seen) faces_[face].is_there = true;
      std::erase(faces_[first].outside, apex);
      open_.push_back(first);
    }
  }

  // Puts a triangle on each edge of an outline. False, and nothing is done: it is no single ring.
  bool replace(const std::vector<std::size_t>& seen, const std::map<std::uint32_t, OutlineEdge>& outline,
               std::uint32_t apex) {
    std::vector<std::pair<std::uint32_t, OutlineEdge>> ring;
    for (auto edge = outline.begin(); edge != outline.end() && ring.size() < outline.size();
         edge = outline.find(edge->second.to)) {
      ring.emplace_back(edge->first, edge->second);
      if (edge->second.to == ring.front().first) break;
    }
    if (ring.size() != outline.size() || ring.size() < 3 || ring.back().second.to != ring.front().first) return false;
    const std::size_t count = ring.size();
    const std::vector<std::size_t> made = places_for(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [from, edge] = ring[i];
      Face face = face_of(from, edge.to, apex);
      face.neighbours = {edge.beyond, made[(i + 1) % count], made[(i + count - 1) % count]};
      Face& other = faces_[edge.beyond];
      for (std::size_t k = 0; k < 3; ++k) {
        if (other.corners[k] == edge.to && other.corners[(k + 1) % 3] == from) other.neighbours[k] = made[i];
      }
      faces_[made[i]] = std::move(face);
    }
    std::vector<std::uint32_t> points;
    for (const std::size_t face : seen) {
      for (const std::uint32_t point : faces_[face].outside) {
        if (point != apex) points.push_back(point);
      }
      faces_[face].outside = {};
    }
    free_.insert(free_.end(), seen.begin(), seen.end());
    distribute(points, made);
    return true;
  }

  // Faces that were replaced before make room for new ones, so that there are never many more than the hull has.
  std::vector<std::size_t> places_for(std::size_t count) {
    std::vector<std::size_t> places;
    while (places.size() < count) {
      places.push_back(free_.empty() ? faces_.size() : free_.back());
      if (free_.empty()) {
        faces_.emplace_back();
      } else {
        free_.pop_back();
      }
    }
    return places;
  }

  std::span<const glm::dvec3> points_;
  std::size_t max_steps_, steps_ = 0;
  double tolerance_ = 0;
  std::vector<Face> faces_;
  std::vector<std::size_t> open_;  // faces that may see points
  std::vector<std::size_t> free_;  // faces that are not there
};

}  // namespace

std::optional<std::vector<std::uint32_t>> convex_hull(std::span<const glm::dvec3> points, std::size_t max_steps) {
  return Quickhull(points, max_steps).run();
}

}  // namespace simvis
