// The voltage that a triangulating distance sensor gives over range.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace simvis {

struct VoltagePoint {
  double range_m = 0, voltage_v = 0;
};

/// A curve through points. Between them the voltage is linear in 1 / range, as it is for triangulation: datasheets draw
/// a straight line over 1 / range. Beyond the last point the last piece goes on, to infinity, where 1 / range is 0.
/// Nearer than the first point it falls on a straight line to 0 V at 0 m, so that a near thing reads like a far one:
/// devices do so, and datasheets draw the fall but give no numbers for it.
class VoltageCurve {
 public:
  /// Two points or more, ranges above 0 and increasing.
  explicit VoltageCurve(std::vector<VoltagePoint> points);

  /// `range_m` is 0 or more, or infinite.
  double at(double range_m) const;

 private:
  std::vector<VoltagePoint> points_;
};

/// The name of a device, "gp2y0a21yk", or points as "RANGE_M:VOLT RANGE_M:VOLT ...". Nothing where it is neither, or
/// the points are no curve.
std::optional<VoltageCurve> parse_voltage_curve(std::string_view text);

}  // namespace simvis
