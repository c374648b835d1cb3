#include "sensors/beam_tables/ouster_metadata.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include <simvis/location.h>
#include "engine/base/assert.h"
#include "engine/base/words.h"
#include "scenegraph/language/source_text.h"
#include "sensors/beam_tables/turn.h"

namespace simvis {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kMaxColumns = 8192, kMaxPixels = 512, kMaxRate_hz = 100;
constexpr double kMaxPlace_mm = 1000 * kMaxBeamOrigin_m;

// The groups of firmware 2.4 and later; the first is the top of the file.
constexpr const char* kOusterGroups[] = {
    "", "beam_intrinsics", "lidar_intrinsics", "lidar_data_format", "data_format", "config_params", "sensor_info"};

// Nested values are named by their kind: their text may be long and deep.
std::string shown(const Json& value) { return in_quotes(value.is_primitive() ? value.dump() : value.type_name()); }

class OusterReader {
 public:
  explicit OusterReader(const SourceText& source) : source_(source) {
    try {
      root_ = Json::parse(source.text());
    } catch (const Json::parse_error& error) {
      fail_at(source.at(error.byte == 0 ? 0 : error.byte - 1), "is not JSON here, expected the metadata of a sensor");
    } catch (const Json::exception&) {
      fail_at({.file = source.file()}, "has a number that is too large, expected the metadata of a sensor");
    }
    if (!root_.is_object()) fail_at(source.at(0), "is no JSON object, expected the metadata of a sensor");
  }

  BeamTable read() {
    auto device = std::make_shared<ScannerDevice>();
    device->format = PacketFormat::ouster;
    OusterPackets& ouster = device->ouster;
    ouster.elevation_deg = numbers("beam_altitude_angles", {}, -90, 90);
    ouster.azimuth_deg = numbers("beam_azimuth_angles", ouster.elevation_deg.size(), -360, 360);
    read_origin(ouster);
    read_place(ouster);
    read_mode(ouster);
    const std::uint32_t beams = read_window(ouster);
    if (const Json* const line = find("prod_line"); line != nullptr && line->is_string()) {
      ouster.product_line = line->get<std::string>();
    }
    device->name = "Ouster " + (ouster.product_line.empty() ? "sensor" : ouster.product_line);
    return ouster_beam_table(device, beams);
  }

 private:
  const Json* find(const char* key) const {
    for (const char* const name : kOusterGroups) {
      const Json* group = &root_;
      if (*name != '\0') {
        const auto found = root_.find(name);
        if (found == root_.end() || !found->is_object()) continue;
        group = &*found;
      }
      if (const auto value = group->find(key); value != group->end()) return &*value;
    }
    return nullptr;
  }

  [[noreturn]] void fail(const char* key, const std::string& what) const {
    const std::size_t place = source_.text().find('"' + std::string(key) + '"');
    fail_at(place == std::string::npos ? Location{.file = source_.file()} : source_.at(place),
            std::string(key) + " " + what);
  }

  // `count` 0: from 1 to kMaxPixels numbers.
  std::vector<double> numbers(const char* key, std::size_t count, double min, double max) const {
    const Json* const array = find(key);
    if (array == nullptr) fail(key, "is missing, expected the metadata of a sensor");
    if (!array->is_array() || (count == 0 && (array->empty() || array->size() > kMaxPixels)) ||
        (count > 0 && array->size() != count)) {
      fail(key, "is no array of that length, expected " +
                    (count == 0 ? "from 1 to " + std::to_string(kMaxPixels) : std::to_string(count)) + " numbers");
    }
    std::vector<double> values;
    for (const Json& each : *array) {
      const double value = each.is_number() ? each.get<double>() : std::nan("");
      if (!(value >= min && value <= max)) {
        fail(key, "has " + shown(each) + " as number " + std::to_string(values.size()) + ", expected numbers from " +
                      std::to_string(std::lround(min)) + " to " + std::to_string(std::lround(max)));
      }
      values.push_back(value);
    }
    return values;
  }

  void read_origin(OusterPackets& ouster) const {
    if (find("beam_to_lidar_transform") != nullptr) {
      const std::vector<double> rows = numbers("beam_to_lidar_transform", 16, -kMaxPlace_mm, kMaxPlace_mm);
      ouster.beam_radius_mm = rows[3];
      ouster.beam_z_mm = rows[11];
    } else if (const Json* const radius = find("lidar_origin_to_beam_origin_mm")) {
      const double value = radius->is_number() ? radius->get<double>() : std::nan("");
      if (!(std::abs(value) <= kMaxPlace_mm)) fail("lidar_origin_to_beam_origin_mm", "is no number within 10 m");
      ouster.beam_radius_mm = value;
    }
  }

