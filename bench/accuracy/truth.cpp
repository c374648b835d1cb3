#include "bench/accuracy/truth.h"

#include <algorithm>
#include <array>

#include <simvis/pose.h>

namespace simvis::bench {

namespace {

glm::dvec3 direction_of(const glm::dvec2& angles_rad) {
  const double a = angles_rad.x, e = angles_rad.y;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

/// The plane of the triangle that was hit: normal . p = offset, in the sensor frame.
struct Plane {
  glm::dvec3 normal;
  double offset;
};

Plane plane_of(const DrawList& list, const glm::dmat4& world_from_sensor, const RayHit& hit) {
  const DrawItem& item = list.items[hit.item];
  const Mesh& mesh = *list.meshes[item.mesh];
  const glm::dmat4 sensor_from_mesh = rigid_inverse(world_from_sensor) * list.world_from_node[item.transform];
  std::array<glm::dvec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = sensor_from_mesh * glm::dvec4(mesh.positions[mesh.indices[3 * hit.primitive + k]], 1);
  }
  const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  return {normal, glm::dot(normal, corners[0])};
}

}  // namespace

Truth::Truth(const DrawList& list) : list_(list), caster_(make_host_ray_caster()) { caster_->set_world(list); }

TrueScan Truth::look(const glm::dmat4& world_from_sensor, const Scan& pattern) {
  TrueScan scan{.world_from_sensor = world_from_sensor};
  for (const double elevation : pattern.elevation_rad) {
    for (const double azimuth : pattern.azimuth_rad) {
      scan.angles_rad.emplace_back(azimuth, elevation);
      scan.directions.push_back(direction_of(scan.angles_rad.back()));
    }
  }
  scan.hits.resize(scan.directions.size());
  caster_->cast(world_from_sensor, scan.directions, scan.hits);
  return scan;
}

bool Truth::is_narrow(const TrueScan& scan, std::size_t beam, bool lidar, double pixel_rad) {
  constexpr int kSteps = 4, kSide = 3 * kSteps;  // per pixel, and per side of the square
  constexpr double kOnPlane = 1e-9;              // relative: some roundings of double, also on slivers
  const int rows = lidar ? kSide : 0;            // a single ring sees nothing above and below it
  const bool met = std::isfinite(scan.hits[beam].range_m);
  const Plane plane = met ? plane_of(list_, scan.world_from_sensor, scan.hits[beam]) : Plane{};
  std::vector<glm::dvec3> directions;
  for (int y = -rows; y <= rows; ++y) {
    for (int x = -kSide; x <= kSide; ++x) {
      directions.push_back(direction_of(scan.angles_rad[beam] + glm::dvec2(x, y) * (pixel_rad / kSteps)));
    }
  }
  std::vector<RayHit> hits(directions.size());
  caster_->cast(scan.world_from_sensor, directions, hits);
  const auto same = [&](int x, int y) {
    const std::size_t i = static_cast<std::size_t>((y + rows) * (2 * kSide + 1) + x + kSide);
    if (!met) return !std::isfinite(hits[i].range_m);
    const double expected = plane.offset / glm::dot(plane.normal, directions[i]);
    return std::abs(hits[i].range_m - expected) <= kOnPlane * std::abs(expected);
  };
  const auto all_same = [&](int left, int bottom) {
    for (int y = bottom; y <= bottom + rows; ++y) {
      for (int x = left; x <= left + kSide; ++x) {
        if (!same(x, y)) return false;
      }
    }
    return true;
  };
  for (int bottom = -rows; bottom <= 0; ++bottom) {
    for (int left = -kSide; left <= 0; ++left) {
      if (all_same(left, bottom)) return false;
    }
  }
  return true;
}

double quantile(std::vector<float>& values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace simvis::bench
