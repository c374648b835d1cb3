#include "elements/visualization/point_file.h"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "scenegraph/language/source_text.h"

namespace simvis {
namespace {

constexpr std::string_view kSeparators = " \t,";
constexpr std::string_view kExpected = ", expected \"x y z\" or \"x y z r g b\", metres and colours from 0 to 255";

// The words of one line, and the offset of the line in the text.
struct Line {
  std::size_t offset = 0;
  std::vector<std::string_view> words;
};

// Returns false at the end of the text. `next` is the offset of the following line.
bool read_line(std::string_view text, std::size_t& next, Line& line) {
  if (next >= text.size()) return false;
  line.offset = next;
  const std::size_t end = std::min(text.find_first_of("\r\n", next), text.size());
  std::string_view rest = text.substr(next, end - next);
  line.words.clear();
  while (true) {
    const std::size_t begin = rest.find_first_not_of(kSeparators);
    if (begin == rest.npos) break;
    rest.remove_prefix(begin);
    line.words.push_back(rest.substr(0, rest.find_first_of(kSeparators)));
    rest.remove_prefix(line.words.back().size());
  }
  next = end + 1;
  return true;
}

bool is_header(const Line& line) {
  constexpr std::string_view kNames[] = {"x", "y", "z", "r", "g", "b"};
  const std::size_t count = line.words.size();
  return (count == 3 || count == 6) && std::ranges::equal(line.words, std::span(kNames).first(count));
}

class PointReader {
 public:
  explicit PointReader(const SourceText& source) : source_(source) {}

  PointFile read() {
    const std::string_view text = source_.text();
    Line line;
    bool first = true;
    for (std::size_t next = 0; read_line(text, next, line);) {
      if (line.words.empty() || line.words[0].starts_with('#')) continue;
      if (!std::exchange(first, false) || !is_header(line)) add(line);
    }
    if (file_.points.empty()) fail_at({.file = source_.file()}, "the file has no points" + std::string(kExpected));
    return std::move(file_);
  }

 private:
  void add(const Line& line) {
    const std::size_t count = line.words.size();
    if (count != 3 && count != 6) {
      fail_at(source_.at(line.offset), std::to_string(count) + " values in a line" + std::string(kExpected));
    }
    if (file_.points.empty()) file_.has_colors = count == 6;
    if ((count == 6) != file_.has_colors) {
      fail_at(source_.at(line.offset), std::string("a point with") + (count == 6 ? "" : "out") +
                                           " a colour after points with" + (count == 6 ? "out" : "") +
                                           " one, expected each to have one or none");
    }
    if (file_.points.size() == kMaxPoints) {
      fail_at(source_.at(line.offset), "too many points, expected at most " + std::to_string(kMaxPoints));
    }
    FilePoint point;
    for (int i = 0; i < 3; ++i) point.position_m[i] = number(line, i, -kMaxCoordinate_m, kMaxCoordinate_m);
    for (int i = 0; count == 6 && i < 3; ++i) {
      point.color[i] = linear_from_srgb(number(line, 3 + i, 0, 255) / 255);
    }
    file_.points.push_back(point);
  }

  double number(const Line& line, int i, double min, double max) const {
    const std::string_view word = line.words[static_cast<std::size_t>(i)];
    double value = 0;
    if (parse_number(word, value) && value >= min && value <= max) return value;
    fail_at(source_.at(static_cast<std::size_t>(word.data() - source_.text().data())),
            in_quotes(word) + " is not allowed, expected a number from " + format_number(min) + " to " +
                format_number(max));
  }

  const SourceText& source_;
  PointFile file_;
};

}  // namespace

PointFile read_point_file(const std::filesystem::path& file) {
  const SourceText source = SourceText::read(file);
  return PointReader(source).read();
}

}  // namespace simvis