  void read_place(OusterPackets& ouster) const {
    ouster.lidar_to_sensor = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    if (find("lidar_to_sensor_transform") == nullptr) return;
    const char* const key = "lidar_to_sensor_transform";
    ouster.lidar_to_sensor = numbers(key, 16, -kMaxPlace_mm, kMaxPlace_mm);
    const std::vector<double>& m = ouster.lidar_to_sensor;
    constexpr double kRounding = 1e-6;  // such files have six digits
    const double expected[] = {m[0], -m[4], 0, m[4], m[0], 0, 0, 0, 1};
    for (std::size_t i = 0; i < 9; ++i) {
      if (std::abs(m[i / 3 * 4 + i % 3] - expected[i]) > kRounding) fail(key, "is no turn about z, expected one");
    }
    if (std::abs(std::hypot(m[0], m[4]) - 1) > kRounding) fail(key, "is no turn about z, expected one");
  }

  void read_mode(OusterPackets& ouster) const {
    const Json* const mode = find("lidar_mode");
    if (mode == nullptr || !mode->is_string()) fail("lidar_mode", "is missing, expected a text such as \"1024x10\"");
    const auto text = mode->get<std::string>();
    const std::vector<std::string_view> words = cells_of(text, 'x');
    ouster.columns = as_number<std::uint32_t>(words.front()).value_or(0);
    ouster.rate_hz = as_number<std::uint32_t>(words.back()).value_or(0);
    if (words.size() != 2 || ouster.columns == 0 || ouster.columns > kMaxColumns || ouster.rate_hz == 0 ||
        ouster.rate_hz > kMaxRate_hz) {
      fail("lidar_mode", "is " + in_quotes(text) + ", expected columns and turns per second, such as \"1024x10\"");
    }
    if (const Json* const columns = find("columns_per_frame"); columns != nullptr && *columns != ouster.columns) {
      fail("columns_per_frame", "is " + shown(*columns) + " with lidar_mode " + in_quotes(text) + ", expected " +
                                    std::to_string(ouster.columns));
    }
  }

  // Returns the number of columns that are measured.
  std::uint32_t read_window(OusterPackets& ouster) const {
    if (find("column_window") == nullptr) return ouster.columns;
    const std::vector<double> window = numbers("column_window", 2, 0, ouster.columns - 1.0);
    const auto first = static_cast<std::uint32_t>(window[0]), last = static_cast<std::uint32_t>(window[1]);
    ouster.first_column = first;
    return (last + ouster.columns - first) % ouster.columns + 1;
  }

  const SourceText& source_;
  Json root_;
};

}  // namespace

BeamTable ouster_beam_table(const std::shared_ptr<const ScannerDevice>& device, std::uint32_t beams) {
  const OusterPackets& ouster = device->ouster;
  const std::vector<double>& place = ouster.lidar_to_sensor;
  SIMVIS_ASSERT(place.size() == 16 && ouster.azimuth_deg.size() == ouster.elevation_deg.size());
  const double turn_deg = glm::degrees(std::atan2(place[4], place[0]));
  BeamTable table{.rings = static_cast<std::uint32_t>(ouster.elevation_deg.size()), .beams = beams, .device = device};
  for (std::uint32_t ring = 0; ring < table.rings; ++ring) {
    for (std::uint32_t beam = 0; beam < beams; ++beam) {
      const std::uint32_t column = (ouster.first_column + beam) % ouster.columns;
      const double encoder_deg = turn_deg - 360.0 * column / ouster.columns;
      table.azimuth_deg.push_back(wrapped_deg(encoder_deg - ouster.azimuth_deg[ring]));
      table.elevation_deg.push_back(ouster.elevation_deg[ring]);
      const double radius_m = ouster.beam_radius_mm / 1000, angle = glm::radians(wrapped_deg(encoder_deg));
      table.origin_m.emplace_back(place[3] / 1000 + radius_m * std::cos(angle),
                                  place[7] / 1000 + radius_m * std::sin(angle), (place[11] + ouster.beam_z_mm) / 1000);
      const double column_ns = 1e9 / (static_cast<double>(ouster.columns) * ouster.rate_hz);
      table.time_ns.push_back(std::llround(beam * column_ns));
    }
  }
  return table;
}

BeamTable read_ouster_metadata(const std::filesystem::path& file) {
  const SourceText source = SourceText::read(file);
  return OusterReader(source).read();
}

}  // namespace simvis
