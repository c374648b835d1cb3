#include "sensors/navigation/satellite_signals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <simvis/surface_point.h>
#include "engine/base/even_points.h"

namespace simvis {

namespace {

constexpr std::uint32_t kSurveyRays = 1024;

// Triangles of one wall have vertices in float32: their normals differ by some 1e-7 rad and more if they are small.
constexpr double kSameNormal = 1e-5;

struct Reflection {
  std::size_t signal = 0;
  double extra_path_m = 0;
};

glm::dvec3 mirrored(const glm::dvec3& way, const glm::dvec3& normal) {
  return way - 2 * glm::dot(way, normal) * normal;
}

// The different normals of the surfaces around the antenna that it faces, S. The directions of the rays are fixed in
// the world, so that turns of the receiver do not change which surfaces are found.
std::vector<glm::dvec3> normals_around(RayCaster& rays, const DrawList& list, const glm::dmat4& world_from_sensor) {
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(world_from_sensor));
  std::vector<glm::dvec3> ways;
  for (std::uint32_t i = 0; i < kSurveyRays; ++i) {
    const glm::dvec3 way = glm::normalize(sensor_from_world * even_point_of_ball(i, kSurveyRays));
    if (way.z > 0) ways.push_back(way);
  }
  std::vector<RayHit> hits(ways.size());
  rays.cast(world_from_sensor, ways, hits);
  std::vector<glm::dvec3> normals;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (!std::isfinite(hits[i].range_m)) continue;
    const glm::dvec3 normal = surface_point(list, world_from_sensor, ways[i], hits[i]).normal;
    const auto is_same = [&](const glm::dvec3& known) { return glm::distance(known, normal) <= kSameNormal; };
    if (std::ranges::none_of(normals, is_same)) normals.push_back(normal);
  }
  return normals;
}

}  // namespace

double SatelliteSignal::error_m(double reflection) const {
  if (!direct) return extra_path_m;
  return reflected() ? multipath_error_m(reflection, extra_path_m) : 0;
}

double multipath_error_m(double reflection, double extra_path_m) {
  constexpr double kLightSpeed_mps = 299792458, kChip_m = kLightSpeed_mps / 1.023e6,
                   kWavelength_m = kLightSpeed_mps / 1575.42e6, kSpacing_m = 0.1 * kChip_m;
  const double in_phase = -reflection * std::cos(2 * std::numbers::pi * extra_path_m / kWavelength_m),
               end_m = kChip_m + kSpacing_m / 2;
  if (extra_path_m <= kSpacing_m / 2 * (1 + in_phase)) return in_phase * extra_path_m / (1 + in_phase);
  if (extra_path_m >= end_m) return 0;
  return in_phase * std::min(kSpacing_m / 2, (end_m - extra_path_m) / (2 - in_phase));
}

void SatelliteSignals::plan(const std::string& name, const std::string& sensor, FramePlan& plan) const {
  constexpr std::uint64_t kGpsSatellites = 24;
  const std::uint64_t satellites = desc_.list.empty() ? kGpsSatellites : desc_.list.size();
  plan.casts.push_back({.name = name, .reason = "lines of sight of " + sensor, .max_rays = satellites});
  if (desc_.reflection == 0) return;
  plan.casts.push_back({.name = name,
                        .reason = "signals that walls reflect to " + sensor,
                        .max_rays = kSurveyRays * (1 + 2 * satellites)});
}

std::vector<SatelliteSignal> SatelliteSignals::find(RayCaster& rays, const DrawList& list,
                                                    const glm::dmat4& world_from_sensor, double time_s) const {
  const glm::dvec3 place_m = origin_.to_east_north_up(glm::dvec3(world_from_sensor[3]));
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(world_from_sensor));
  std::vector<SatelliteSignal> signals;
  std::vector<glm::dvec3> ways;  // to the satellites, S
  for (const Satellite& each : satellites_in_sky(desc_, origin_, place_m, time_s)) {
    signals.push_back({.satellite = each});
    ways.push_back(glm::normalize(sensor_from_world * origin_.from_east_north_up(each.direction)));
  }
  find_direct(rays, world_from_sensor, ways, signals);
  if (desc_.reflection > 0) find_reflected(rays, list, world_from_sensor, ways, signals);
  return signals;
}

void SatelliteSignals::find_direct(RayCaster& rays, const glm::dmat4& world_from_sensor,
                                   std::span<const glm::dvec3> ways, std::span<SatelliteSignal> signals) const {
  std::vector<RayHit> hits(ways.size());
  rays.cast(world_from_sensor, ways, hits);
  for (std::size_t i = 0; i < ways.size(); ++i) signals[i].direct = ways[i].z > 0 && std::isinf(hits[i].range_m);
}

void SatelliteSignals::find_reflected(RayCaster& rays, const DrawList& list, const glm::dmat4& world_from_sensor,
                                      std::span<const glm::dvec3> ways, std::span<SatelliteSignal> signals) const {
  std::vector<std::size_t> tried;  // by ray: the signal that it may find
  std::vector<glm::dvec3> to_walls;
  for (const glm::dvec3& normal : normals_around(rays, list, world_from_sensor)) {
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const glm::dvec3 to_wall = glm::normalize(mirrored(ways[i], normal));
      if (glm::dot(ways[i], normal) <= 0 || to_wall.z <= 0) continue;
      tried.push_back(i);
      to_walls.push_back(to_wall);
    }
  }
  std::vector<RayHit> hits(to_walls.size());
  rays.cast(world_from_sensor, to_walls, hits);
  std::vector<Reflection> reflections;
  std::vector<glm::dvec3> origins_m, onward;
  std::vector<double> t_min_m;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (std::isinf(hits[i].range_m)) continue;
    const glm::dvec3 &way = ways[tried[i]], &to_wall = to_walls[i];
    const SurfacePoint wall = surface_point(list, world_from_sensor, to_wall, hits[i]);
    const double cosine = glm::dot(way, wall.normal);
    if (glm::distance(mirrored(to_wall, wall.normal), way) > 4 * kSameNormal || cosine <= 0) continue;
    reflections.push_back({tried[i], wall.range_m * (1 - glm::dot(to_wall, way))});
    origins_m.push_back(wall.range_m * to_wall);
    onward.push_back(way);
    // The wall itself is not hit again: see effects/scanner/onward_ray.h.
    t_min_m.push_back(2 * (5 * wall.error_bound_m + 8 * 0x1p-53 * wall.range_m) / cosine);
  }
  hits.assign(reflections.size(), {});
  rays.cast_from(world_from_sensor, origins_m, onward, hits, t_min_m);
  for (std::size_t i = 0; i < reflections.size(); ++i) {
    double& shortest_m = signals[reflections[i].signal].extra_path_m;
    if (std::isinf(hits[i].range_m)) shortest_m = std::fmin(shortest_m, reflections[i].extra_path_m);
  }
}

}  // namespace simvis
