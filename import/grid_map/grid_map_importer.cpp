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
#include <simvis/node.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/input_file.h"
#include "engine/base/words.h"
#include "import/grid_map/grid_walls.h"
#include "import/mesh/picture_file.h"
#include "import/mesh/shape_node.h"

namespace simvis {
namespace {

constexpr double kDefaultOccupied = 0.65;  // of map_server, as are the names of the keys
constexpr double kMaxCell_m = 1e6;

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

  void read_line(std::string_view text, std::size_t line) {
    if (read_list_line(text)) return;
    const std::size_t colon = text.find(':');
    if (text.empty() || text.front() == '#' || text.front() == ' ' || colon == std::string_view::npos) return;
    std::string_view value = trimmed(text.substr(colon + 1));
    if (!value.empty() && (value.front() == '"' || value.front() == '\'')) {
      const std::size_t end = value.find(value.front(), 1);
      value = value.substr(1, end == std::string_view::npos ? end : end - 1);
    } else {
      value = trimmed(value.substr(0, value.find(" #")));
    }
    last_ = values_.emplace(trimmed(text.substr(0, colon)), MapValue{std::string(value), line}).first;
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

OccupancyGrid read_cells(const MapFile& map) {
  const Texture texture = map.picture();
  const bool negate = map.number("negate", 0, 0, 1) != 0;
  const double threshold = map.number("occupied_thresh", kDefaultOccupied, 0, 1);
  OccupancyGrid grid{texture.width, texture.height, {}};
  grid.occupied.resize(std::size_t{grid.columns} * grid.rows);
  for (std::uint32_t row = 0; row < grid.rows; ++row) {
    for (std::uint32_t column = 0; column < grid.columns; ++column) {
      const std::uint8_t* const rgba =
          &texture.rgba[std::size_t{4} * (std::size_t{grid.rows - 1 - row} * grid.columns + column)];
      const double grey = (rgba[0] + rgba[1] + rgba[2]) / (3 * 255.0);
      grid.occupied[std::size_t{row} * grid.columns + column] = (negate ? grey : 1 - grey) > threshold;
    }
  }
  return grid;
}

PartContent import_grid_map(const ImportRequest& request, ContentPool& pool) {
  const MapFile map(request.file);
  const double cell_m = map.number("resolution", std::nullopt, 1e-6, kMaxCell_m);
  const glm::dmat4 origin = origin_of(map);
  std::optional<Mesh> walls = grid_walls(read_cells(map), cell_m, request.wall_height_m);
  if (!walls) {
    fail_at({.file = request.file.string()}, "has walls of more than " + std::to_string(kMaxWallRectangles) +
                                                 " rectangles, expected a map with less noise");
  }
  if (walls->indices.empty()) {
    fail_at({.file = request.file.string()}, "has no occupied cell, so that there is nothing to show");
  }
  const auto root = std::make_shared<Separator>();
  root->name = request.file.stem().string();
  if (origin != glm::dmat4(1)) root->add(std::make_shared<Transform>(origin));
  Material material;
  material.name = "wall";
  material.double_sided = true;
  const std::string name = material.name;
  const auto look = std::make_shared<MaterialNode>(pool.intern(std::move(material)));
  look->name = name;
  root->add(look);
  root->add(shape_node(std::move(*walls), pool));
  PartContent content;
  content.root = root;
  return content;
}

const PartImporterRegistration grid_map_registration({".yaml", ".yml"}, import_grid_map);

}  // namespace
}  // namespace simvis
