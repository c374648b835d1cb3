#include <simvis/trajectory.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/pose.h>
#include "engine/base/words.h"
#include "scenegraph/language/pose_attribute.h"
#include "scenegraph/language/source_text.h"

namespace simvis {
namespace {

constexpr double kFullTurn_deg = 360;

// 285 years, which the clock's nanoseconds hold.
constexpr double kMaxTime_s = 9e9;

constexpr std::array<std::string_view, 4> kQuaternionColumns = {"qx", "qy", "qz", "qw"};
constexpr std::array<std::string_view, 3> kAngles = {"roll", "pitch", "yaw"};
constexpr std::size_t kNoColumn = ~std::size_t{0};

// The indices of roll, pitch and yaw of an element that has them.
std::optional<std::array<std::size_t, 3>> angles_of(std::string_view element, const Parameters& parameters) {
  const auto found = std::ranges::find_if(parameters.elements(), [&](const ElementDescriptor& each) {
    return !each.removed && each.name == element;  // a removed one may have had the name
  });
  if (found == parameters.elements().end()) return std::nullopt;
  std::array<std::size_t, 3> indices{};
  for (std::size_t i = 0; i < kAngles.size(); ++i) {
    const auto spec = std::ranges::find(found->parameters, kAngles[i], &AttributeSpec::name);
    if (spec == found->parameters.end()) return std::nullopt;
    indices[i] = found->first_value + static_cast<std::size_t>(spec - found->parameters.begin());
  }
  return indices;
}

double read_cell(std::string_view cell, const SourceText& source) {
  double value = 0;
  if (cell.empty()) fail_at(source.at(cell), "empty cell, expected a finite number");
  if (!parse_number(cell, value)) {
    fail_at(source.at(cell), in_quotes(cell) + " is not allowed, expected a finite number");
  }
  return value;
}

double read_time(std::string_view cell, const SourceText& source) {
  const double time_s = read_cell(cell, source);
  if (std::abs(time_s) > kMaxTime_s) {
    fail_at(source.at(cell), "time " + format_number(time_s) + " is not allowed, expected " +
                                 format_number(-kMaxTime_s) + " to " + format_number(kMaxTime_s) + " (s)");
  }
  return time_s;
}

// The difference of two angles that is shortest among those of whole turns, in degrees.
double short_way(double from_deg, double to_deg) {
  const double difference_deg = to_deg - from_deg;
  if (std::isfinite(difference_deg)) return std::remainder(difference_deg, kFullTurn_deg);
  return std::remainder(std::remainder(to_deg, kFullTurn_deg) - std::remainder(from_deg, kFullTurn_deg), kFullTurn_deg);
}

}  // namespace

// Reads the names of the columns.
struct Trajectory::Header {
  Header(std::span<const std::string_view> all_cells, const SourceText& text, const Parameters& of)
      : cells(all_cells), source(text), parameters(of) {
    if (cells[0] != "time_s") {
      fail_at(source.at(cells[0]), "column " + in_quotes(cells[0]) + ", expected \"time_s\" first");
    }
    cells = cells.subspan(1);
    for (std::size_t i = 0; i < cells.size(); ++i) add(i);
    for (const Rotation& rotation : rotations) check(rotation);
  }

  void add(std::size_t column) {
    const std::string_view text = cells[column];
    const std::size_t dot = text.rfind('.');
    if (dot == std::string_view::npos) fail(column, ", expected ELEMENT.PARAM");
    const std::string_view element = text.substr(0, dot), name = text.substr(dot + 1);
    const auto component = std::ranges::find(kQuaternionColumns, name);
    const auto angles = angles_of(element, parameters);
    if (component != kQuaternionColumns.end() && angles) {
      return add_component(column, static_cast<std::size_t>(component - kQuaternionColumns.begin()), *angles);
    }
    std::size_t index = 0;
    try {
      index = parameters.index(element, name);
    } catch (const InputError& error) {
      fail(column, std::string(": ") + error.what());
    }
    if (std::ranges::find(tracks, index, &Track::parameter) != tracks.end()) {
      fail(column, " is given twice, expected once");
    }
    tracks.push_back({.column = column, .parameter = index, .full_turn = parameters.spec(index).full_turn});
  }

  void add_component(std::size_t column, std::size_t component, const std::array<std::size_t, 3>& angles) {
    auto rotation = std::ranges::find(rotations, angles, &Rotation::parameters);
    if (rotation == rotations.end()) {
      rotation =
          rotations.insert(rotation, {.columns = {kNoColumn, kNoColumn, kNoColumn, kNoColumn}, .parameters = angles});
    }
    if (rotation->columns[component] != kNoColumn) fail(column, " is given twice, expected once");
    rotation->columns[component] = column;
  }

  void check(const Rotation& rotation) const {
    const std::size_t first = std::ranges::min(rotation.columns);
    if (std::ranges::max(rotation.columns) == kNoColumn) fail(first, ", expected all of qx, qy, qz and qw");
    for (const std::size_t angle : rotation.parameters) {
      if (std::ranges::find(tracks, angle, &Track::parameter) == tracks.end()) continue;
      fail(first, ": column " + in_quotes(parameters.name(angle)) +
                      " gives the orientation too, expected angles or a quaternion");
    }
  }

  [[noreturn]] void fail(std::size_t column, const std::string& what) const {
    fail_at(source.at(cells[column]), "column " + in_quotes(cells[column]) + what);
  }

