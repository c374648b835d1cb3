#include "sensors/beam_tables/velodyne_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include "scenegraph/language/source_text.h"
#include "sensors/beam_tables/turn.h"

namespace simvis {
namespace {

enum LaserKey : std::uint8_t { kLaserId, kRotation, kVertical, kVerticalOffset, kHorizontalOffset };

struct LaserKeySpec {
  std::string_view name;
  double min, max;
};

constexpr double kMaxLasers = 1024;

// In the order of LaserKey.
constexpr LaserKeySpec kLaserKeys[] = {
    {"laser_id", 0, kMaxLasers - 1},
    {"rot_correction", -2 * std::numbers::pi, 2 * std::numbers::pi},
    {"vert_correction", -std::numbers::pi / 2, std::numbers::pi / 2},
    {"vert_offset_correction", -kMaxBeamOrigin_m, kMaxBeamOrigin_m},
    {"horiz_offset_correction", -kMaxBeamOrigin_m, kMaxBeamOrigin_m},
};

// Keys that change no beam.
constexpr std::string_view kOtherKeys[] = {
    "dist_correction", "dist_correction_x", "dist_correction_y", "focal_distance",      "focal_slope",
    "max_intensity",   "min_intensity",     "num_lasers",        "distance_resolution", "two_pt_correction_available"};

struct YamlWord {
  std::string_view text;
  std::size_t offset = 0;
};

struct CalibratedLaser {
  std::size_t offset = 0;  // in the text
  std::array<std::optional<double>, std::size(kLaserKeys)> values{};

  double value(LaserKey key) const { return values[key].value_or(0); }
};

// Words are separated by white space and the punctuation of flow style; comments are left out.
std::vector<YamlWord> yaml_words(std::string_view text) {
  constexpr std::string_view kBetween = " \t\r\n,{}[]";
  std::vector<YamlWord> words;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '#') {
      i = std::min(text.find_first_of("\r\n", i), text.size());
    } else if (kBetween.find(text[i]) != kBetween.npos) {
      ++i;
    } else {
      const std::size_t end = std::min(text.find_first_of(kBetween, i), text.size());
      words.push_back({text.substr(i, end - i), i});
      i = end;
    }
  }
  return words;
}

class CalibrationReader {
 public:
  explicit CalibrationReader(const SourceText& source) : source_(source), words_(yaml_words(source.text())) {}

