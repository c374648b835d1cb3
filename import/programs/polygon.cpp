#include "import/programs/polygon.h"

#include <cmath>
#include <cstddef>
#include <numeric>

#include "engine/base/assert.h"

namespace simvis {
namespace {

// Returns Newell's sum: a vector along the normal whose length is twice the area.
glm::dvec3 area_vector(std::span<const glm::vec3> corners) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 start(corners[0]);
    sum += glm::cross(glm::dvec3(corners[i]) - start, glm::dvec3(corners[(i + 1) % corners.size()]) - start);
  }
  return sum;
}

// Projects the polygon along the axis nearest to its normal, so that it runs counter-clockwise.
std::vector<glm::dvec2> flattened(std::span<const glm::vec3> corners) {
  const glm::dvec3 normal = area_vector(corners);
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
  }
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<glm::dvec2> flat;
  for (const glm::vec3& corner : corners) {
    flat.emplace_back(normal[axis] < 0 ? corner[v] : corner[u], normal[axis] < 0 ? corner[u] : corner[v]);
  }
  return flat;
}

// Returns twice the signed area of a triangle, which is positive if the triangle runs counter-clockwise.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

class EarClipper {
 public:
  explicit EarClipper(std::vector<glm::dvec2> points) : points_(std::move(points)), left_(points_.size()) {
    std::iota(left_.begin(), left_.end(), 0u);
  }

  std::vector<std::array<std::uint32_t, 3>> run() {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::size_t at = 0, misses = 0;
    while (left_.size() >= 3) {
      at %= left_.size();
      // Only a degenerate polygon has no ear in a whole round. In that case any corner is cut.
      if (!is_ear(at) && misses++ < left_.size()) {
        ++at;
        continue;
      }
      misses = 0;
      triangles.push_back({before(at), left_[at], after(at)});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    return triangles;
  }

 private:
  std::uint32_t before(std::size_t i) const { return left_[(i + left_.size() - 1) % left_.size()]; }
  std::uint32_t after(std::size_t i) const { return left_[(i + 1) % left_.size()]; }

  // An ear is a corner that turns left and has no other corner in its triangle.
  bool is_ear(std::size_t i) const {
    const glm::dvec2 &a = points_[before(i)], &b = points_[left_[i]], &c = points_[after(i)];
    if (turn(a, b, c) <= 0) return false;
    for (const std::uint32_t other : left_) {
      const glm::dvec2& p = points_[other];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::vector<glm::dvec2> points_;
  std::vector<std::uint32_t> left_;  // the corners that are not cut off yet
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangles_of_polygon(std::span<const glm::vec3> corners) {
  SIMVIS_ASSERT(corners.size() >= 3 && corners.size() <= kMaxPolygonCorners);
  if (corners.size() == 3) return {{0, 1, 2}};
  return EarClipper(flattened(corners)).run();
}

}  // namespace simvis
