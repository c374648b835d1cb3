// The recorded beams as the scene has them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include <simvis/ray_caster.h>
#include "exchange/fidelity/compared_scanner.h"
#include "exchange/packets/beam_recording.h"

namespace simvis {

/// Corrections of the angles of a ring.
struct RingCorrection {
  double azimuth_rad = 0, elevation_rad = 0;
};

/// What corrects where recorded beams start and point.
struct BeamCorrections {
  glm::dvec3 position_m{0};            ///< of the sensor, in its frame in the scene
  double roll_rad = 0, pitch_rad = 0;  ///< about x and y of that frame
  std::vector<RingCorrection> rings{};
};

enum class BeamUse : std::uint8_t { fitted, at_edge, grazing, outside };

/// A beam as the scene has it. Frame: the sensor's in the scene.
struct SceneBeam {
  double range_m = 0;      ///< to the surface
  double cosine = 0;       ///< of the angle of incidence
  double reflectance = 0;  ///< NaN: the surface is a retro-reflector there
  glm::dvec3 normal{0}, direction{1, 0, 0}, point_m{0};
  BeamUse use = BeamUse::outside;
};

/// Beams within this angle of an edge are left out. At an edge the surface leaves the plane that the beam meets.
inline constexpr double kEdge_rad = 0.25 * 0.017453292519943295;

class SceneBeams {
 public:
  /// Both must live as long as the object. `beams` stand ring by ring.
  SceneBeams(const ComparedScanner& scanner, std::span<const RecordedBeam> beams);

  /// Casts all beams again, with these corrections. What each beam is used for is decided by the first call.
  void cast(const BeamCorrections& corrections);

  const SceneBeam& operator[](std::size_t i) const { return beams_[i]; }
  std::size_t size() const { return beams_.size(); }

 private:
  void cast_rays(std::span<const glm::dvec3> origins_m, std::span<const glm::dvec3> directions);
  void find_edges(std::span<const glm::dvec3> origins_m);

  ComparedScanner scanner_;
  std::span<const RecordedBeam> recorded_;
  std::unique_ptr<RayCaster> caster_;
  std::vector<SceneBeam> beams_;
  std::vector<RayHit> hits_;
  bool decided_ = false;
};

/// The derivatives of a unit direction by its azimuth and by its elevation, per radian. The length of the first is the
/// cosine of the elevation.
glm::dvec3 by_azimuth(const glm::dvec3& direction);
glm::dvec3 by_elevation(const glm::dvec3& direction);

}  // namespace simvis
