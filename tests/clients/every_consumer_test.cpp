// Each output of every sensor type arrives at each consumer with its name, unit, shape and exact numbers: in files, ROS
// messages, the page, shared memory and at followers. Among the types is one with made-up outputs.
// python/tests/test_outputs.py does the same in Python.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "exchange/messages/types/output_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/std_types.h"
#include "program/cli/follow_link.h"
#include "program/live/view_encoder.h"
#include "program/output/exif.h"
#include "program/output/number_text.h"
#include "program/output/output_writer.h"
#include "scenegraph/pictures/png_file.h"
#include "scenegraph/scan_arrays.h"
#include "sensors/measured_table.h"
#include "simvis/message_tap.h"
#include "simvis/sharing/output_message.h"
#include "tests/clients/shared_host.h"
#include "tests/plugin/every_output.cpp"  // NOLINT(bugprone-suspicious-include): its type, which it registers
#include "tests/support/every_sensor.h"

TEST_SUITE_BEGIN("clients");

namespace simvis::test {
namespace {

/// A sensor that has measured, and what it promised.
struct Measured {
  std::vector<OutputSpec> specs;
  Measurement measurement;
};

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// The numbers of an array as they lie in memory, without gaps.
std::string bytes_of(const MeasuredArray& array) {
  const std::vector<std::uint8_t> bytes = to_message(array).data;
  return {bytes.begin(), bytes.end()};
}

// Files: images as npy, except colour; everything else as CSV.

/// Data of a file of NumPy behind its header.
std::string npy_data(const std::string& file, const MeasuredArray& array) {
  constexpr std::size_t kPrefix = 10;
  REQUIRE(file.size() > kPrefix);
  const std::size_t header = static_cast<unsigned char>(file[8]) + 256 * static_cast<unsigned char>(file[9]);
  std::string shape = std::to_string(array.shape.rows) + ", " + std::to_string(array.shape.columns);
  if (array.shape.channels > 1) shape += ", " + std::to_string(array.shape.channels);
  CHECK(file.find("'shape': (" + shape + ")") < kPrefix + header);
  static const std::map<ValueType, std::string> kTypes = {{ValueType::u8, "|u1"},
                                                          {ValueType::u32, "<u4"},
                                                          {ValueType::i32, "<i4"},
                                                          {ValueType::f32, "<f4"},
                                                          {ValueType::f64, "<f8"}};
  CHECK(file.find("'descr': '" + kTypes.at(array.value_type) + "'") < kPrefix + header);
  return file.substr(kPrefix + header);
}

std::vector<std::vector<std::string>> csv_of(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line + ",");
    std::vector<std::string>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

void check_files(const Measured& measured) {
  const TemporaryFolder folder;
  OutputFormats formats;
  formats.depth = {"npy"};
  const std::string name(kSensor);
  OutputWriter writer({.folder = folder.path(), .sensors = {name}, .formats = formats});
  writer.write(name, {.index = 2, .time_ns = measured.measurement.time_ns}, measured.measurement.world_from_sensor,
               measured.measurement);
  writer.finish();
  for (const MeasuredArray& each : measured.measurement.arrays) {
    if (each.kind != OutputKind::image) continue;
    CAPTURE(each.name);
    if (each.content == ImageContent::color) {
      const std::string view = each.view.empty() ? name : name + "_" + each.view;
      const CameraCalibration* const camera = measured.measurement.calibration(each.view);
      const std::string picture = encode_png(*to_image(each));
      CHECK(read_text(folder / view / "000002.png") ==
            (camera == nullptr ? picture : with_focal_length(picture, *camera)));
    } else {
      CHECK(npy_data(read_text(folder / (name + "_" + each.name) / "000002.npy"), each) == bytes_of(each));
    }
  }
  const MeasuredTable table = measured_table(measured.measurement);
  if (table.columns.empty()) return;
  const auto rows = csv_of(read_text(folder / (name + ".csv")));
  REQUIRE(rows.size() == table.rows() + 1);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const TableColumn& column = table.columns[c];
    CAPTURE(column.name);
    const auto found = std::ranges::find(rows[0], column.name);
    REQUIRE(found != rows[0].end());
    if (!column.bound_of.empty() || column.name == "time_s") continue;  // bounds cover the rounding of what they bound
    const NumberFormat format = number_format(column);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      CHECK(rows[row + 1][static_cast<std::size_t>(found - rows[0].begin())] ==
            number_cell(format, table.values[row * table.columns.size() + c]));
    }
  }
}

