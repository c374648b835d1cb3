// The table of a measurement, for formats that have rows: one for each beam of a scan, or for each row of a reading.
#pragma once

#include <string_view>
#include <vector>

#include <simvis/measurement.h>
#include "engine/base/program_api.h"

namespace simvis {

struct MeasuredTable {
  std::vector<TableColumn> columns;
  std::vector<double> values;  ///< row by row; NaN: no value

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
};

/// The columns of every scan's table: `ring` and `beam`, angles in degrees, range, bound, point. Those that are no
/// array of the measurement are derived from the others. Channels follow behind them.
const std::vector<TableColumn>& scan_columns();

/// Before the first measurement the table has no rows. Images are not part of it; without any other array it has no
/// columns.
SIMVIS_PROGRAM_API MeasuredTable measured_table(const Measurement& measurement);

}  // namespace simvis
