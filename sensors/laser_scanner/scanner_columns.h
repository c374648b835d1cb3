// The columns of a laser scanner's table that do not come from its effects.
#pragma once

#include <vector>

#include <simvis/scan.h>

namespace simvis {

/// Those of every scan, in the order in which LaserScanner::write() fills them.
const std::vector<TableColumn>& scan_columns();

/// Those of the attribute `truth`: range, item, primitive.
const std::vector<TableColumn>& truth_columns();

}  // namespace simvis
