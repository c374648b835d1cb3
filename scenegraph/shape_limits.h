// Limits of all lengths of shapes.
#pragma once

namespace simvis {

inline constexpr double kMinShapeLength_m = 1e-6, kMaxShapeLength_m = 1e6;

}  // namespace simvis
