#include "import/mjcf/mjcf_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/philox.h>
#include "engine/base/srgb.h"
#include "import/mesh/picture_file.h"

namespace simvis {
namespace {

constexpr double kMaxBuiltinSide = 8192;                // pixels of a built-in picture
constexpr std::size_t kMaxStrip = 16384;                // pixels of the sides of a cube, one below the other
const glm::dvec3 kDefaultRgb1(0.8), kDefaultRgb2(0.5);  // MuJoCo's

// The sides of a cube in MuJoCo's order, which is that of OpenGL.
constexpr std::array<const char*, 6> kSideFiles = {"fileright", "fileleft",  "fileup",
                                                   "filedown",  "filefront", "fileback"};
constexpr std::string_view kSideLetters = "RLUDFB";
constexpr std::size_t kUp = 2, kDown = 3, kFront = 4;

// A built-in picture as the file describes it.
struct Builtin {
  std::string kind, mark;
  glm::dvec3 first{0}, second{0}, mark_color{0};
  std::uint32_t width = 1, height = 1;  // of one side
  double random = 0;                    // share of the pixels
  bool is_cube = false;
};

Builtin read_builtin(const MjcfElement& texture) {
  Builtin read{.kind = texture.text("builtin", "none"), .mark = texture.text("mark", "none")};
  read.is_cube = texture.text("type", "cube") != "2d";
  read.first = texture.vector("rgb1", kDefaultRgb1);
  read.second = texture.vector("rgb2", kDefaultRgb2);
  read.mark_color = texture.vector("markrgb", glm::dvec3(0));
  read.random = texture.number("random", 0.01);
  const double width = texture.number("width", 0), height = read.is_cube ? width : texture.number("height", 0);
  if (!(width >= 1 && width <= kMaxBuiltinSide && height >= 1 && height <= kMaxBuiltinSide)) {
    texture.fail("has a width or height that is not allowed, expected 1 to 8192");
  }
  read.width = static_cast<std::uint32_t>(width);
  read.height = static_cast<std::uint32_t>(height);
  return read;
}

// The share of the first of two colours at a position from -1 to 1, as MuJoCo rounds the ends.
double gradient_share(double position) {
  return std::clamp(0.5 * (1 + position / std::sqrt(1 + position * position) * std::numbers::sqrt2), 0.0, 1.0);
}

double centered(std::uint32_t pixel, std::uint32_t count) { return count > 1 ? 2.0 * pixel / (count - 1) - 1 : 0; }

// The colour at the elevation of the sky that a pixel of a side shows.
glm::dvec3 gradient_on_cube(const Builtin& of, std::size_t side, double x, double y) {
  const double length = std::sqrt(1 + x * x + y * y), quarter = std::numbers::pi / 2;
  const double up = 1 - std::acos(1 / length) / quarter;
  const double elevation = side == kUp ? up : (side == kDown ? -up : std::asin(y / length) / quarter);
  return glm::mix(of.second, of.first, gradient_share(elevation));
}

glm::dvec3 builtin_color(const Builtin& of, std::size_t side, std::uint32_t row, std::uint32_t column) {
  if (of.kind == "checker") {
    const bool is_first = (row < of.height / 2) == (column < of.width / 2);
    return is_first == (side < kFront) ? of.first : of.second;
  }
  if (of.kind != "gradient") return side == kDown ? of.second : of.first;
  const double x = centered(column, of.width), y = -centered(row, of.height);
  if (of.is_cube) return gradient_on_cube(of, side, x, y);
  return glm::mix(of.first, of.second, gradient_share(2 * std::sqrt(x * x + y * y) - 1));
}

bool is_marked(const Builtin& of, std::uint32_t row, std::uint32_t column) {
  if (of.mark == "edge") return row == 0 || column == 0 || row + 1 == of.height || column + 1 == of.width;
  return of.mark == "cross" && (row == of.height / 2 || column == of.width / 2);
}

void add_texel(const glm::dvec3& color, Texture& picture) {
  for (int i = 0; i < 3; ++i) {
    picture.rgba.push_back(static_cast<std::uint8_t>(255 * std::clamp(color[i], 0.0, 1.0)));
  }
  picture.rgba.push_back(255);
}

Texture draw(const Builtin& of, std::size_t sides, const std::string& name) {
  Texture picture;
  picture.name = name;
  picture.width = of.width;
  picture.height = of.height * static_cast<std::uint32_t>(sides);
  picture.rgba.reserve(std::size_t{4} * picture.width * picture.height);
  const SensorRandom random(0, name);
  for (std::size_t side = 0; side < sides; ++side) {
    for (std::uint32_t row = 0; row < of.height; ++row) {
      for (std::uint32_t column = 0; column < of.width; ++column) {
        const auto texel = static_cast<std::uint32_t>(picture.rgba.size() / 4);
        const bool has_mark =
            of.mark == "random" ? random.uniform(0, texel, 0) < of.random : is_marked(of, row, column);
        add_texel(has_mark ? of.mark_color : builtin_color(of, side, row, column), picture);
      }
    }
  }
  return picture;
}

// Of each side of a cube, the file, and where in it a square stands; none: it has one colour.
struct SideSource {
  std::filesystem::path file{};
  std::uint32_t row = 0, column = 0;
};

struct CubeFiles {
  std::array<SideSource, 6> sides;
  std::uint32_t columns = 1;  // of squares in a file
  glm::dvec3 color{0};
};

CubeFiles files_of_cube(const MjcfElement& texture) {
  const MjcfModel& model = texture.model();
  CubeFiles cube{.sides = {}, .columns = 1, .color = texture.vector("rgb1", kDefaultRgb1)};
  const std::string file = texture.text("file");
  if (file.empty()) {
    for (std::size_t i = 0; i < 6; ++i) {
      const std::string own = texture.text(kSideFiles[i]);
      if (!own.empty()) cube.sides[i].file = model.asset_file(texture, model.texture_folder, own);
    }
    return cube;
  }
  const std::vector<double> grid = texture.numbers("gridsize", 2, 2);
  const std::string layout = texture.text("gridlayout");
  const double squares = grid.empty() ? 0 : grid[0] * grid[1];
  if (!(squares >= 1 && squares <= 12 && grid[0] > 0 && grid[0] == std::floor(grid[0]) &&
        grid[1] == std::floor(grid[1]) && static_cast<double>(layout.size()) >= squares)) {
    texture.fail("has a gridsize and a gridlayout that do not fit, expected up to 12 squares and a letter for each");
  }
  cube.columns = static_cast<std::uint32_t>(grid[1]);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(squares); ++i) {
    const std::size_t side = kSideLetters.find(layout[i]);
    if (side == std::string_view::npos) continue;
    cube.sides[side] = {model.asset_file(texture, model.texture_folder, file), i / cube.columns, i % cube.columns};
  }
  return cube;
}

// One square below the other.
Texture join_sides(const CubeFiles& cube, const std::string& name) {
  std::map<std::filesystem::path, Texture> read;
  std::uint32_t width = 0;
  for (const SideSource& side : cube.sides) {
    if (side.file.empty()) continue;
    auto [known, is_new] = read.try_emplace(side.file);
    if (is_new) known->second = read_picture_file(side.file);
    const std::uint32_t own = known->second.width / cube.columns;
    const bool fits = own > 0 && known->second.height >= own * (side.row + 1) && (width == 0 || width == own);
    if (!fits) throw InputError(side.file.string() + ": error: has no squares of the size of the other sides");
    if (6 * std::size_t{own} > kMaxStrip) throw InputError(side.file.string() + ": error: is too large for a cube");
    width = own;
  }
  Texture picture;
  picture.name = name;
  picture.width = width;
  picture.height = 6 * width;
  for (const SideSource& side : cube.sides) {
    for (std::uint32_t row = 0; row < width; ++row) {
      if (side.file.empty()) {
        for (std::uint32_t i = 0; i < width; ++i) add_texel(cube.color, picture);
        continue;
      }
      const Texture& from = read.at(side.file);
      const std::size_t at = 4 * (std::size_t{side.row * width + row} * from.width + side.column * width);
      picture.rgba.insert(picture.rgba.end(), from.rgba.begin() + static_cast<std::ptrdiff_t>(at),
                          from.rgba.begin() + static_cast<std::ptrdiff_t>(at + 4 * std::size_t{width}));
    }
  }
  return picture;
}

CubeSides sides_of(const MjcfElement& texture) {
  if (texture.text("type", "cube") == "2d") return CubeSides::none;
  const std::string builtin = texture.text("builtin", "none");
  if (builtin == "none") {
    const std::vector<double> grid = texture.numbers("gridsize", 2, 2);
    const bool has_grid = !grid.empty() && grid[0] * grid[1] > 1;
    return texture.text("file").empty() || has_grid ? CubeSides::own : CubeSides::equal;
  }
  const bool is_plain =
      builtin == "flat" && texture.vector("rgb1", kDefaultRgb1) == texture.vector("rgb2", kDefaultRgb2);
  return is_plain ? CubeSides::equal : CubeSides::own;
}

}  // namespace

