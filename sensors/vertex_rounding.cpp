#include "sensors/vertex_rounding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace simvis {

namespace {

constexpr double kFloatUnit = 0x1p-24, kDoubleUnit = 0x1p-53;
constexpr double kTransform = 5, kCuts = 3;
// Three matrix products (world, view, clip), four roundings an entry each.
constexpr double kDoubleRoundings = 3 * 4;

// Four bins an octave, from 2^-12 m (0.2 mm) to 2^12 m: exponent and two leading bits of the float.
constexpr auto kShift = 21;
constexpr int kFirst = std::bit_cast<std::int32_t>(0x1p-12f) >> kShift;

constexpr double kSquare = 1e-6;

glm::dvec3 lengths(const glm::dmat3& m) { return {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])}; }

bool is_orthogonal(const glm::dmat3& m) {
  const glm::dvec3 length = lengths(m);
  return std::abs(glm::dot(m[0], m[1])) <= kSquare * length.x * length.y &&
         std::abs(glm::dot(m[1], m[2])) <= kSquare * length.y * length.z &&
         std::abs(glm::dot(m[2], m[0])) <= kSquare * length.z * length.x;
}

// At least the largest factor by which a matrix stretches a vector: exact where its columns are orthogonal.
double stretch(const glm::dmat3& m) {
  const glm::dvec3 length = lengths(m);
  return is_orthogonal(m) ? std::max({length.x, length.y, length.z}) * (1 + 2 * kSquare) : glm::length(length);
}

// At most the distance of a box about `centre` from the origin; its axes are the columns of `m`, half as long as it.
double distance_of_box(const glm::dvec3& centre, const glm::dmat3& m) {
  const glm::dvec3 half = lengths(m);
  const double distance = glm::length(centre), radius = glm::length(half);
  if (!is_orthogonal(m) || half.x == 0 || half.y == 0 || half.z == 0) return distance - radius;
  const glm::dvec3 along(glm::dot(centre, m[0]) / half.x, glm::dot(centre, m[1]) / half.y,
                         glm::dot(centre, m[2]) / half.z);
  const double beyond = glm::length(glm::max(glm::abs(along) - half, glm::dvec3(0)));
  return beyond - 4 * kSquare * (distance + radius);
}

double farthest_corner(const Mesh& mesh) {
  return glm::length(glm::max(glm::abs(glm::dvec3(mesh.bounds_min)), glm::abs(glm::dvec3(mesh.bounds_max))));
}

}  // namespace

int VertexRounding::bin(double range_m) {
  const int index = std::bit_cast<std::int32_t>(static_cast<float>(range_m)) >> kShift;
  return std::clamp(index - kFirst, 0, kBins - 1);
}

const std::array<double, VertexRounding::kBins>& VertexRounding::upper_limits() {
  static const auto limits = [] {
    std::array<double, kBins> values;
    for (int b = 0; b < kBins - 1; ++b) values[b] = std::bit_cast<float>((b + 1 + kFirst) << kShift);
    values[kBins - 1] = std::numeric_limits<double>::infinity();
    return values;
  }();
  return limits;
}

VertexRounding::VertexRounding(const DrawList& list, const glm::dmat4& sensor_from_world) {
  const double* const limits = upper_limits().data();
  double* const displacements = displacement_m_.data();
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const glm::dmat4& world_from_mesh = list.world_from_node[item.transform];
    const double scale = stretch(glm::dmat3(world_from_mesh));
    const double reach = scale * farthest_corner(mesh);
    const double distance = glm::length(glm::dvec3(sensor_from_world * world_from_mesh[3]));
    const double offset = glm::length(glm::dvec3(world_from_mesh[3])) + distance + reach;
    const glm::dvec3 centre = 0.5 * (glm::dvec3(mesh.bounds_min) + glm::dvec3(mesh.bounds_max));
    const glm::dvec3 half = 0.5 * (glm::dvec3(mesh.bounds_max) - glm::dvec3(mesh.bounds_min));
    const glm::dmat3 linear = glm::dmat3(sensor_from_world) * glm::dmat3(world_from_mesh);
    const glm::dvec3 middle(sensor_from_world * (world_from_mesh * glm::dvec4(centre, 1)));
    const double centre_distance = glm::length(middle);
    const double nearest = distance_of_box(middle, {half.x * linear[0], half.y * linear[1], half.z * linear[2]});
    const double radius = scale * glm::length(half);
    const double farthest = centre_distance + radius;
    const double edge = mesh.longest_edge > 0 ? scale * mesh.longest_edge : 2 * radius;
    const int first = bin(std::max(nearest, 0x1p-12) * (1 - 1e-6)), last = bin(farthest * (1 + 1e-6));
    for (int b = first; b <= last; ++b) {
      const double corner = std::min(limits[b] + edge, farthest);  // of a triangle that is seen there
      const double displacement = kFloatUnit * (kTransform * (std::min(reach, corner + distance) + distance) +
                                                kCuts * (2 * edge + corner) + corner) +
                                  kDoubleRoundings * kDoubleUnit * offset;
      displacements[b] = std::max(displacements[b], displacement);
    }
  }
}

double VertexRounding::at(double range_m) const { return displacement_m_[bin(range_m)]; }

}  // namespace simvis
