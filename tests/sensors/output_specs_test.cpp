// What a sensor gives equals its outputs, which are known before anything runs: names, order, number types, shapes,
// units and the values for nothing, for every sensor type.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "messages/cdr.h"
#include "messages/from_reading.h"
#include "tests/support/every_sensor.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

/// What a sensor passes on for files.
class Given : public OutputSink {
 public:
  void picture(const std::string& stem, const Image* color, const Image* depth) override {
    if (color != nullptr) images.push_back({stem.empty() ? "color" : stem, color});
    if (depth != nullptr) images.push_back({stem.empty() ? "depth" : stem + "_depth", depth});
  }
  void plane(const std::string&, const std::string& channel, const Image& plane) override {
    images.push_back({channel, &plane});
  }
  void text(const std::string&, const std::string&, std::string_view) override {}
  void rows(std::span<const TableColumn> all, std::span<const double> numbers) override {
    columns.assign(all.begin(), all.end());
    values.assign(numbers.begin(), numbers.end());
  }

  std::vector<std::pair<std::string, const Image*>> images;
  std::vector<TableColumn> columns;
  std::vector<double> values;
};

/// Whether `value` is what the output may give.
bool fits(const OutputSpec& spec, double value) {
  if (spec.nothing && (value == *spec.nothing || (std::isnan(value) && std::isnan(*spec.nothing)))) return true;
  if (!std::isfinite(value)) return false;
  if (spec.value_type == ValueType::i64) return value == std::trunc(value);
  return spec.value_type == ValueType::f64 || value == static_cast<double>(static_cast<float>(value));
}

template <typename Numbers>
std::size_t unfit(const OutputSpec& spec, const Numbers& values) {
  return static_cast<std::size_t>(
      std::ranges::count_if(values, [&](auto value) { return !fits(spec, static_cast<double>(value)); }));
}

void check_images(const Simulation& simulation, std::span<const OutputSpec> specs, const Given& given) {
  REQUIRE(given.images.size() == specs.size());
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const OutputSpec& spec = specs[i];
    const auto& [name, image] = given.images[i];
    CAPTURE(spec.name);
    CHECK(name == spec.name);
    const Image& named = name == "color"   ? simulation.color(kSensor)
                         : name == "depth" ? simulation.depth(kSensor)
                                           : simulation.picture(kSensor, name);
    CHECK(image == &named);
    CHECK(spec.value_type == ValueType::f32);
    CHECK(spec.shape == OutputShape{image->height, image->width, image->channels});
    CHECK(image->pixels.size() == std::size_t{image->height} * image->width * image->channels);
    CHECK(unfit(spec, image->pixels) == 0);
    CHECK((spec.bound.empty() || simulation.find_value(kSensor, spec.bound)));
  }
}

void check_rows(std::span<const OutputSpec> specs, const Given& given) {
  REQUIRE(given.columns.size() == specs.size());
  const std::size_t width = specs.size(), height = given.values.size() / width;
  REQUIRE(height * width == given.values.size());
  for (std::size_t c = 0; c < width; ++c) {
    const OutputSpec& spec = specs[c];
    const TableColumn& column = given.columns[c];
    CAPTURE(spec.name);
    CHECK(column.name == spec.name);
    CHECK(column.integer == (spec.value_type == ValueType::i64));
    CHECK(column.unit == spec.unit);
    if (!column.bound_of.empty()) {
      const auto bounded = std::ranges::find(specs, column.bound_of, &OutputSpec::name);
      REQUIRE(bounded != specs.end());
      CHECK(bounded->bound == spec.name);
    }
    const OutputShape one{};
    CHECK((spec.kind == OutputKind::scan_column || spec.kind == OutputKind::table_column || spec.shape == one));
    if (spec.shape.rows > 0) CHECK(std::size_t{spec.shape.rows} * spec.shape.columns * spec.shape.channels == height);
    std::vector<double> values;
    for (std::size_t row = 0; row < height; ++row) values.push_back(given.values[row * width + c]);
    CHECK(unfit(spec, values) == 0);
  }
}

