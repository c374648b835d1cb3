#include "sensors/laser_scanner/scanner_columns.h"

#include <utility>

#include <simvis/scan_effect.h>
#include "scenegraph/scan_arrays.h"
#include "sensors/laser_scanner/scan_truth.h"
#include "sensors/laser_scanner/scanner_pattern.h"

namespace simvis {
namespace {

// Degrees are those of the command: they do not follow from the radians to the last bit.
OutputSpec angle_output(OutputSpec output, const OutputShape& shape) {
  output.derived = false;
  output.shape = shape;
  return output;
}

// Of a beam table, angles are by ring and beam; channels and origins are arrays if the table has them.
OutputSpec pattern_output(OutputSpec output, const ScannerPattern& pattern) {
  if (output.unit == "deg" || output.unit == "rad") output.shape = pattern.shape;
  const bool runs_on = pattern.beams_of_scan > 0 && pattern.table->rings > 1;
  if (output.name == "ring" && (runs_on || !pattern.table->channel.empty())) {
    output.derived = false;
    output.value_type = ValueType::u32;
  }
  if (output.name == kBeamOrigin) output.given = !pattern.table->origin_m.empty();
  return output;
}

OutputShape grid_shape(const AttributeValues& a) {
  return {static_cast<std::uint32_t>(a.integer("vertical_samples")), static_cast<std::uint32_t>(a.integer("samples"))};
}

}  // namespace

std::vector<OutputSpec> laser_scanner_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  const std::optional<ScannerPattern> pattern =
      a.is_set("pattern") ? scanner_pattern(context) : std::optional<ScannerPattern>();
  const OutputShape shape = pattern ? pattern->shape : grid_shape(a);
  const ScanEffectContext effects{.attributes = a,
                                  .rings = shape.rows,
                                  .beams = shape.columns,
                                  .range_max_m = a.number("range_max"),
                                  .seed = context.seed,
                                  .sensor = context.name};
  std::vector<OutputSpec> outputs = scan_outputs(shape.rows, shape.columns);
  for (OutputSpec& output : outputs) {
    if (output.name == kAzimuthDeg) output = angle_output(std::move(output), {1, shape.columns});
    if (output.name == kElevationDeg) output = angle_output(std::move(output), {shape.rows, 1});
    if (pattern) output = pattern_output(std::move(output), *pattern);
  }
  for (OutputSpec& channel : scan_effect_outputs(effects)) outputs.push_back(std::move(channel));
  for (OutputSpec& truth : scan_truth_outputs(a, shape)) outputs.push_back(std::move(truth));
  return outputs;
}

}  // namespace simvis
