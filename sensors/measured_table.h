// The table of a measurement, for formats that have rows: one for each beam of a scan, or for each row of a reading.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <simvis/measurement.h>
#include "engine/base/program_api.h"

namespace simvis {

/// The numbers of one output, in order and without gaps, as messages and pickles have them: count() of held_type().
SIMVIS_PROGRAM_API std::vector<std::uint8_t> own_bytes(const MeasuredArray& array);

struct MeasuredTable {
  std::vector<TableColumn> columns;
  std::vector<double> values;  ///< row by row; NaN: no value

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
};

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
/// Whether the arrays of a measurement from elsewhere are one scan, or one table, besides images: measured_table() and
/// its like rely on it.
SIMVIS_PROGRAM_API bool fits_together(const Measurement& measurement);

/// Before the first measurement the table has no rows. Images are not part of it; without any other array it has no
/// columns.
SIMVIS_PROGRAM_API MeasuredTable measured_table(const Measurement& measurement);

/// The scan of a scanner's measurement; empty if it has no ranges, or if its arrays do not fit together.
SIMVIS_PROGRAM_API std::optional<Scan> to_scan(const Measurement& measurement);

}  // namespace simvis
