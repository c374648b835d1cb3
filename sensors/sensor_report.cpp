#include <simvis/sensor_report.h>

#include <algorithm>

namespace simvis {

std::optional<double> SensorInfo::number(std::string_view note) const {
  const auto found = std::ranges::find(report.notes, note, &SensorNote::name);
  const double* const value = found == report.notes.end() ? nullptr : std::get_if<double>(&found->value);
  return value == nullptr ? std::nullopt : std::optional(*value);
}

}  // namespace simvis
