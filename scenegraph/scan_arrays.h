// The arrays of scans: what each is called and holds, and which of them a measurement must have to be a scan.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <simvis/measurement.h>
#include "engine/base/program_api.h"

namespace simvis {

inline constexpr std::string_view kRange = "range_m", kRangeBound = "error_bound_m", kAzimuth = "azimuth_rad",
                                  kElevation = "elevation_rad", kRing = "ring";
/// The angles of beams in degrees, of scanners that have them exactly so.
inline constexpr std::string_view kAzimuthDeg = "azimuth_deg", kElevationDeg = "elevation_deg";

/// The columns of every scan's table: `ring` and `beam`, angles in degrees, range, bound, point. Those that are no
/// array of the measurement are derived from the others. Channels follow behind them.
const std::vector<TableColumn>& scan_columns();

/// The array of this output of a scan, as scan_outputs() lists it, with the type of its numbers.
MeasuredArray scan_array(std::string_view name, const OutputShape& shape, MeasuredNumbers numbers);

/// Whether it says where the beams of a scan start or point, or which rings they belong to, and is no number that was
/// measured.
SIMVIS_PROGRAM_API bool is_beam_layout(const MeasuredArray& array);

/// The rings and beams of a scanner's measurement; empty if it has no ranges, or if its arrays do not fit together.
std::optional<OutputShape> scan_shape(const Measurement& measurement);

}  // namespace simvis
