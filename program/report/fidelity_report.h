// What --compare prints and writes.
#pragma once

#include <string>

#include "exchange/fidelity/fidelity.h"

namespace simvis {

/// Tables of the parameters and of the rings with their intervals, and what became of the beams.
std::string to_text(const FidelityReport& report);

/// The same and the curves. Numbers that are not determined are null.
std::string to_json(const FidelityReport& report);

/// The curves as one SVG picture: measured points with their intervals, and the fitted model as a line.
std::string to_svg(const FidelityReport& report);

}  // namespace simvis
