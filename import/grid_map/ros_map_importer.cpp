// Imports occupancy grids as ROS's map_server saves them, a YAML file and a picture: occupied cells become walls.
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/input_file.h"
#include "engine/base/words.h"
#include "import/grid_map/grid_part.h"
#include "import/mesh/picture_file.h"

namespace simvis {
namespace {

constexpr double kDefaultOccupied = 0.65;  // of map_server, as are the names of the keys

// The value of a line "KEY: VALUE", and its line.
struct MapValue {
  std::string text;
  std::size_t line = 0;
};

// The mappings of one level that map_server writes: one line each, with comments, and texts in quotation marks. A list
// may also stand in lines of its own that begin with "- ".
class MapFile {
 public:
  explicit MapFile(const std::filesystem::path& file) : file_(file) {
    const Bytes bytes = read_whole_file(file);
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (std::size_t line = 1; !rest.empty(); ++line) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      read_line(rest.substr(0, end), line);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }

  bool has(const char* key) const { return values_.contains(key); }

  const MapValue& require(const char* key, const char* what) const {
    const auto found = values_.find(key);
    if (found != values_.end()) return found->second;
    fail_at({.file = file_.string()}, "has no key " + in_quotes(key) + ", expected that of a ROS map: " + what);
  }

  double number(const char* key, std::optional<double> fallback, double min, double max) const {
    if (!has(key) && fallback) return *fallback;
    const MapValue& value = require(key, "a number");
    double number = 0;
    if (parse_number(value.text, number) && number >= min && number <= max) return number;
    refuse(key, value, "a number from " + format_number(min) + " to " + format_number(max));
  }

  /// The text of a key that is there.
  const std::string& text(const char* key) const { return require(key, "a text").text; }

  /// 0 or 1, or a truth value of YAML; false if the key is not there.
  bool flag(const char* key) const {
    if (!has(key)) return false;
    const std::string& value = text(key);
    if (value == "true" || value == "True" || value == "TRUE") return true;
    if (value == "false" || value == "False" || value == "FALSE") return false;
    return number(key, std::nullopt, 0, 1) != 0;
  }

  [[noreturn]] void refuse(const char* key, const MapValue& value, const std::string& expected) const {
    fail_at({.file = file_.string(), .line = static_cast<int>(value.line), .column = 1},
            "key " + in_quotes(key) + ": " + in_quotes(value.text) + " is not allowed, expected " + expected);
  }

  /// The picture of the cells. Throws InputError at the line that names it.
  Texture picture() const {
    const MapValue& name = require("image", "the name of a picture");
    try {
      return read_picture_file(file_.parent_path() / name.text);
    } catch (const InputError& error) {
      fail_at({.file = file_.string(), .line = static_cast<int>(name.line), .column = 1},
              "key \"image\": " + without_word_error(error.what()));
    }
  }

 private:
  // Adds a line "- VALUE" to the list of the key before.
  bool read_list_line(std::string_view text) {
    const std::string_view item = trimmed(text);
    if (!item.starts_with("- ") || last_ == values_.end()) return false;
    std::string& list = last_->second.text;
    if (list.empty()) list = "[]";
    if (!list.ends_with(']')) return false;
    list.pop_back();
    list += (list.size() > 1 ? ", " : "") + std::string(trimmed(item.substr(2, item.find(" #", 2) - 2))) + "]";
    return true;
  }

  // What stands in quotation marks. Two single ones stand for one; in double ones a backslash stands for the character
  // behind it, and "\n" for a line break.
  static std::string unquoted(std::string_view value) {
    const bool is_double = value.front() == '"';
    std::string text;
    for (std::size_t i = 1; i < value.size(); ++i) {
      const char next = i + 1 < value.size() ? value[i + 1] : '\0';
      if (is_double && value[i] == '\\' && next != '\0') {
        text += next == 'n' ? '\n' : next;
        ++i;
        continue;
      }
      if (value[i] == value.front()) {
        if (is_double || next != value.front()) break;
        ++i;
      }
      text += value[i];
    }
    return text;
  }

