#include "sensors/laser_scanner/scanner_columns.h"

#include <utility>

#include <simvis/scan_effect.h>
#include "sensors/laser_scanner/scan_truth.h"
#include "sensors/measured_table.h"

namespace simvis {
namespace {

// Degrees are those of the command: they do not follow from the radians to the last bit.
OutputSpec angle_output(OutputSpec output, const OutputShape& shape) {
  output.derived = false;
  output.shape = shape;
  return output;
}

}  // namespace

std::vector<OutputSpec> laser_scanner_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  const ScanEffectContext effects{.attributes = a,
                                  .rings = static_cast<std::uint32_t>(a.integer("vertical_samples")),
                                  .beams = static_cast<std::uint32_t>(a.integer("samples")),
                                  .range_max_m = a.number("range_max"),
                                  .seed = context.seed,
                                  .sensor = context.name};
  const OutputShape shape{effects.rings, effects.beams};
  std::vector<OutputSpec> outputs = scan_outputs(effects.rings, effects.beams);
  for (OutputSpec& output : outputs) {
    if (output.name == kAzimuthDeg) output = angle_output(std::move(output), {1, effects.beams});
    if (output.name == kElevationDeg) output = angle_output(std::move(output), {effects.rings, 1});
  }
  for (OutputSpec& channel : scan_effect_outputs(effects)) outputs.push_back(std::move(channel));
  for (OutputSpec& truth : scan_truth_outputs(a, shape)) outputs.push_back(std::move(truth));
  return outputs;
}

}  // namespace simvis
