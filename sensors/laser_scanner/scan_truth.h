// Channels of the attribute `truth`: what a beam without any effect meets from the pose of the frame, by an exact cast.
// The range is not limited by range_min and range_max.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/scan.h>
#include <simvis/sensor.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

inline constexpr const char *kTrueRange = "true_range_m", *kTrueItem = "true_item", *kTruePrimitive = "true_primitive",
                            *kTrueInstance = "true_instance", *kTrueSemantic = "true_semantic",
                            *kTrueShape = "true_shape", *kTrueRadialSpeed = "true_radial_speed_mps";

/// The channels that are asked for, by words of the attribute.
struct ScanTruthDesc {
  bool range = false,
       hit = false,          ///< item and primitive of RayHit
      instance = false,      ///< ids, see ItemIds
      semantic = false,      ///< ids, see ItemIds
      shape = false,         ///< ids, see ItemIds
      normal = false,        ///< of the triangle: sensor frame, unit length, towards the sensor
      velocity = false,      ///< of the matter of the item: world frame, m/s, the mean since the last measurement
      radial_speed = false;  ///< along the beam, against the beam's start, m/s, the mean since the last measurement

  bool any() const { return range || hit || instance || semantic || shape || normal || looks_back(); }
  bool looks_back() const { return velocity || radial_speed; }
  bool needs_ids() const { return instance || semantic || shape; }
  static AttributeRows<ScanTruthDesc> rows();
};

/// The outputs of all channels. Every value but the range is NaN where nothing is met.
std::vector<OutputSpec> scan_truth_outputs(const AttributeValues& attributes, const OutputShape& shape);

/// What the beams have met.
struct MetSurfaces {
  const DrawList& list;
  const SensedWorld* world;  ///< null if neither ids nor velocities are asked for
  glm::dmat4 world_from_sensor{1.0};
  std::span<const std::uint32_t> order;    ///< beams, in the order of what follows
  std::span<const glm::dvec3> origins_m;   ///< sensor frame; empty: all beams start at its origin
  std::span<const glm::dvec3> directions;  ///< sensor frame
  std::span<const RayHit> hits;
};

/// Appends the channels that are asked for.
void add_truth(const ScanTruthDesc& desc, const MetSurfaces& met, Scan& scan);

}  // namespace simvis
