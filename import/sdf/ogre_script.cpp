#include "import/sdf/ogre_script.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "engine/base/input_file.h"

namespace simvis {
namespace {

struct GazeboColor {
  std::string_view name;  // behind "Gazebo/"
  glm::dvec4 diffuse;
  bool glows = false;
};

// The materials without pictures of src/rendering/MaterialParser/gazebo.material in gz-sim (commit 93bbf3e, the list of
// Gazebo classic): the diffuse colour, with the alpha of the texture unit where there is one.
constexpr GazeboColor kGazeboColors[] = {
    {"Grey", {0.7, 0.7, 0.7, 1}},
    {"Gray", {0.7, 0.7, 0.7, 1}},
    {"DarkGrey", {0.175, 0.175, 0.175, 1}},
    {"DarkGray", {0.175, 0.175, 0.175, 1}},
    {"White", {1, 1, 1, 1}},
    {"FlatBlack", {0.1, 0.1, 0.1, 1}},
    {"Black", {0, 0, 0, 1}},
    {"Red", {1, 0, 0, 1}},
    {"RedBright", {0.87, 0.26, 0.07, 1}},
    {"Green", {0, 1, 0, 1}},
    {"Blue", {0, 0, 1, 1}},
    {"SkyBlue", {0, 0, 1, 1}},  // only its ambient colour is that of the sky
    {"Yellow", {1, 1, 0, 1}},
    {"DarkYellow", {0.7, 0.7, 0, 1}},
    {"ZincYellow", {0.9725, 0.9529, 0.2078, 1}},
    {"Purple", {1, 0, 1, 1}},
    {"Turquoise", {0, 1, 1, 1}},
    {"Orange", {1, 0.5088, 0.0468, 1}},
    {"Indigo", {0.33, 0, 0.5, 1}},
    {"Gold", {0.8, 0.64869, 0.120759, 1}},
    {"Pioneer2Body", {0.681193, 0.000923, 0.000923, 1}},
    {"WhiteGlow", {1, 1, 1, 1}, true},
    {"RedGlow", {1, 0, 0, 1}, true},
    {"GreenGlow", {0, 1, 0, 1}, true},
    {"BlueGlow", {0, 0, 1, 1}, true},
    {"YellowGlow", {1, 1, 0, 1}, true},
    {"PurpleGlow", {1, 0, 1, 1}, true},
    {"TurquoiseGlow", {0, 1, 1, 1}, true},
    {"LightOn", {0, 1, 0, 1}, true},
    {"LightOff", {1, 0, 0, 1}, true},
    {"RedTransparentOverlay", {1, 0, 0, 0.5}},
    {"GreenTransparentOverlay", {0, 1, 0, 0.5}},
    {"BlueTransparentOverlay", {0, 0, 1, 0.5}},
    {"OrangeTransparentOverlay", {1, 0.5088, 0.0468, 0.8}},
    {"DarkOrangeTransparentOverlay", {0.6, 0.305, 0.028, 0.8}},
    {"RedTransparent", {1, 0, 0, 0.5}},
    {"GreenTransparent", {0, 1, 0, 0.5}},
    {"BlueTransparent", {0, 0, 1, 0.5}},
    {"DarkMagentaTransparent", {0.6, 0, 0.6, 0.5}},
    {"GreyTransparent", {0.5, 0.5, 0.5, 0.5}},
    {"BlackTransparent", {0, 0, 0, 0.5}},
    {"YellowTransparent", {1, 1, 0, 0.5}},
    {"LightBlueLaser", {0.5, 0.5, 1, 0.4}},
    {"BlueLaser", {0, 0, 1, 0.4}},
    {"OrangeTransparent", {1, 0.44, 0, 0.4}},
};

constexpr std::size_t kMaxDerived = 8;  // materials that are derived from each other

// Words, braces and line ends, without comments.
std::vector<std::string_view> ogre_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (text.substr(i, 2) == "//") {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.substr(i, 2) == "/*") {
      const std::size_t end = text.find("*/", i + 2);
      i = end == std::string_view::npos ? text.size() : end + 2;
    } else if (c == '{' || c == '}' || c == '\n') {
      words.push_back(text.substr(i++, 1));
    } else if (c == ' ' || c == '\t' || c == '\r') {
      ++i;
    } else if (c == '"') {
      const std::size_t end = std::min(text.find_first_of("\"\n", i + 1), text.size());
      words.push_back(text.substr(i + 1, end - i - 1));
      i = std::min(end + 1, text.size());
    } else {
      const std::size_t end = std::min(text.find_first_of(" \t\r\n{}\"", i), text.size());
      words.push_back(text.substr(i, end - i));
      i = end;
    }
  }
  return words;
}

