// Records of datasets, as --resume reads them from a folder: a byte for the format, then one record of JSON in each
// line.
#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/error.h>
#include "program/datasets/dataset_format.h"
#include "tests/fuzz/fuzz_target.h"

namespace simvis::fuzz {
namespace {

MeasuredArray array_of(const char* name, OutputKind kind, ValueType type,
                       ImageContent content = ImageContent::numbers) {
  return {{.name = name, .kind = kind, .value_type = type, .shape = {0, 0, 0}, .content = content}};
}

DatasetSensor camera() {
  DatasetSensor sensor{.name = "CAM"};
  sensor.measurement.calibrations = std::make_shared<const std::vector<Calibration>>(1);
  sensor.measurement.arrays = {
      array_of("color", OutputKind::image, ValueType::f32, ImageContent::color),
      array_of("depth", OutputKind::image, ValueType::f32, ImageContent::depth),
      array_of("instance", OutputKind::image, ValueType::u32),
      array_of("visible_pixels", OutputKind::table_column, ValueType::i64),
      array_of("silhouettes", OutputKind::image, ValueType::u8),
  };
  return sensor;
}

DatasetSensor event_camera() {
  DatasetSensor sensor{.name = "EV"};
  sensor.measurement.calibrations = std::make_shared<const std::vector<Calibration>>(1);
  for (const char* const name : {"t_us", "x", "y", "polarity"}) {
    sensor.measurement.arrays.push_back(array_of(name, OutputKind::table_column, ValueType::i64));
  }
  return sensor;
}

DatasetSensor imu() {
  DatasetSensor sensor{.name = "IMU"};
  sensor.measurement.arrays = {array_of("angular_velocity_x_rad_s", OutputKind::scalar, ValueType::f64),
                               array_of("specific_force_x_m_s2", OutputKind::scalar, ValueType::f64)};
  return sensor;
}

DatasetSensor scanner() {
  DatasetSensor sensor{.name = "SCAN"};
  sensor.measurement.arrays = {array_of("range_m", OutputKind::scan_column, ValueType::f32)};
  return sensor;
}

struct FuzzedFormat {
  const char* name;
  std::vector<DatasetSensor> sensors;
};

const std::vector<FuzzedFormat>& fuzzed_formats() {
  static const std::vector<FuzzedFormat> formats = {{"bop", {camera()}},
                                                    {"coco", {camera()}},
                                                    {"colmap", {camera()}},
                                                    {"euroc", {camera(), imu()}},
                                                    {"kitti", {camera(), scanner()}},
                                                    {"nuscenes", {camera(), scanner()}},
                                                    {"semantickitti", {camera(), scanner()}},
                                                    {"tum", {camera()}},
                                                    {"dsec", {event_camera()}}};
  return formats;
}

std::vector<Record> records_in(std::string_view text) {
  std::vector<Record> records;
  try {
    while (!text.empty()) {
      const std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(line.size() + 1, text.size()));
      records.push_back(Record::parse(line));
    }
  } catch (const Record::exception&) {
    throw InputError("no record");
  }
  return records;
}

void read_records(Input input) {
  InputBytes bytes(input);
  const FuzzedFormat& chosen = fuzzed_formats()[bytes.byte() % fuzzed_formats().size()];
  const std::vector<Record> records = records_in(text_of(bytes.rest()));
  if (records.empty()) return;
  const std::unique_ptr<DatasetFormat> format = make_dataset_format(chosen.name, 0.001);
  format->begin(chosen.sensors);
  format->read_kept_by([](const std::string& path, std::uint64_t bytes) {
    if (bytes != 0) throw foreign_record(path);
    return std::string();
  });
  for (const DatasetFile& file : whole_files(*format, records, "frames")) file.encode();
}

const TargetRegistration kRecords("dataset_records", read_records);

}  // namespace
}  // namespace simvis::fuzz
