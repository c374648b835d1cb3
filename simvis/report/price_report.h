// A price list for people, and for programs.
#pragma once

#include <span>
#include <string>

#include "simvis/report/price.h"

namespace simvis {

/// An aligned table of one line per variant, with the variants to take marked, and a line of advice: what to write in
/// the scene.
std::string to_table(const ScannerPrice& price);

/// How to read the columns of to_table().
std::string price_legend();

/// "FRONT: for 0.001 and 1e-04 write method="planar" resolution="512" (0.41 ms); ...": for each of kPriceTolerances_rel
/// what cheapest_for() says; where that is nothing, the largest bound that there is.
std::string price_advice(const ScannerPrice& price);

/// One line per variant after a line of names; cells without a number are empty.
std::string to_csv(std::span<const ScannerPrice> prices);

}  // namespace simvis
