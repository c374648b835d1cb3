#include "import/mjcf/mjcf_pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <simvis/philox.h>
#include "engine/base/srgb.h"
#include "import/mesh/picture_file.h"

namespace simvis {
namespace {

constexpr double kMaxBuiltinSide = 8192;                // pixels of a built-in picture
const glm::dvec3 kDefaultRgb1(0.8), kDefaultRgb2(0.5);  // MuJoCo's

// A built-in picture as the file describes it.
struct Builtin {
  std::string kind, mark;
  glm::dvec3 first{0}, second{0}, mark_color{0};
  std::uint32_t width = 1, height = 1;
  double random = 0;     // share of the pixels
  bool is_cube = false;  // a side of one
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

glm::dvec3 builtin_color(const Builtin& of, std::uint32_t row, std::uint32_t column) {
  if (of.kind == "checker") return (row < of.height / 2) == (column < of.width / 2) ? of.first : of.second;
  if (of.kind != "gradient") return of.first;
  const double x = centered(column, of.width), y = -centered(row, of.height);
  if (!of.is_cube) return glm::mix(of.first, of.second, gradient_share(2 * std::sqrt(x * x + y * y) - 1));
  const double elevation = std::asin(y / std::sqrt(1 + x * x + y * y)) / (std::numbers::pi / 2);
  return glm::mix(of.second, of.first, gradient_share(elevation));
}

bool is_marked(const Builtin& of, std::uint32_t row, std::uint32_t column, const SensorRandom& random) {
  if (of.mark == "edge") return row == 0 || column == 0 || row + 1 == of.height || column + 1 == of.width;
  if (of.mark == "cross") return row == of.height / 2 || column == of.width / 2;
  return of.mark == "random" && random.uniform(0, row * of.width + column, 0) < of.random;
}

Texture draw(const Builtin& of, const std::string& name) {
  Texture picture;
  picture.name = name;
  picture.width = of.width;
  picture.height = of.height;
  picture.rgba.reserve(std::size_t{4} * of.width * of.height);
  const SensorRandom random(0, name);
  for (std::uint32_t row = 0; row < of.height; ++row) {
    for (std::uint32_t column = 0; column < of.width; ++column) {
      const glm::dvec3 color = is_marked(of, row, column, random) ? of.mark_color : builtin_color(of, row, column);
      for (int i = 0; i < 3; ++i) {
        picture.rgba.push_back(static_cast<std::uint8_t>(255 * std::clamp(color[i], 0.0, 1.0)));
      }
      picture.rgba.push_back(255);
    }
  }
  return picture;
}

// The file of one side, where sides have files of their own.
std::string file_of(const MjcfElement& texture) {
  for (const char* name : {"file", "fileright", "fileleft", "filefront", "fileback", "fileup", "filedown"}) {
    if (const std::string file = texture.text(name); !file.empty()) return file;
  }
  return "";
}

}  // namespace

std::shared_ptr<const Texture> mjcf_picture(const MjcfElement& texture, PictureUse use, ContentPool& pool,
                                            ImportReport& report) {
  const char* const kSides = "difference between the sides of a cube texture, which all show one picture,";
  const bool is_cube = texture.text("type", "cube") != "2d";
  PictureSource source{.read = {}, .use = use};
  const std::string name = texture.written("name").value_or("");
  if (texture.text("builtin", "none") != "none") {
    const Builtin builtin = read_builtin(texture);
    if (is_cube && (builtin.kind != "flat" || builtin.first != builtin.second)) report.leave_out(kSides, texture.at());
    source.read = [builtin, name](std::vector<std::string>&) { return std::optional(draw(builtin, name)); };
  } else {
    if (is_cube && (texture.text("file").empty() || texture.find("gridsize"))) report.leave_out(kSides, texture.at());
    const std::string named = file_of(texture);
    if (named.empty()) texture.fail("has neither \"file\" nor \"builtin\"");
    const MjcfModel& model = texture.model();
    source.read = [file = model.asset_file(model.texture_folder, named),
                   place = to_string(texture.at())](std::vector<std::string>& warnings) {
      std::optional<Texture> picture;
      try {
        picture = read_picture_file(file);
        picture->name = file.filename().string();
      } catch (const InputError& error) {
        warnings.push_back(place + ": " + without_word_error(error.what()) + "; the material's colour replaces it");
      }
      return picture;
    };
  }
  std::vector<std::string> warnings;
  auto picture = pool.picture(std::move(source), warnings);
  for (std::string& warning : warnings) report.warn(std::move(warning));
  return picture;
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