void check_scan(const Scan& scan, std::span<const OutputSpec> specs) {
  constexpr std::size_t kOwnColumns = 9;  // ring to z_m: the scan has them in other forms
  REQUIRE(specs.size() == kOwnColumns + scan.channels.size());
  for (std::size_t i = 0; i < scan.channels.size(); ++i) CHECK(scan.channels[i].name == specs[kOwnColumns + i].name);
  CHECK(specs.front().shape == OutputShape{scan.rings, scan.beams});
  CHECK(unfit(*std::ranges::find(specs, "range_m", &OutputSpec::name), scan.range_m) == 0);
  CHECK(unfit(*std::ranges::find(specs, "error_bound_m", &OutputSpec::name), scan.error_bound_m) == 0);
}

void check(std::string_view type, const std::string& attributes) {
  CAPTURE(type);
  CAPTURE(attributes);
  const Command command = parse_commands(sensor_xml(type, attributes), "s.xml", ".").at(0);
  const std::vector<OutputSpec> specs = expanded(outputs_of(*find_sensor_type(type), command));
  REQUIRE_FALSE(specs.empty());
  Simulation simulation = scene_of(type, attributes);
  drive(simulation);
  Given given;
  simulation.write(kSensor, given);
  std::vector<OutputSpec> images, columns;
  for (const OutputSpec& spec : specs) (spec.kind == OutputKind::image ? images : columns).push_back(spec);
  check_images(simulation, images, given);
  if (images.empty()) check_rows(columns, given);
  if (columns.size() > 0 && columns.front().kind == OutputKind::scan_column)
    check_scan(simulation.scan(kSensor), columns);
  for (const OutputSpec& spec : columns) {
    CAPTURE(spec.name);
    const std::optional<double> value = simulation.find_value(kSensor, spec.name);
    CHECK(value.has_value() == (spec.kind == OutputKind::scalar));
    if (value) CHECK(fits(spec, *value));
  }
}

TEST_CASE("every sensor gives exactly what its type says before anything runs") {
  int types = 0;
  for (const SensorType* type : sensor_types()) {
    ++types;
    for (const std::string& attributes : attributes_of(type->name)) check(type->name, attributes);
  }
  CHECK(types >= 20);
}

TEST_CASE("outputs have a meaning, names of their own, and each bound is an output") {
  for (const SensorType* type : sensor_types()) {
    CAPTURE(type->name);
    const std::vector<OutputSpec> specs = all_outputs(*type);
    REQUIRE_FALSE(specs.empty());
    std::set<std::string> names;
    for (const OutputSpec& spec : specs) {
      CAPTURE(spec.name);
      CHECK(names.insert(spec.name).second);
      CHECK_FALSE(spec.meaning.empty());
      CHECK((spec.bound.empty() || std::ranges::find(specs, spec.bound, &OutputSpec::name) != specs.end()));
      CHECK((spec.given || !spec.when.empty()));
    }
  }
}

TEST_CASE("the message of a reading depends on exactly the outputs that name it") {
  int messages = 0;
  for (const SensorType* type : sensor_types()) {
    if (type->message.empty()) continue;
    ++messages;
    CAPTURE(type->name);
    const std::vector<OutputSpec> specs = expanded(all_outputs(*type));
    Reading reading;
    for (const OutputSpec& spec : specs) {
      reading.columns.push_back({.name = spec.name, .format = "%.9g"});
      reading.values.push_back(static_cast<double>(reading.values.size() + 1));
    }
    const auto bytes = [&] {
      const auto message = ros::message_of(reading, type->message, "frame");
      REQUIRE(message.has_value());
      return std::visit([](const auto& each) { return ros::encode(each); }, message->message);
    };
    const std::string before = bytes();
    for (std::size_t i = 0; i < specs.size(); ++i) {
      CAPTURE(specs[i].name);
      reading.values[i] += 100;
      CHECK((bytes() != before) == (specs[i].message == type->message));
      reading.values[i] -= 100;
    }
  }
  CHECK(messages >= 13);
}

TEST_CASE("outputs of a command that its type does not allow are refused with the place") {
  const Command wrong =
      parse_commands("<sensor type='range' name='S' insert_at='ROOT' rang_max='1'/>", "s.xml", ".").at(0);
  CHECK_THROWS_AS(outputs_of(*find_sensor_type("range"), wrong), InputError);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