  /// By increasing elevation.
  std::vector<CalibratedLaser> read() {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      const YamlWord& word = words_[i];
      if (word.text == "---" || word.text == "...") continue;
      if (word.text == "-") {
        lasers_.push_back({.offset = word.offset});
      } else if (word.text != "lasers:") {
        i = read_pair(i);
      }
    }
    if (lasers_.empty()) fail_at({.file = source_.file()}, "has no lasers, expected a list of them below lasers:");
    check();
    std::ranges::stable_sort(lasers_, {}, [](const auto& laser) { return laser.value(kLaserId); });
    std::ranges::stable_sort(lasers_, {}, [](const auto& laser) { return laser.value(kVertical); });
    return std::move(lasers_);
  }

 private:
  // Returns the number of the pair's last word.
  std::size_t read_pair(std::size_t i) {
    const YamlWord& key = words_[i];
    if (!key.text.ends_with(':')) {
      fail_at(source_.at(key.offset), in_quotes(key.text) + " is no key, expected a key that ends with a colon");
    }
    const std::string_view name = key.text.substr(0, key.text.size() - 1);
    const auto* const known = std::ranges::find(kLaserKeys, name, &LaserKeySpec::name);
    if (known == std::end(kLaserKeys) && std::ranges::count(kOtherKeys, name) == 0) fail_unknown(key, name);
    if (i + 1 == words_.size() || words_[i + 1].text.ends_with(':') || words_[i + 1].text == "-") {
      fail_at(source_.at(key.offset), std::string(name) + " has no value, expected one");
    }
    if (known == std::end(kLaserKeys)) return i + 1;
    if (lasers_.empty()) fail_at(source_.at(key.offset), std::string(name) + " stands outside of a laser");
    std::optional<double>& value = lasers_.back().values[static_cast<std::size_t>(known - kLaserKeys)];
    if (value) fail_at(source_.at(key.offset), std::string(name) + " is there twice, expected it once for each laser");
    value = number(words_[i + 1], *known);
    return i + 1;
  }

  [[noreturn]] void fail_unknown(const YamlWord& key, std::string_view name) const {
    std::vector<std::string_view> names(std::begin(kOtherKeys), std::end(kOtherKeys));
    for (const LaserKeySpec& each : kLaserKeys) names.push_back(each.name);
    fail_at(source_.at(key.offset),
            "unknown key " + in_quotes(name) + ", expected those of a Velodyne calibration" + suggestion(name, names));
  }

  double number(const YamlWord& word, const LaserKeySpec& key) const {
    double value = 0;
    const bool whole = key.name != kLaserKeys[kLaserId].name;
    if (parse_number(word.text, value) && value >= key.min && value <= key.max &&
        (whole || value == std::floor(value))) {
      return value;
    }
    fail_at(source_.at(word.offset), in_quotes(word.text) + " is not allowed as " + std::string(key.name) +
                                         ", expected a " + (whole ? "number" : "whole number") + " from " +
                                         format_number(key.min) + " to " + format_number(key.max));
  }

  void check() const {
    std::vector<double> ids;
    for (const CalibratedLaser& laser : lasers_) {
      for (const LaserKey key : {kLaserId, kRotation, kVertical}) {
        if (laser.values[key]) continue;
        fail_at(source_.at(laser.offset), "a laser has no " + std::string(kLaserKeys[key].name) +
                                              ", expected laser_id, rot_correction and vert_correction");
      }
      if (std::ranges::count(ids, laser.value(kLaserId)) > 0) {
        fail_at(source_.at(laser.offset),
                "laser_id " + format_number(laser.value(kLaserId)) + " is there twice, expected each laser once");
      }
      ids.push_back(laser.value(kLaserId));
    }
  }

  const SourceText& source_;
  std::vector<YamlWord> words_;
  std::vector<CalibratedLaser> lasers_;
};

void add_beam(const CalibratedLaser& laser, double column_deg, BeamTable& table) {
  const double azimuth_deg = wrapped_deg(column_deg + glm::degrees(laser.value(kRotation)));
  const double a = glm::radians(azimuth_deg), e = laser.value(kVertical);
  const double v = laser.value(kVerticalOffset), h = laser.value(kHorizontalOffset);
  table.azimuth_deg.push_back(azimuth_deg);
  table.elevation_deg.push_back(glm::degrees(e));
  table.origin_m.emplace_back(-v * std::sin(e) * std::cos(a) - h * std::sin(a),
                              -v * std::sin(e) * std::sin(a) + h * std::cos(a), v * std::cos(e));
}

}  // namespace

BeamTable read_velodyne_calibration(const std::filesystem::path& file, const TableColumns& columns) {
  const SourceText source = SourceText::read(file);
  const std::vector<CalibratedLaser> lasers = CalibrationReader(source).read();
  if (lasers.size() * columns.count > kMaxTableBeams) {
    fail_at({.file = file.string()}, std::to_string(lasers.size()) + " lasers with " + std::to_string(columns.count) +
                                         " samples are too many beams, expected at most " +
                                         std::to_string(kMaxTableBeams));
  }
  BeamTable table{.rings = static_cast<std::uint32_t>(lasers.size()), .beams = columns.count};
  const double steps = std::max(columns.count, 2u) - 1;
  for (const CalibratedLaser& laser : lasers) {
    for (std::uint32_t column = 0; column < columns.count; ++column) {
      add_beam(laser, columns.first_deg + column * (columns.last_deg - columns.first_deg) / steps, table);
    }
  }
  if (std::ranges::all_of(table.origin_m, [](const glm::dvec3& origin) { return origin == glm::dvec3(0); })) {
    table.origin_m.clear();
  }
  return table;
}

}  // namespace simvis
