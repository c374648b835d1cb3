// The table of a measurement, for formats that have rows: one for each beam of a scan, or for each row of a reading.
#pragma once

#include <vector>

#include <simvis/measurement.h>
#include "engine/base/program_api.h"

namespace simvis {

struct MeasuredTable {
  std::vector<TableColumn> columns;
  std::vector<double> values;  ///< row by row; NaN: no value

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
};

/// Whether the arrays of a measurement from elsewhere are one scan, or one table, besides images: measured_table() and
/// its like rely on it.
SIMVIS_PROGRAM_API bool fits_together(const Measurement& measurement);

/// Before the first measurement the table has no rows. Images are not part of it; without any other array it has no
/// columns.
SIMVIS_PROGRAM_API MeasuredTable measured_table(const Measurement& measurement);

}  // namespace simvis
