// The voltage of a triangulating distance sensor as a function of range.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace simvis {

struct VoltagePoint {
  double range_m = 0, voltage_v = 0;
};

/// A curve through points. Between them the voltage is linear in 1 / range, as in triangulation: data sheets draw a
/// straight line over 1 / range. Beyond the last point the last segment continues to infinite range, where 1 / range is
/// 0. Nearer than the first point the voltage falls on a straight line to 0 V at 0 m, so a near object reads like a far
/// one: devices behave so, and data sheets draw this fall without numbers.
class VoltageCurve {
 public:
  /// At least two points, with increasing ranges above 0.
  explicit VoltageCurve(std::vector<VoltagePoint> points);

  /// The voltage at `range_m`, which is 0 or more and may be infinite.
  double at(double range_m) const;

 private:
  std::vector<VoltagePoint> points_;
};

/// Parses the name of a device, "gp2y0a21yk", or points "RANGE_M:VOLT RANGE_M:VOLT ...". Empty if the text is neither,
/// or if the points form no curve.
std::optional<VoltageCurve> parse_voltage_curve(std::string_view text);

}  // namespace simvis
