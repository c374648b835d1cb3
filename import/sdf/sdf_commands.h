// Turns lights and sensors of SDF into commands.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include <simvis/command.h>
#include "import/model/import_report.h"
#include "import/sdf/sdf_element.h"

namespace simvis {

/// Where a command stands and what it is called. `insert_at` is empty for the part itself.
struct SdfPlace {
  std::string name, insert_at;
};

class SdfMessages;

/// The element `light` of a <light>, `point_from_light` from its pose. Colours are read as sRGB. A directional light of
/// intensity I gives pi * I lux, so that a white surface that faces it shows I. A point or spot light falls off with
/// the square of the distance; where SDF's light is kSdfLightDistance_m away, or half its range if that is less, both
/// are equal. Angles of spot lights are full angles in SDF.
/// Throws InputError for wrong numbers and an unknown type.
std::string sdf_light_command(const SdfElement& light, const SdfPlace& place, const glm::dmat4& point_from_light,
                              ImportReport& report);
inline constexpr double kSdfLightDistance_m = 3;

/// The element `sky` of a world's <scene>: its background, read as sRGB, and its ambient light A, whose radiance is
/// A / pi as in gz-sim, as far as they are there. Empty: it has neither.
std::optional<std::string> sdf_sky_command(const SdfElement& scene, const SdfPlace& place, ImportReport& report);

/// The sensor of a <sensor>, which looks along +x as ours do: a camera, depth, RGBD, segmentation or bounding box
/// camera is a `camera`, a thermal one a `thermal_camera`; a ray, lidar, gpu_ray or gpu_lidar is a `laser_scanner`;
/// others are those of sdf_readings.h, for which `world` is (none: the defaults of SDF). <gazebo> blocks of URDF have
/// the same element. `messages` are those of the file. Empty: a sensor of another type, which is reported as left out.
/// What of its noise and lens has no counterpart is reported. Throws InputError for wrong numbers.
std::optional<std::string> sdf_sensor_command(const SdfElement& sensor, const SdfElement& world, const SdfPlace& place,
                                              const glm::dmat4& point_from_sensor, SdfMessages& messages,
                                              ImportReport& report);

}  // namespace simvis