// Messages: each output has the message that its type names, and those that have none go out as they are.

/// Takes all messages of a frame.
struct AllMessages : ros::MessageOutlet, ros::MessageSink {
  bool wants(const ros::Topic&, ros::TopicForm form) override { return form != ros::TopicForm::at_end; }
  bool add(ros::MessageJob job) override {
    job.run(*this);
    return true;
  }
  void put(const ros::Topic& topic, std::int64_t, std::string_view bytes) override {
    last[topic.name] = {std::string(topic.type->name), std::string(bytes)};
  }
  std::map<std::string, std::pair<std::string, std::string>> last;  // type and bytes, by topic
};

void check_message(const OutputSpec& spec, const Measurement& measurement, const AllMessages& messages) {
  const std::string topic = ros::topic_name(kSensor, spec.name);
  const MeasuredArray* const array = measurement.find(spec.name);
  if (!spec.message.empty()) {
    const bool is_there = std::ranges::any_of(messages.last, [&](const auto& each) {
      return each.first.starts_with("/" + std::string(kSensor) + "/") && each.second.first == spec.message;
    });
    CHECK(is_there);
    if (spec.message != ros::Float64::kName) return;
    CHECK(same(ros::decode<ros::Float64>(messages.last.at(topic).second).data, array->number(0)));
    return;
  }
  if (array == nullptr) return;
  REQUIRE(messages.last.contains(topic));
  REQUIRE(messages.last.at(topic).first == ros::OutputStamped::kName);
  const ros::Output output = ros::decode<ros::OutputStamped>(messages.last.at(topic).second).output;
  CHECK(output.name == spec.name);
  CHECK(output.kind == to_string(spec.kind));
  CHECK(output.unit == spec.unit);
  CHECK(OutputShape{output.rows, output.columns, output.channels} == array->shape);
  CHECK(std::string(output.data.begin(), output.data.end()) == bytes_of(*array));
}

void check_messages(const Measured& measured, const AllMessages& messages) {
  for (const OutputSpec& spec : measured.specs) {
    CAPTURE(spec.name);
    if (spec.on_request || spec.derived) continue;
    check_message(spec, measured.measurement, messages);
  }
}

// The page.

/// What a binary message says of its numbers, and the numbers.
std::pair<nlohmann::json, std::string> described(const std::string& message, std::size_t place) {
  std::uint32_t length = 0;
  std::memcpy(&length, message.data() + place, sizeof length);
  return {nlohmann::json::parse(message.substr(place + 8, length)), message.substr(place + 8 + length)};
}

void check_image(const MeasuredArray& array, const live::ViewFrame& frame) {
  const auto shown = std::ranges::find(frame.images, array.name, [](const auto& each) { return each.array.name; });
  REQUIRE(shown != frame.images.end());
  const auto [head, numbers] = described(live::image_message(*shown), 16);
  CHECK(head["name"] == array.name);
  CHECK(head["unit"] == array.unit);
  CHECK(head["width"] == array.shape.columns);
  CHECK(head["height"] == array.shape.rows);
  CHECK(head["channels"] == array.shape.channels);
  const bool is_color = array.content == ImageContent::color;
  CHECK(head["form"] == (is_color ? "png" : to_string(array.value_type)));
  CHECK(numbers == (is_color ? encode_png(*to_image(array)) : bytes_of(array)));
}

/// Whether four bytes of a message have a number: whole ones keep all digits, and the largest of them says none.
bool same_in_page(const std::string& type, const char* bytes, double number) {
  if (type == "u32") {
    std::uint32_t shown = 0;
    std::memcpy(&shown, bytes, sizeof shown);
    return std::isfinite(number) ? shown == number : shown == std::numeric_limits<std::uint32_t>::max();
  }
  float shown = 0;
  std::memcpy(&shown, bytes, sizeof shown);
  return type == "f32" && same(shown, static_cast<float>(number));
}

void check_beams(const Measurement& measurement, const live::ViewFrame& frame) {
  REQUIRE(frame.scans.size() == 1);
  const auto [head, numbers] = described(live::scan_message(frame.scans[0]), 120);
  std::size_t column = 0;
  for (const MeasuredArray& each : measurement.arrays) {
    if (is_beam_layout(each)) continue;
    CAPTURE(each.name);
    REQUIRE(column < head["columns"].size());
    const nlohmann::json& told = head["columns"][column];
    REQUIRE(told.size() == 3);
    CHECK(told[0] == each.name);
    CHECK(told[1] == each.unit);
    for (std::size_t i = 0; i < each.count(); ++i) {
      CHECK(same_in_page(told[2], numbers.data() + sizeof(float) * (column * each.count() + i), each.number(i)));
    }
    ++column;
  }
  CHECK(column == head["columns"].size());
}

