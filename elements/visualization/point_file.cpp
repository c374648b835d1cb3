#include "elements/visualization/point_file.h"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "engine/base/words.h"
#include "scenegraph/language/source_text.h"

namespace simvis {
namespace {

constexpr std::string_view kSeparators = " \t,";
constexpr std::string_view kExpected = ", expected \"x y z\" or \"x y z r g b\", metres and colours from 0 to 255";

using Line = std::vector<std::string_view>;  // its words

bool is_header(const Line& words) {
  constexpr std::string_view kNames[] = {"x", "y", "z", "r", "g", "b"};
  const std::size_t count = words.size();
  return (count == 3 || count == 6) && std::ranges::equal(words, std::span(kNames).first(count));
}

class PointReader {
 public:
  explicit PointReader(const SourceText& source) : source_(source) {}

  PointFile read() {
    const std::string_view text = source_.text();
    std::size_t next = 0;
    bool first = true;
    for (std::string_view row = next_row(text, next); !row.empty(); row = next_row(text, next)) {
      const Line line = words_of(row, kSeparators);
      if (line.empty()) continue;
      if (!std::exchange(first, false) || !is_header(line)) add(line);
    }
    if (file_.points.empty()) fail_at({.file = source_.file()}, "the file has no points" + std::string(kExpected));
    return std::move(file_);
  }

 private:
  void add(const Line& line) {
    const std::size_t count = line.size();
    if (count != 3 && count != 6) {
      fail_at(source_.at(line.front()), std::to_string(count) + " values in a line" + std::string(kExpected));
    }
    if (file_.points.empty()) file_.has_colors = count == 6;
    if ((count == 6) != file_.has_colors) {
      fail_at(source_.at(line.front()), std::string("a point with") + (count == 6 ? "" : "out") +
                                            " a colour after points with" + (count == 6 ? "out" : "") +
                                            " one, expected each to have one or none");
    }
    if (file_.points.size() == kMaxPoints) {
      fail_at(source_.at(line.front()), "too many points, expected at most " + std::to_string(kMaxPoints));
    }
    FilePoint point;
    for (int i = 0; i < 3; ++i) point.position_m[i] = number(line, i, -kMaxCoordinate_m, kMaxCoordinate_m);
    for (int i = 0; count == 6 && i < 3; ++i) {
      point.color[i] = linear_from_srgb(number(line, 3 + i, 0, 255) / 255);
    }
    file_.points.push_back(point);
  }

  double number(const Line& line, int i, double min, double max) const {
    const std::string_view word = line[static_cast<std::size_t>(i)];
    double value = 0;
    if (parse_number(word, value) && value >= min && value <= max) return value;
    fail_at(source_.at(word), in_quotes(word) + " is not allowed, expected a number from " + format_number(min) +
                                  " to " + format_number(max));
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
