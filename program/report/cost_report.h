// A list of costs as text, as CSV and as rows.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "program/report/report_table.h"
#include "program/report/scanner_costs.h"

namespace simvis {

struct CostRow {
  const ScannerCosts& costs;
  const VariantCosts& variant;  ///< one of `costs`
};

std::span<const ReportColumn<CostRow>> cost_columns();
/// The rows refer to `all_costs`.
std::vector<CostRow> cost_rows(std::span<const ScannerCosts> all_costs);

/// An aligned table with one line per variant, in which the recommended variants are marked, and a line of advice with
/// the attributes to write in the scene.
std::string to_table(const ScannerCosts& costs);

/// An explanation of the columns of to_table().
std::string cost_legend();

/// "FRONT: for 0.001 and 1e-04 write method="planar" resolution="512" (0.41 ms); ...": the result of cheapest_for() for
/// each of kCostTolerances_rel. If no variant meets a tolerance, the text gives the closest variant and its largest
/// bound.
std::string cost_advice(const ScannerCosts& costs);

/// A line of column names, then one line per variant; cells without a number are empty.
std::string to_csv(std::span<const ScannerCosts> all_costs);

}  // namespace simvis
