// How surfaces emit heat: what elements of the types `temperature` and `thermal_surroundings` set, and what thermal
// cameras see.
#pragma once

#include <memory>

#include <simvis/mesh.h>

namespace simvis {

/// The heat of a surface.
///
/// Units    kelvin. Temperatures are from 0 to kMaxTemperature_k.
struct SurfaceHeat {
  double temperature_k = 293.15;  ///< of the whole surface; with `texture` where the texture is black
  double emissivity = 1;          ///< [0, 1], mean over the band of the camera; 1: a black body
  /// Null, or a picture whose alpha says how far the temperature at a point is from `temperature_k`, 0, to `white_k`,
  /// 1, at the texture coordinates of the surface's material.
  std::shared_ptr<const Texture> texture{};
  double white_k = 293.15;  ///< where the texture is white
};

/// What stands around the scene.
struct ThermalSurroundings {
  double ambient_k = 293.15;  ///< surfaces reflect it; also the temperature of surfaces that no element names
  double sky_k = 293.15;      ///< of a black body that is seen where nothing is hit

  bool operator==(const ThermalSurroundings&) const = default;  ///< member by member
};

/// The highest temperature of a surface, about that of a lamp's filament.
inline constexpr double kMaxTemperature_k = 3000;

}  // namespace simvis
