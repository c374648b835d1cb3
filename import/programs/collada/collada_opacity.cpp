#include "import/programs/collada/collada_opacity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include "import/mesh/picture_file.h"
#include "import/programs/repeated_warning.h"

namespace simvis {
namespace {

// Parts of the <authoring_tool> of exporters that write 1 - opacity as <transparency> without an `opaque` attribute.
constexpr std::string_view kInvertingTools[] = {"FBX COLLADA exporter", "FCollada", "Illusoft Collada Exporter",
                                                "SketchUp"};
// Sums and products of a few decimals round by far less.
constexpr double kRounding = 1e-6;
constexpr std::string_view kShaders[] = {"blinn", "constant", "lambert", "phong"};

// Numbers separated by white space, with a point or a comma before the decimals. Stops at what is no number.
std::vector<double> numbers_of(std::string text) {
  std::ranges::replace(text, ',', '.');
  std::vector<double> numbers;
  const char *at = text.data(), *end = text.data() + text.size();
  while (true) {
    while (at < end && std::string_view(" \t\r\n").find(*at) != std::string_view::npos) ++at;
    double number = 0;
    const auto [rest, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return numbers;
    numbers.push_back(number);
    at = rest;
  }
}

// COLLADA 1.4.1, "Determining transparency": the luminance that the modes RGB_... multiply with the transparency.
double luminance(const std::array<double, 4>& color) {
  return 0.212671 * color[0] + 0.715160 * color[1] + 0.072169 * color[2];
}

// What one shader says about its opacity.
struct Opacity {
  std::string mode = "A_ONE";
  std::array<double, 4> color{1, 1, 1, 1};
  double transparency = 1;

  double value() const {
    const bool of_colors = mode.starts_with("RGB");
    const double factor = transparency * (of_colors ? luminance(color) : color[3]);
    return mode.ends_with("ZERO") ? 1 - factor : factor;
  }
};

// Returns nothing if the numbers cannot be read.
std::optional<Opacity> read_opacity(const pugi::xml_node& shader) {
  Opacity opacity;
  const pugi::xml_node transparent = shader.child("transparent"), transparency = shader.child("transparency");
  if (!transparent && !transparency) return std::nullopt;
  opacity.mode = transparent.attribute("opaque").as_string("A_ONE");
  if (transparent.child("color")) {
    const std::vector<double> color = numbers_of(transparent.child_value("color"));
    if (color.size() != opacity.color.size()) return std::nullopt;
    std::ranges::copy(color, opacity.color.begin());
  }
  if (transparency) {
    const std::vector<double> factor = numbers_of(transparency.child_value("float"));
    opacity.transparency = factor.empty() ? 0 : factor[0];
  }
  return opacity;
}

pugi::xml_node child_or_new(pugi::xml_node parent, const char* name) {
  const pugi::xml_node child = parent.child(name);
  return child ? child : parent.append_child(name);
}

// Writes the opacity in the one form that every reader takes alike. A texture in <transparent> stays.
void write_opacity(pugi::xml_node shader, double value) {
  pugi::xml_node transparent = child_or_new(shader, "transparent");
  transparent.remove_attribute("opaque");
  transparent.append_attribute("opaque").set_value("A_ONE");
  if (pugi::xml_node color = transparent.child("color")) color.text().set("1 1 1 1");
  pugi::xml_node transparency = child_or_new(shader, "transparency");
  while (transparency.remove_child(transparency.first_child())) {
  }
  transparency.append_child("float").text().set(format_number(value).c_str());
}

class OpacityReader {
 public:
  OpacityReader(XmlText& text, AssimpFile& file) : text_(text), file_(file) {
    const pugi::xml_node asset = text.document().child("COLLADA").child("asset");
    for (const pugi::xml_node& contributor : asset.children("contributor")) {
      const std::string tool = contributor.child_value("authoring_tool");
      const auto is_named = [&tool](std::string_view name) { return tool.find(name) != std::string::npos; };
      if (tool_.empty() && std::ranges::any_of(kInvertingTools, is_named)) tool_ = tool;
    }
  }

  void run() {
    for (const pugi::xml_node& library : text_.document().child("COLLADA").children("library_effects")) {
      for (const pugi::xml_node& effect : library.children("effect")) {
        for (const pugi::xml_node& technique : effect.child("profile_COMMON").children("technique")) {
          for (const pugi::xml_node& shader : technique.children()) read(effect, shader);
        }
      }
    }
    inverted_.give(file_, "effect",
                   "<transparent> names no \"opaque\" mode; " + in_quotes(tool_) +
                       " means RGB_ZERO there, so the opacity is 1 - transparency");
    clear_.give(file_, "effect", "is wholly transparent; it is read as opaque");
    outside_.give(file_, "effect", "has an opacity outside 0 to 1; it is read as opaque");
  }

 private:
  void read(const pugi::xml_node& effect, const pugi::xml_node& shader) {
    if (std::ranges::find(kShaders, std::string_view(shader.name())) == std::end(kShaders)) return;
    std::optional<Opacity> opacity = read_opacity(shader);
    if (!opacity) return;
    const pugi::xml_node transparent = shader.child("transparent");
    const Location where = text_.at(transparent ? transparent : shader.child("transparency"));
    const double by_text = opacity->value();
    if (!tool_.empty() && transparent && !transparent.attribute("opaque")) opacity->mode = "RGB_ZERO";
    double value = opacity->value();
    const bool is_outside = !(value >= -kRounding && value <= 1 + kRounding);
    const bool is_clear = !is_outside && value < kWhollyTransparent;
    if (std::abs(value - by_text) > kRounding) inverted_.add(where, effect.attribute("id").value());
    if (is_clear) clear_.add(where, effect.attribute("id").value());
    if (is_outside) outside_.add(where, effect.attribute("id").value());
    if (is_clear || is_outside) value = 1;
    if (std::abs(value - by_text) > kRounding) write_opacity(shader, value);
  }

  XmlText& text_;
  AssimpFile& file_;
  std::string tool_;  // the exporter, if it is one that inverts
  RepeatedWarning inverted_, clear_, outside_;
};

}  // namespace

void set_collada_opacities(XmlText& text, AssimpFile& file) { OpacityReader(text, file).run(); }

}  // namespace simvis
