#include "sensors/psd/voltage_curve.h"

#include <algorithm>
#include <string>

#include <simvis/attributes.h>
#include "engine/base/assert.h"
#include "engine/base/words.h"

namespace simvis {

namespace {

// Sharp GP2Y0A21YK0F, read from the typical curve of its data sheet (white paper): the peak at 6 cm, then the specified
// 10 to 80 cm.
constexpr VoltagePoint kGp2y0a21yk[] = {{0.06, 3.1}, {0.1, 2.3},  {0.15, 1.65}, {0.2, 1.3},  {0.25, 1.08}, {0.3, 0.92},
                                        {0.4, 0.74}, {0.5, 0.60}, {0.6, 0.51},  {0.7, 0.45}, {0.8, 0.40}};

bool is_curve(const std::vector<VoltagePoint>& points) {
  return points.size() >= 2 && points[0].range_m > 0 &&
         std::ranges::is_sorted(points, std::ranges::less_equal(), &VoltagePoint::range_m);
}

}  // namespace

VoltageCurve::VoltageCurve(std::vector<VoltagePoint> points) : points_(std::move(points)) {
  SIMVIS_ASSERT(is_curve(points_));
}

double VoltageCurve::at(double range_m) const {
  const VoltagePoint& first = points_.front();
  if (range_m < first.range_m) return first.voltage_v * (range_m / first.range_m);
  const auto beyond = std::ranges::upper_bound(points_, range_m, {}, &VoltagePoint::range_m);
  const auto far = beyond == points_.end() ? std::prev(beyond) : beyond, near = std::prev(far);
  const double fraction = (1 / range_m - 1 / near->range_m) / (1 / far->range_m - 1 / near->range_m);
  return near->voltage_v + fraction * (far->voltage_v - near->voltage_v);
}

std::optional<VoltageCurve> parse_voltage_curve(std::string_view text) {
  if (text == "gp2y0a21yk") return VoltageCurve({std::begin(kGp2y0a21yk), std::end(kGp2y0a21yk)});
  std::vector<VoltagePoint> points;
  for (const std::string_view word : words_of(text)) {
    const std::size_t colon = std::min(word.find(':'), word.size());
    VoltagePoint point;
    if (!parse_number(word.substr(0, colon), point.range_m)) return std::nullopt;
    if (colon == word.size() || !parse_number(word.substr(colon + 1), point.voltage_v)) return std::nullopt;
    points.push_back(point);
  }
  if (!is_curve(points)) return std::nullopt;
  return VoltageCurve(std::move(points));
}

}  // namespace simvis
