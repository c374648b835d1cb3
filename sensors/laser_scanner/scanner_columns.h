// The columns of a laser scanner's table that do not come from its effects.
#pragma once

#include <vector>

#include <simvis/sensor.h>

namespace simvis {

/// Channels of `truth`: what a beam without any effect meets from the pose of the frame, by an exact cast. The range is
/// not limited by range_min and range_max. Item and primitive are those of RayHit; NaN where nothing is met.
inline constexpr const char *kTrueRange = "true_range_m", *kTrueItem = "true_item", *kTruePrimitive = "true_primitive";

/// The angles of the command in degrees.
inline constexpr const char *kAzimuthDeg = "azimuth_deg", *kElevationDeg = "elevation_deg";

/// Those of the attribute `truth`: range, item, primitive.
const std::vector<TableColumn>& truth_columns();

/// Those of every scan, the channels of its effects, and those of truth.
std::vector<OutputSpec> laser_scanner_outputs(const SensorContext& context);

}  // namespace simvis