MjcfPicture mjcf_picture(const MjcfElement& texture, PictureUse use, ContentPool& pool, ImportReport& report) {
  MjcfPicture made{.picture = nullptr, .sides = sides_of(texture)};
  const std::string name = texture.written("name").value_or(texture.text("file"));
  std::function<Texture()> read;
  if (texture.text("builtin", "none") != "none") {
    const std::size_t sides = std::max<std::size_t>(static_cast<std::size_t>(made.sides), 1);
    const Builtin builtin = read_builtin(texture);
    if (sides * builtin.height > kMaxStrip) {
      texture.fail("has a width that is too large for a cube, expected up to 2730");
    }
    read = [builtin, sides, name] { return draw(builtin, sides, name); };
  } else if (made.sides == CubeSides::own) {
    const CubeFiles cube = files_of_cube(texture);
    const bool has_file = std::ranges::any_of(cube.sides, [](const SideSource& side) { return !side.file.empty(); });
    if (!has_file) texture.fail("has neither a file nor \"builtin\"");
    read = [cube, name] { return join_sides(cube, name); };
  } else {
    const std::string file = texture.text("file");
    if (file.empty()) texture.fail("has neither a file nor \"builtin\"");
    const MjcfModel& model = texture.model();
    read = [path = model.asset_file(texture, model.texture_folder, file)] {
      Texture picture = read_picture_file(path);
      picture.name = path.filename().string();
      return picture;
    };
  }
  const auto try_to_read = [read, place = to_string(texture.at())](std::vector<std::string>& warnings) {
    std::optional<Texture> picture;
    try {
      picture = read();
    } catch (const InputError& error) {
      warnings.push_back(place + ": " + without_word_error(error.what()) + "; the material's colour replaces it");
    }
    return picture;
  };
  std::vector<std::string> warnings;
  made.picture = pool.picture({.read = try_to_read, .use = use}, warnings);
  for (std::string& warning : warnings) report.warn(std::move(warning));
  return made;
}

std::optional<glm::dvec3> mjcf_background(const MjcfModel& model, ImportReport& report) {
  for (const MjcfElement& section : model.sections("asset")) {
    for (const MjcfElement& asset : section.children()) {
      if (asset.tag() != "texture" || asset.text("type", "cube") != "skybox") continue;
      const std::string builtin = asset.text("builtin", "none");
      if (builtin == "none") {
        report.leave_out("sky box of pictures", asset.at());
        continue;
      }
      const glm::dvec3 first = asset.vector("rgb1", kDefaultRgb1), second = asset.vector("rgb2", kDefaultRgb2);
      const glm::dvec3 horizon = glm::clamp(builtin == "flat" ? first : 0.5 * (first + second), 0.0, 1.0);
      return glm::dvec3(decode_srgb(horizon.x), decode_srgb(horizon.y), decode_srgb(horizon.z));
    }
  }
  return std::nullopt;
}

}  // namespace simvis
