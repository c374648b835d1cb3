#include "sensors/laser_scanner/scanner_columns.h"

#include <limits>
#include <utility>

#include <simvis/scan_effect.h>

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

const std::vector<TableColumn>& truth_columns() {
  static const std::vector<TableColumn> columns{
      {.name = kTrueRange,
       .format = "%.17g",
       .unit = "m",
       .meaning = "exact range of the beam without effects",
       .nothing = kNoReturn},
      {.name = kTrueItem, .format = "%.0f", .meaning = "number of the mesh that the beam meets", .nothing = kNoPoint},
      {.name = kTruePrimitive,
       .format = "%.0f",
       .meaning = "number of the triangle of that mesh; of a round shape the face: 0 round, 1 bottom, 2 top",
       .nothing = kNoPoint}};
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
  for (OutputSpec& truth : column_outputs(truth_columns(), OutputKind::scan_column, shape)) {
    const char* const flag = truth.name == kTrueRange ? "range" : "hit";
    truth.message = kPointsMessage;
    truth.when = std::string(flag) + " among truth";
    truth.given = a.is_set("truth") && a.flag("truth", flag);
    outputs.push_back(std::move(truth));
  }
  return outputs;
}

}  // namespace simvis
