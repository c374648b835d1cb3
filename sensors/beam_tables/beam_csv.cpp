#include "sensors/beam_tables/beam_csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include "engine/base/words.h"
#include "scenegraph/language/source_text.h"

namespace simvis {
namespace {

// In the order of kBeamColumns.
enum BeamColumn : std::uint8_t { kAzimuth, kElevation, kZenith, kX, kY, kZ, kRadius, kTime, kChannel, kLivoxTime };

struct BeamColumnSpec {
  std::string_view name, livox_name;
  double min, max;
};

constexpr double kMaxTime_s = 1e6;
constexpr BeamColumnSpec kBeamColumns[] = {
    {"azimuth_deg", "Azimuth/deg", -360, 360},
    {"elevation_deg", "", -90, 90},
    {"zenith_deg", "Zenith/deg", 0, 180},
    {"x_m", "", -kMaxBeamOrigin_m, kMaxBeamOrigin_m},
    {"y_m", "", -kMaxBeamOrigin_m, kMaxBeamOrigin_m},
    {"z_m", "", -kMaxBeamOrigin_m, kMaxBeamOrigin_m},
    {"r_m", "", -kMaxBeamOrigin_m, kMaxBeamOrigin_m},
    {"time_s", "", 0, kMaxTime_s},
    {"channel", "", 0, kMaxChannel},
    {"", "Time/s", 0, static_cast<double>(kMaxTableBeams)},
};
constexpr std::size_t kBeamColumnCount = std::size(kBeamColumns);
constexpr std::string_view kExpectedColumns =
    ", expected azimuth_deg and elevation_deg, and any of x_m, y_m, z_m, r_m, time_s, channel; or Time/s, Azimuth/deg "
    "and Zenith/deg";

class BeamCsvReader {
 public:
  explicit BeamCsvReader(const SourceText& source) : source_(source) {}

  BeamTable read() {
    const std::string_view text = source_.text();
    std::size_t next = 0;
    for (std::string_view row = next_row(text, next); !row.empty(); row = next_row(text, next)) {
      const std::vector<std::string_view> cells = cells_of(row);
      if (columns_.empty()) {
        read_header(cells);
      } else {
        add(cells);
      }
    }
    if (columns_.empty()) {
      fail_at({.file = source_.file()}, "the file names no columns" + std::string(kExpectedColumns));
    }
    if (beams_.empty()) fail_at({.file = source_.file()}, "the table has no beams, expected at least one");
    if (numbered_) {
      for (TableBeam& beam : beams_) beam.time_ns.reset();
    }
    return make_beam_table(beams_);
  }

 private:
  void read_header(std::span<const std::string_view> cells) {
    for (const std::string_view cell : cells) {
      const auto* const found = std::ranges::find_if(kBeamColumns, [&](const BeamColumnSpec& column) {
        return !cell.empty() && (column.name == cell || column.livox_name == cell);
      });
      if (found == std::end(kBeamColumns)) {
        fail_at(source_.at(cell), "unknown column " + in_quotes(cell) + std::string(kExpectedColumns));
      }
      const auto column = static_cast<BeamColumn>(found - std::begin(kBeamColumns));
      if (std::ranges::count(columns_, column) > 0) {
        fail_at(source_.at(cell), "the column " + in_quotes(cell) + " is there twice, expected it once");
      }
      columns_.push_back(column);
      has_[column] = true;
    }
    if (!has_[kAzimuth] || has_[kElevation] == has_[kZenith] || (has_[kTime] && has_[kLivoxTime])) {
      fail_at(source_.at(cells.front()), "these columns do not say where beams point" + std::string(kExpectedColumns));
    }
    numbered_ = has_[kLivoxTime];
  }

  void add(std::span<const std::string_view> cells) {
    if (cells.size() != columns_.size()) {
      fail_at(source_.at(cells.front()), std::to_string(cells.size()) + " values in a line, expected " +
                                             std::to_string(columns_.size()) + ", one for each column");
    }
    if (beams_.size() == kMaxTableBeams) {
      fail_at(source_.at(cells.front()), "too many beams, expected at most " + std::to_string(kMaxTableBeams));
    }
    std::array<double, kBeamColumnCount> values{};
    for (std::size_t i = 0; i < cells.size(); ++i) values[columns_[i]] = number(cells[i], kBeamColumns[columns_[i]]);
    TableBeam beam{.azimuth_deg = values[kAzimuth],
                   .elevation_deg = has_[kZenith] ? 90 - values[kZenith] : values[kElevation],
                   .origin_m = {values[kX], values[kY], values[kZ]}};
    const double azimuth_rad = glm::radians(beam.azimuth_deg);
    beam.origin_m += values[kRadius] * glm::dvec3(std::cos(azimuth_rad), std::sin(azimuth_rad), 0);
    if (has_[kTime]) beam.time_ns = std::llround(values[kTime] * 1e9);
    if (has_[kLivoxTime]) add_livox_time(values[kLivoxTime], beam);
    if (has_[kChannel]) beam.channel = channel(values[kChannel], cells);
    beams_.push_back(beam);
  }

  void add_livox_time(double time, TableBeam& beam) {
    beam.time_ns = std::llround(time * 1e9);
    if (beams_.empty()) first_number_ = time;
    numbered_ = numbered_ && time == std::floor(time) && time - first_number_ == static_cast<double>(beams_.size());
  }

  std::uint32_t channel(double value, std::span<const std::string_view> cells) const {
    if (value != std::floor(value)) {
      const auto place = static_cast<std::size_t>(std::ranges::find(columns_, kChannel) - columns_.begin());
      fail_at(source_.at(cells[place]), in_quotes(cells[place]) +
                                            " is not allowed as a channel, expected "
                                            "a whole number");
    }
    return static_cast<std::uint32_t>(value);
  }

  double number(std::string_view cell, const BeamColumnSpec& column) const {
    double value = 0;
    if (parse_number(cell, value) && value >= column.min && value <= column.max) return value;
    const std::string_view name = column.name.empty() ? column.livox_name : column.name;
    fail_at(source_.at(cell), in_quotes(cell) + " is not allowed in the column " + std::string(name) +
                                  ", expected a number from " + format_number(column.min) + " to " +
                                  format_number(column.max));
  }

  const SourceText& source_;
  std::vector<BeamColumn> columns_;  // as the file names them
  std::array<bool, kBeamColumnCount> has_{};
  std::vector<TableBeam> beams_;
  bool numbered_ = false;  // so far, Livox's times are the numbers of the beams
  double first_number_ = 0;
};

}  // namespace

BeamTable read_beam_csv(const std::filesystem::path& file) {
  const SourceText source = SourceText::read(file);
  return BeamCsvReader(source).read();
}

}  // namespace simvis
