// Output of a price list as text and as CSV.
#pragma once

#include <span>
#include <string>

#include "program/report/price.h"

namespace simvis {

/// An aligned table with one line per variant, in which the recommended variants are marked, and a line of advice with
/// the attributes to write in the scene.
std::string to_table(const ScannerPrice& price);

/// An explanation of the columns of to_table().
std::string price_legend();

/// "FRONT: for 0.001 and 1e-04 write method="planar" resolution="512" (0.41 ms); ...": the result of cheapest_for() for
/// each of kPriceTolerances_rel. If no variant meets a tolerance, the text gives the closest variant and its largest
/// bound.
std::string price_advice(const ScannerPrice& price);

/// A line of column names, then one line per variant; cells without a number are empty.
std::string to_csv(std::span<const ScannerPrice> prices);

}  // namespace simvis