void check_page(const Measured& measured, const live::ViewFrame& frame) {
  if (measured.measurement.arrays.front().kind == OutputKind::scan_column) {
    return check_beams(measured.measurement, frame);
  }
  const nlohmann::json tables = nlohmann::json::parse(live::frame_message(frame, {}))["tables"];
  std::size_t column = 0;
  for (const MeasuredArray& each : measured.measurement.arrays) {
    CAPTURE(each.name);
    if (each.kind == OutputKind::image) {
      check_image(each, frame);
      continue;
    }
    REQUIRE(tables.size() == 1);
    CHECK(tables[0]["columns"][column] == nlohmann::json{each.name, each.unit});
    REQUIRE(tables[0]["rows"].size() == each.count());
    for (std::size_t row = 0; row < each.count(); ++row) {
      const nlohmann::json& cell = tables[0]["rows"][row][column];
      CHECK((std::isfinite(each.number(row)) ? cell == each.number(row) : cell.is_null()));
    }
    ++column;
  }
}

// Memory of other processes: shared memory, and what followers make of it and of DDS.

void check_same(const MeasuredArray& array, const Measurement& other) {
  const MeasuredArray* const seen = other.find(array.name);
  REQUIRE(seen != nullptr);
  CHECK(seen->unit == array.unit);
  CHECK(seen->shape == array.shape);
  CHECK(seen->numbers.index() == array.numbers.index());
  CHECK(bytes_of(*seen) == bytes_of(array));
}

void check_memory(const Measured& measured, const std::string& served) {
  const std::unique_ptr<FollowedHost> host = followed_host(served);
  REQUIRE(host->connect(1000));
  const std::optional<FollowedHost::HostMeasurement> seen = host->measurement(std::string(kSensor), 0);
  REQUIRE(seen);
  CHECK(seen->measurement.time_ns == measured.measurement.time_ns);
  CHECK(seen->measurement.world_from_sensor == measured.measurement.world_from_sensor);
  for (const MeasuredArray& each : measured.measurement.arrays) {
    CAPTURE(each.name);
    check_same(each, seen->measurement);
  }
  for (const NumberOnRequest& each : measured.measurement.on_request) {
    const MeasuredArray* const number = seen->measurement.find(each.name);
    REQUIRE(number != nullptr);
    CHECK(number->unit == each.unit);
    CHECK(number->number(0) == each.compute());
  }
}

void check_network(const Measured& measured) {
  for (const MeasuredArray& each : measured.measurement.arrays) {
    CAPTURE(each.name);
    std::optional<MeasuredArray> sent = to_array(ros::decode<ros::Output>(ros::encode(to_message(each))));
    REQUIRE(sent);
    CHECK(sent->kind == each.kind);
    check_same(each, {.arrays = {*std::move(sent)}});
  }
}

void check(const SensorType& type, const std::string& attributes) {
  CAPTURE(type.name);
  CAPTURE(attributes);
  const Command command = parse_commands(sensor_xml(type.name, attributes), "s.xml", ".").at(0);
  Simulation simulation = scene_of(type.name, attributes);
  ServeDesc desc;
  desc.name = unique_name("consumers");
  simulation.serve(desc);
  AllMessages messages;
  send_messages(simulation, &messages);
  drive(simulation);
  const Measured measured{expanded(outputs_of(type, command)), simulation.measurement(kSensor)};
  live::ViewCopier copier;
  const FrameTime last{.index = 2, .time_ns = measured.measurement.time_ns};
  const live::ViewFrame frame = copier.copy(simulation, last, 1, {.every_sensor = true});
  check_files(measured);
  check_messages(measured, messages);
  check_page(measured, frame);
  check_memory(measured, desc.name);
  check_network(measured);
  send_messages(simulation, nullptr);
}

}  // namespace

TEST_CASE("each output of every sensor type arrives at each consumer") {
  std::set<std::string_view> types;
  for (const SensorType* type : sensor_types()) {
    types.insert(type->name);
    for (const std::string& attributes : attributes_of(type->name)) check(*type, attributes);
  }
  CHECK(types.size() >= 20);
  CHECK(types.contains("every_output"));
}

}  // namespace simvis::test

TEST_SUITE_END();
