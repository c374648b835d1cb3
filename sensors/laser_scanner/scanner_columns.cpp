#include "sensors/laser_scanner/scanner_columns.h"

#include <limits>
#include <utility>

#include <simvis/scan_effect.h>
#include "sensors/laser_scanner/scan_truth.h"

namespace simvis {
namespace {

constexpr double kNoPoint = std::numeric_limits<double>::quiet_NaN(),
                 kNoReturn = std::numeric_limits<double>::infinity();

}  // namespace

const std::vector<TableColumn>& scan_columns() {
  static const std::vector<TableColumn> columns{
      {.name = "ring", .format = "%lld", .integer = true, .meaning = "number of the ring, by increasing elevation"},
      {.name = "beam",
       .format = "%lld",
       .integer = true,
       .meaning = "number of the beam in its ring, by increasing azimuth",
       .in_message = false},
      {.name = "azimuth_deg",
       .format = std::string(kExactFormat),
       .unit = "deg",
       .meaning = "of the beam, counter-clockwise from +x about +z",
       .frame = "sensor",
       .in_message = false},
      {.name = "elevation_deg",
       .format = std::string(kExactFormat),
       .unit = "deg",
       .meaning = "of the beam, positive upwards",
       .frame = "sensor",
       .in_message = false},
      {.name = "range_m",
       .format = "%.9g",
       .unit = "m",
       .meaning = "along the beam; 0: nearer than range_min",
       .nothing = kNoReturn,
       .single = true,
       .in_message = false},
      {.name = "error_bound_m",
       .format = "%.9g",
       .bound_of = "range_m",
       .unit = "m",
       .meaning = "largest error of the range; inf: the method cannot decide which surface the beam meets",
       .nothing = kNoReturn,
       .single = true},
      {.name = "x_m", .format = "%.9g", .unit = "m", .meaning = "point, x", .frame = "sensor", .nothing = kNoPoint},
      {.name = "y_m", .format = "%.9g", .unit = "m", .meaning = "point, y", .frame = "sensor", .nothing = kNoPoint},
      {.name = "z_m", .format = "%.9g", .unit = "m", .meaning = "point, z", .frame = "sensor", .nothing = kNoPoint}};
  return columns;
}

std::vector<OutputSpec> laser_scanner_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  const ScanEffectContext effects{.attributes = a,
                                  .rings = static_cast<std::uint32_t>(a.integer("vertical_samples")),
                                  .beams = static_cast<std::uint32_t>(a.integer("samples")),
                                  .range_max_m = a.number("range_max"),
                                  .seed = context.seed,
                                  .sensor = context.name};
  const OutputShape shape{effects.rings, effects.beams};
  std::vector<OutputSpec> outputs = column_outputs(scan_columns(), OutputKind::scan_column, shape);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (scan_columns()[i].in_message) outputs[i].message = kPointsMessage;
    if (outputs[i].name == "range_m") outputs[i].message = "sensor_msgs/msg/LaserScan";
  }
  for (OutputSpec& channel : scan_effect_outputs(effects)) outputs.push_back(std::move(channel));
  for (OutputSpec& truth : scan_truth_outputs(a, shape)) outputs.push_back(std::move(truth));
  return outputs;
}

}  // namespace simvis
