#include <simvis/trajectory.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "scenegraph/language/source_text.h"

namespace simvis {
namespace {

constexpr double kFullTurn_deg = 360;

struct Cell {
  std::string_view text;  // without surrounding spaces
  std::size_t offset;     // in the source
};

std::vector<Cell> split_cells(std::string_view line, std::size_t offset) {
  std::vector<Cell> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view text = line.substr(0, comma);
    const std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
    text.remove_prefix(begin);
    text = text.substr(0, text.find_last_not_of(" \t") + 1);
    cells.push_back({text, offset + begin});
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
    offset += comma + 1;
  }
}

bool is_blank_or_comment(const std::vector<Cell>& cells) {
  return cells[0].text.starts_with('#') || (cells.size() == 1 && cells[0].text.empty());
}

// Splits the text into lines of cells, without blank lines and comments.
std::vector<std::vector<Cell>> split_lines(std::string_view text) {
  std::vector<std::vector<Cell>> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
    std::vector<Cell> cells = split_cells(text.substr(begin, end - begin), begin);
    if (!is_blank_or_comment(cells)) lines.push_back(std::move(cells));
    begin = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
  }
  return lines;
}

std::vector<std::size_t> read_header(const std::vector<Cell>& cells, const SourceText& source,
                                     const Parameters& parameters) {
  if (cells[0].text != "time_s") {
    fail_at(source.at(cells[0].offset), "column " + in_quotes(cells[0].text) + ", expected \"time_s\" first");
  }
  std::vector<std::size_t> indices;
  for (const Cell& cell : std::span(cells).subspan(1)) {
    const Location where = source.at(cell.offset);
    const std::size_t dot = cell.text.rfind('.');
    if (dot == std::string_view::npos) fail_at(where, "column " + in_quotes(cell.text) + ", expected ELEMENT.PARAM");
    std::size_t index = 0;
    try {
      index = parameters.index(cell.text.substr(0, dot), cell.text.substr(dot + 1));
    } catch (const InputError& error) {
      fail_at(where, "column " + in_quotes(cell.text) + ": " + error.what());
    }
    if (std::ranges::find(indices, index) != indices.end()) {
      fail_at(where, "column " + in_quotes(cell.text) + " is given twice, expected once");
    }
    indices.push_back(index);
  }
  return indices;
}

double read_cell(const Cell& cell, const SourceText& source) {
  double value = 0;
  if (cell.text.empty()) fail_at(source.at(cell.offset), "empty cell, expected a finite number");
  if (!parse_number(cell.text, value)) {
    fail_at(source.at(cell.offset), in_quotes(cell.text) + " is not allowed, expected a finite number");
  }
  return value;
}

// The difference of two angles that is shortest among those of whole turns, in degrees.
double short_way(double from_deg, double to_deg) { return std::remainder(to_deg - from_deg, kFullTurn_deg); }

}  // namespace

Trajectory::Trajectory(const std::filesystem::path& file, const Parameters& parameters) {
  const SourceText source = SourceText::read(file);
  const std::vector<std::vector<Cell>> lines = split_lines(source.text());
  if (lines.empty()) fail_at(source.at(0), "no header, expected \"time_s,ELEMENT.PARAM,...\"");
  indices_ = read_header(lines[0], source, parameters);
  if (lines.size() == 1) fail_at(source.at(source.text().size()), "no rows, expected at least one");
  for (const std::size_t index : indices_) full_turn_.push_back(parameters.spec(index).full_turn);
  warned_.resize(indices_.size());
  for (const std::vector<Cell>& cells : std::span(lines).subspan(1)) {
    if (cells.size() != lines[0].size()) {
      fail_at(source.at(cells[0].offset), std::to_string(cells.size()) + " cells, expected " +
                                              std::to_string(lines[0].size()) + " as in the header");
    }
    const double time_s = read_cell(cells[0], source);
    if (!times_s_.empty() && time_s <= times_s_.back()) {
      fail_at(source.at(cells[0].offset), "time " + format_number(time_s) + " is not allowed, expected one after " +
                                              format_number(times_s_.back()) + " (s)");
    }
    times_s_.push_back(time_s);
    for (std::size_t i = 0; i < indices_.size(); ++i) {
      const Cell& cell = cells[i + 1];
      values_.push_back(read_cell(cell, source));
      const std::string wrong = check_number(parameters.spec(indices_[i]), values_.back());
      if (!wrong.empty()) fail_at(source.at(cell.offset), parameters.name(indices_[i]) + ": " + wrong);
      if (times_s_.size() > 1 && full_turn_[i]) check_turn(i, parameters.name(indices_[i]), source.at(cell.offset));
    }
  }
}

// Adds a warning if the last value of a column lies a full turn or more from the value before.
void Trajectory::check_turn(std::size_t column, const std::string& name, const Location& where) {
  const double to = values_.back(), from = values_[values_.size() - 1 - indices_.size()];
  if (std::abs(to - from) < kFullTurn_deg || warned_[column]) return;
  warned_[column] = true;
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
  for (std::size_t i = 0; i < indices_.size(); ++i) {
    // std::lerp is monotonic and exact at both ends, so the result stays within the limits if both rows do.
    const double first = values_[from * indices_.size() + i], last = values_[to * indices_.size() + i];
    const bool other_way = full_turn_[i] && std::abs(last - first) > kFullTurn_deg / 2;
    if (parameters.is_removed(indices_[i])) continue;
    parameters.set(indices_[i], other_way ? first + part * short_way(first, last) : std::lerp(first, last, part));
  }
}

}  // namespace simvis
