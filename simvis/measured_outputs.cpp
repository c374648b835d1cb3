#include "simvis/measured_outputs.h"

#include <algorithm>
#include <utility>

namespace simvis {
namespace {

/// Collects the arrays of one sensor.
class Outputs {
 public:
  explicit Outputs(const BuiltSensor& sensor) : specs_(sensor.outputs) {}

  void add(std::string name, OutputKind kind, const OutputShape& shape,
           std::variant<const float*, const double*> numbers, std::string_view unit = {}, std::size_t stride = 1,
           const Image* image = nullptr) {
    const OutputSpec* const spec = find_output(specs_, name);
    if (spec != nullptr) unit = spec->unit;
    all.push_back({std::move(name), unit, kind, shape, numbers, stride, image});
  }

  std::vector<MeasuredOutput> all;

 private:
  std::span<const OutputSpec> specs_;
};

/// The images of a sensor by the names of its outputs.
class Images : public OutputSink {
 public:
  explicit Images(Outputs& outputs) : outputs_(outputs) {}
  void picture(const std::string& stem, const Image* color, const Image* depth) override {
    if (color != nullptr) add(stem.empty() ? "color" : stem, *color);
    if (depth != nullptr) add(stem.empty() ? "depth" : stem + "_depth", *depth);
  }
  void plane(const std::string& stem, const std::string& channel, const Image& plane) override {
    add(stem.empty() || stem == channel ? channel : stem + "_" + channel, plane);
  }
  void text(const std::string&, const std::string&, std::string_view) override {}
  void rows(std::span<const TableColumn>, std::span<const double>) override {}

 private:
  void add(const std::string& name, const Image& image) {
    outputs_.add(name, OutputKind::image, {image.height, image.width, image.channels}, image.pixels.data(), {}, 1,
                 &image);
  }
  Outputs& outputs_;
};

void add_scan(const Scan& scan, Outputs& outputs) {
  const OutputShape shape{scan.rings, scan.beams};
  if (scan.range_m.empty()) return;
  outputs.add("range_m", OutputKind::scan_column, shape, scan.range_m.data(), "m");
  outputs.add("error_bound_m", OutputKind::scan_column, shape, scan.error_bound_m.data(), "m");
  outputs.add("azimuth_rad", OutputKind::scan_column, {1, scan.beams}, scan.azimuth_rad.data(), "rad");
  outputs.add("elevation_rad", OutputKind::scan_column, {scan.rings, 1}, scan.elevation_rad.data(), "rad");
  for (const ScanChannel& channel : scan.channels) {
    outputs.add(channel.name, OutputKind::scan_column, shape, channel.values.data(), channel.unit);
  }
}

void add_table(const Reading& reading, Outputs& outputs) {
  const auto rows = static_cast<std::uint32_t>(reading.rows());
  for (std::size_t c = 0; c < reading.columns.size(); ++c) {
    outputs.add(reading.columns[c].name, OutputKind::table_column, {rows, 1}, reading.values.data() + c,
                reading.columns[c].unit, reading.columns.size());
  }
}

}  // namespace

const OutputSpec* find_output(std::span<const OutputSpec> outputs, std::string_view name) {
  for (const OutputSpec& each : outputs) {
    const std::string_view known = each.name;
    const std::size_t star = known.find('*');
    const bool fits = star == known.npos ? known == name
                                         : name.size() + 1 >= known.size() && name.starts_with(known.substr(0, star)) &&
                                               name.ends_with(known.substr(star + 1));
    if (fits) return &each;
  }
  return nullptr;
}

std::vector<MeasuredOutput> measured_outputs(const BuiltSensor& sensor) {
  Outputs outputs(sensor);
  const Sensor& measured = *sensor.sensor;
  if (const Scan* const scan = measured.scan()) {
    add_scan(*scan, outputs);
  } else {
    Images images(outputs);
    measured.write(images);
  }
  const std::span<const NamedValue> values = measured.values();
  if (const Reading* const reading = measured.reading(); reading != nullptr && values.empty()) {
    add_table(*reading, outputs);
  }
  for (const NamedValue& value : values) outputs.add(std::string(value.name), OutputKind::scalar, {}, &value.value);
  return std::move(outputs.all);
}

}  // namespace simvis
