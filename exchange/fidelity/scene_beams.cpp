#include "exchange/fidelity/scene_beams.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include <simvis/surface_point.h>
#include "effects/scanner/reflectance.h"

namespace simvis {
namespace {

constexpr double kMinCosine = 0.1;
// A surface is a plane as far as a beam is concerned if it leaves the plane by less than this, or by less than this
// share of how far the plane moves there.
constexpr double kPlane_m = 0.002, kPlaneShare = 0.2;
const double kRetroCosine = std::cos(glm::radians(40.0));

double reflectance_of(const SurfacePoint& surface, double cosine) {
  if (surface.material->retro_reflectance > 0 && cosine >= kRetroCosine)
    return std::numeric_limits<double>::quiet_NaN();
  return reflectance(surface);
}

}  // namespace

glm::dvec3 by_azimuth(const glm::dvec3& direction) { return {-direction.y, direction.x, 0}; }

glm::dvec3 by_elevation(const glm::dvec3& direction) {
  const double across = std::hypot(direction.x, direction.y);
  if (across == 0) return {-1, 0, 0};
  return {-direction.z * direction.x / across, -direction.z * direction.y / across, across};
}

SceneBeams::SceneBeams(const ComparedScanner& scanner, std::span<const RecordedBeam> beams)
    : scanner_(scanner), recorded_(beams), caster_(make_host_ray_caster()), beams_(beams.size()), hits_(beams.size()) {
  caster_->set_world(*scanner_.list);
  caster_->ignore(scanner_.unseen);
}

void SceneBeams::cast_rays(std::span<const glm::dvec3> origins_m, std::span<const glm::dvec3> directions) {
  caster_->cast_from(scanner_.scan->world_from_sensor, origins_m, directions, hits_);
}

void SceneBeams::cast(const BeamCorrections& corrections) {
  const glm::dmat3 turn = glm::dmat3(glm::rotate(glm::dmat4(1), corrections.pitch_rad, glm::dvec3(0, 1, 0)) *
                                     glm::rotate(glm::dmat4(1), corrections.roll_rad, glm::dvec3(1, 0, 0)));
  std::vector<glm::dvec3> origins_m(recorded_.size()), directions(recorded_.size());
  for (std::size_t i = 0; i < recorded_.size(); ++i) {
    const RecordedBeam& beam = recorded_[i];
    const RingCorrection ring = beam.ring < corrections.rings.size() ? corrections.rings[beam.ring] : RingCorrection{};
    directions[i] = turn * beam_direction(beam.azimuth_rad + ring.azimuth_rad, beam.elevation_rad + ring.elevation_rad);
    origins_m[i] = corrections.position_m + turn * beam.origin_m;
  }
  cast_rays(origins_m, directions);
  for (std::size_t i = 0; i < recorded_.size(); ++i) {
    SceneBeam& beam = beams_[i];
    const BeamUse use = beam.use;
    beam = {.range_m = hits_[i].range_m, .direction = directions[i], .use = decided_ ? use : BeamUse::outside};
    if (!std::isfinite(beam.range_m)) {
      beam.use = BeamUse::outside;
      continue;
    }
    const SurfacePoint surface = surface_point(
        *scanner_.list, glm::translate(scanner_.scan->world_from_sensor, origins_m[i]), directions[i], hits_[i]);
    beam.normal = surface.normal;
    beam.cosine = -glm::dot(surface.normal, directions[i]);
    beam.point_m = origins_m[i] + beam.range_m * directions[i];
    beam.reflectance = reflectance_of(surface, beam.cosine);
    if (decided_) continue;
    if (beam.range_m < scanner_.range_min_m || beam.range_m > scanner_.range_max_m) continue;
    beam.use = beam.cosine < kMinCosine ? BeamUse::grazing : BeamUse::fitted;
  }
  if (!decided_) find_edges(origins_m);
  decided_ = true;
}

void SceneBeams::find_edges(std::span<const glm::dvec3> origins_m) {
  std::vector<glm::dvec3> directions(beams_.size());
  for (const auto& [azimuth, elevation] :
       {std::pair(1.0, 0.0), std::pair(-1.0, 0.0), std::pair(0.0, 1.0), std::pair(0.0, -1.0)}) {
    const auto step = [&, a = azimuth, e = elevation](const SceneBeam& beam) {
      return kEdge_rad * (a * by_azimuth(beam.direction) + e * by_elevation(beam.direction));
    };
    for (std::size_t i = 0; i < beams_.size(); ++i)
      directions[i] = glm::normalize(beams_[i].direction + step(beams_[i]));
    cast_rays(origins_m, directions);
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      SceneBeam& beam = beams_[i];
      if (beam.use != BeamUse::fitted) continue;
      const double plane_m = beam.range_m * beam.cosine / -glm::dot(beam.normal, directions[i]);
      const double allowed_m = kPlane_m + kPlaneShare * std::abs(plane_m - beam.range_m);
      if (!(std::abs(hits_[i].range_m - plane_m) <= allowed_m)) beam.use = BeamUse::at_edge;
    }
  }
}

}  // namespace simvis