  std::span<const std::string_view> cells;  // without the time's
  const SourceText& source;
  const Parameters& parameters;
  std::vector<Track> tracks;
  std::vector<Rotation> rotations;
};

Trajectory::Trajectory(const std::filesystem::path& file, const Parameters& parameters) {
  const SourceText source = SourceText::read(file);
  std::size_t next = 0;
  const std::string_view header = next_row(source.text(), next);
  if (header.empty()) fail_at(source.at(std::size_t{0}), "no header, expected \"time_s,ELEMENT.PARAM,...\"");
  const std::vector<std::string_view> heads = cells_of(header);
  add_columns(Header(heads, source, parameters));
  for (std::string_view row = next_row(source.text(), next); !row.empty(); row = next_row(source.text(), next)) {
    const std::vector<std::string_view> cells = cells_of(row);
    if (cells.size() != heads.size()) {
      fail_at(source.at(cells[0]),
              std::to_string(cells.size()) + " cells, expected " + std::to_string(heads.size()) + " as in the header");
    }
    const double time_s = read_time(cells[0], source);
    if (!times_s_.empty() && time_s <= times_s_.back()) {
      fail_at(source.at(cells[0]), "time " + format_number(time_s) + " is not allowed, expected one after " +
                                       format_number(times_s_.back()) + " (s)");
    }
    times_s_.push_back(time_s);
    for (const std::string_view cell : std::span(cells).subspan(1)) values_.push_back(read_cell(cell, source));
    const auto place = [&](std::size_t column) { return source.at(cells[column + 1]); };
    for (Track& track : tracks_) {
      const std::string name = parameters.name(track.parameter);
      const std::string wrong =
          check_number(parameters.spec(track.parameter), value(times_s_.size() - 1, track.column));
      if (!wrong.empty()) fail_at(place(track.column), name + ": " + wrong);
      if (times_s_.size() > 1 && track.full_turn) check_turn(track, name, place(track.column));
    }
    for (const Rotation& rotation : rotations_) scale_last(rotation, place(rotation.columns[0]));
  }
  if (times_s_.empty()) fail_at(source.at(source.text().size()), "no rows, expected at least one");
}

void Trajectory::add_columns(const Header& header) {
  tracks_ = header.tracks;
  rotations_ = header.rotations;
  columns_ = header.cells.size();
  for (const Track& track : tracks_) indices_.push_back(track.parameter);
  for (const Rotation& rotation : rotations_) {
    indices_.insert(indices_.end(), rotation.parameters.begin(), rotation.parameters.end());
  }
}

// Scales the quaternion of the last row to length 1.
void Trajectory::scale_last(const Rotation& rotation, const Location& where) {
  double square = 0;
  const std::size_t first = (times_s_.size() - 1) * columns_;
  for (const std::size_t column : rotation.columns) square += values_[first + column] * values_[first + column];
  const double length = std::sqrt(square);
  if (!(std::abs(length - 1) <= kQuaternionTolerance)) {
    fail_at(where, "the quaternion has length " + format_number(length) + ", expected 1");
  }
  for (const std::size_t column : rotation.columns) values_[first + column] /= length;
}

// Adds a warning if the last value of a column lies a full turn or more from the value before.
void Trajectory::check_turn(Track& track, const std::string& name, const Location& where) {
  const std::size_t row = times_s_.size() - 1;
  const double to = value(row, track.column), from = value(row - 1, track.column);
  if (std::abs(to - from) < kFullTurn_deg || track.warned) return;
  track.warned = true;
  warnings_.push_back(to_string(where) + ": " + name + " changes by " + format_number(to - from) +
                      " deg from row to row, but an angle turns the short way, here by " +
                      format_number(short_way(from, to)) + " deg; expected rows that are at most 180 deg apart");
}

void Trajectory::apply(double time_s, Parameters& parameters) const {
  const auto after_time = std::ranges::upper_bound(times_s_, time_s);
  const auto after = static_cast<std::size_t>(after_time - times_s_.begin());
  const std::size_t from = after == 0 ? 0 : after - 1;
  const std::size_t to = std::min(after, times_s_.size() - 1);
  const double part = from == to ? 0 : (time_s - times_s_[from]) / (times_s_[to] - times_s_[from]);
  for (const Track& track : tracks_) {
    // std::lerp is monotonic and exact at both ends, so the result stays within the limits if both rows do.
    const double first = value(from, track.column), last = value(to, track.column);
    const bool other_way = track.full_turn && std::abs(last - first) > kFullTurn_deg / 2;
    if (parameters.is_removed(track.parameter)) continue;
    parameters.set(track.parameter, other_way ? first + part * short_way(first, last) : std::lerp(first, last, part));
  }
  for (const Rotation& rotation : rotations_) turn(rotation, from, to, part, parameters);
}

void Trajectory::turn(const Rotation& rotation, std::size_t from, std::size_t to, double part,
                      Parameters& parameters) const {
  const auto quaternion = [&](std::size_t row) {
    const auto& [x, y, z, w] = rotation.columns;
    return glm::dquat(value(row, w), value(row, x), value(row, y), value(row, z));
  };
  const Pose pose = to_pose(glm::mat4_cast(glm::normalize(glm::slerp(quaternion(from), quaternion(to), part))));
  const double angles_rad[] = {pose.roll_rad, pose.pitch_rad, pose.yaw_rad};
  for (std::size_t i = 0; i < rotation.parameters.size(); ++i) {
    if (parameters.is_removed(rotation.parameters[i])) continue;
    parameters.set(rotation.parameters[i], glm::degrees(angles_rad[i]));
  }
}

}  // namespace simvis