class OgreScript {
 public:
  explicit OgreScript(std::string_view text) : words_(ogre_words(text)) {}

  std::optional<OgreMaterial> find(std::string_view name, std::size_t derived = 0) const {
    for (std::size_t i = 0; i + 1 < words_.size(); ++i) {
      if (words_[i] != "material" || words_[i + 1] != name ||
          (i > 0 && words_[i - 1] != "\n" && words_[i - 1] != "}")) {
        continue;
      }
      i += 2;
      std::optional<OgreMaterial> base;
      if (word(i) == ":" && derived < kMaxDerived) base = find(word(i + 1), derived + 1);
      return read(i, base.value_or(OgreMaterial{}));
    }
    return std::nullopt;
  }

 private:
  std::string_view word(std::size_t i) const { return i < words_.size() ? words_[i] : std::string_view(); }

  // The numbers behind the word `i`, on its line.
  template <std::size_t size>
  std::size_t numbers(std::size_t i, std::array<double, size>& values) const {
    std::size_t count = 0;
    while (count < size && parse_number(word(i + 1 + count), values[count])) ++count;
    return count;
  }

  static std::optional<glm::dvec4> color(const std::array<double, 4>& v, std::size_t count) {
    if (count < 3) return std::nullopt;
    return glm::clamp(glm::dvec4(v[0], v[1], v[2], count == 4 ? v[3] : 1), 0.0, 1.0);
  }

  OgreMaterial read(std::size_t i, OgreMaterial material) const {
    int depth = 0;
    bool has_own_texture = false;
    for (; i < words_.size(); ++i) {
      const std::string_view key = words_[i];
      if (key == "{") ++depth;
      if (key == "}" && --depth <= 0) break;
      std::array<double, 4> v{};
      if (key == "diffuse" || key == "ambient") {
        if (const auto read = color(v, numbers(i, v))) (key == "diffuse" ? material.diffuse : material.ambient) = read;
      } else if (key == "emissive") {
        if (const auto read = color(v, numbers(i, v))) material.emissive = *read;
      } else if (key == "texture" && !has_own_texture && word(i + 1) != "\n") {
        material.texture = word(i + 1);
        has_own_texture = true;
      }
    }
    return material;
  }

  std::vector<std::string_view> words_;
};

}  // namespace

std::optional<OgreMaterial> find_gazebo_color(const std::string& name) {
  constexpr std::string_view kPrefix = "Gazebo/";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  const auto* const known =
      std::ranges::find(kGazeboColors, std::string_view(name).substr(kPrefix.size()), &GazeboColor::name);
  if (known == std::end(kGazeboColors)) return std::nullopt;
  OgreMaterial material;
  material.diffuse = known->diffuse;
  if (known->glows) material.emissive = known->diffuse;
  return material;
}

std::optional<OgreMaterial> find_ogre_material(const std::filesystem::path& script, const std::string& name) {
  try {
    const Bytes bytes = read_whole_file(script);
    return OgreScript({reinterpret_cast<const char*>(bytes.data()), bytes.size()}).find(name);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace simvis