  void read_line(std::string_view text, std::size_t line) {
    if (read_list_line(text)) return;
    const std::size_t colon = text.find(':');
    if (text.empty() || text.front() == '#' || text.front() == ' ' || colon == std::string_view::npos) return;
    const std::string_view value = trimmed(text.substr(colon + 1));
    const bool is_quoted = !value.empty() && (value.front() == '"' || value.front() == '\'');
    last_ = values_
                .emplace(trimmed(text.substr(0, colon)),
                         MapValue{is_quoted ? unquoted(value) : std::string(trimmed(value.substr(0, value.find(" #")))),
                                  line})
                .first;
  }

  std::filesystem::path file_;
  std::map<std::string, MapValue, std::less<>> values_;
  std::map<std::string, MapValue, std::less<>>::iterator last_ = values_.end();
};

// "[x, y, yaw]", metres and radians: the pose of the lower left corner.
glm::dmat4 origin_of(const MapFile& map) {
  const MapValue& value = map.require("origin", "[x, y, yaw]");
  std::string text = value.text;
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  for (char& c : text) c = c == ',' ? ' ' : c;
  std::array<double, 3> numbers{};
  bool valid = value.text.starts_with('[') && parse_numbers(text, numbers);
  for (const double number : numbers) valid = valid && std::abs(number) <= kMaxCoordinate_m;
  if (!valid) map.refuse("origin", value, "[x, y, yaw] in metres and radians");
  const double s = std::sin(numbers[2]), c = std::cos(numbers[2]);
  return {c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, numbers[0], numbers[1], 0, 1};
}

// How the shades of the picture say what is occupied, in the words of map_server.
enum class MapMode : std::uint8_t { trinary, scale, raw };

MapMode mode_of(const MapFile& map) {
  if (!map.has("mode") || map.text("mode") == "trinary") return MapMode::trinary;
  if (map.text("mode") == "scale") return MapMode::scale;
  if (map.text("mode") == "raw") return MapMode::raw;
  map.refuse("mode", map.require("mode", "trinary, scale or raw"), "trinary, scale or raw");
}

// The probability that a pixel is occupied, as map_server reads it; below 0: unknown. With `trinary`, the alpha of a
// picture that has transparent pixels counts as a fourth colour.
class PixelReader {
 public:
  PixelReader(const MapFile& map, const Texture& picture) : mode_(mode_of(map)), negate_(map.flag("negate")) {
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) has_alpha_ = has_alpha_ || picture.rgba[i] != kOpaque;
  }

  double occupancy(const std::uint8_t* rgba) const {
    const int color = rgba[0] + rgba[1] + rgba[2];
    if (mode_ == MapMode::trinary && has_alpha_) return from_shade((color + rgba[3]) / (4.0 * kOpaque));
    if (mode_ == MapMode::scale && rgba[3] != kOpaque) return kUnknown;
    if (mode_ != MapMode::raw) return from_shade(color / (3.0 * kOpaque));
    const double percent = color / 3.0;
    return percent <= 100 ? percent / 100 : kUnknown;
  }

 private:
  static constexpr int kOpaque = 255;
  static constexpr double kUnknown = -1;

  double from_shade(double shade) const { return negate_ ? shade : 1 - shade; }

  MapMode mode_;
  bool negate_, has_alpha_ = false;
};

CellGrid read_cells(const MapFile& map) {
  const Texture picture = map.picture();
  const PixelReader pixels(map, picture);
  const double threshold = map.number("occupied_thresh", kDefaultOccupied, 0, 1);
  CellGrid grid({picture.width, picture.height, 1});
  for (std::uint32_t row = 0; row < picture.height; ++row) {
    for (std::uint32_t column = 0; column < picture.width; ++column) {
      const std::size_t pixel = std::size_t{picture.height - 1 - row} * picture.width + column;
      if (pixels.occupancy(&picture.rgba[4 * pixel]) > threshold) grid.occupy({column, row, 0});
    }
  }
  return grid;
}

PartContent import_ros_map(const ImportRequest& request, ContentPool& pool) {
  const MapFile map(request.file);
  const double cell_m = map.number("resolution", std::nullopt, kMinCell_m, kMaxCell_m);
  const glm::dmat4 origin = origin_of(map);
  const double height_m = request.wall_height_m;
  return grid_part(request.file, {read_cells(map), {cell_m, cell_m, height_m}, height_m, origin}, pool);
}

const PartImporterRegistration ros_map_registration({".yaml", ".yml"}, import_ros_map);

}  // namespace
}  // namespace simvis
