#include "import/programs/meshes/mtl_file.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include "engine/base/words.h"
#include "import/mesh/picture_file.h"
#include "import/programs/meshes/text_lines.h"
#include "import/programs/repeated_warning.h"

namespace simvis {
namespace {

// `d` or `Tr` of a material.
struct Written {
  double value = 0;
  Location where{};  // line 0: not written
};

class MtlReader {
 public:
  MtlReader(PartSource& source, const std::filesystem::path& mtl, MtlMaterials& materials)
      : source_(source), lines_(source, mtl), materials_(materials) {}

  void read() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      std::string_view rest = *line;
      const std::string_view word = take_word(rest);
      if (word.starts_with('#')) {
        is_of_meshlab_ = is_of_meshlab_ || rest.find("Meshlab") != std::string_view::npos;
      } else if (word == "newmtl") {
        begin(std::string(rest));
      } else if (!word.empty()) {
        if (material_ == nullptr) fail("begins with " + in_quotes(word) + ", expected \"newmtl\"");
        read_property(word, rest);
      }
    }
    end();
    meshlab_.give(source_, "material", "MeshLab writes the opacity as Tr; it is read so");
    contradictory_.give(source_, "material", "d and Tr contradict each other; d is taken");
    clear_.give(source_, "material", "is wholly transparent; it is read as opaque");
    not_rgb_.give(source_, "material", "a colour that is not in RGB is left out");
    moved_.give(source_, "material", "the transformation of its picture is left out");
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { fail_at(lines_.where(), message); }
  std::string subject() const { return "material " + in_quotes(name_); }

  void begin(std::string name) {
    end();
    name_ = std::move(name);
    material_ = &materials_[name_];
    dissolve_ = transparency_ = {};
  }

  void read_property(std::string_view word, std::string_view rest) {
    if (word == "Kd") {
      material_->diffuse = color(rest);
    } else if (word == "Ke") {
      material_->emissive = color(rest);
    } else if (word == "d" || word == "Tr") {
      std::string_view value = take_word(rest);
      if (value == "-halo") value = take_word(rest);
      (word == "d" ? dissolve_ : transparency_) = {number(value), lines_.where()};
    } else if (word == "map_Kd") {
      material_->wrap = Wrap::repeat;
      material_->picture = picture(rest, material_->wrap);
    } else if (word == "map_d") {
      Wrap wrap{};
      material_->cut_out = picture(rest, wrap);
    }
  }

  double number(std::string_view word) const {
    double value = 0;
    if (parse_number(word, value)) return value;
    fail(no_number(subject(), word));
  }

  // One number is that of all three.
  glm::vec3 color(std::string_view rest) {
    std::vector<std::string_view> words = words_of(rest);
    const auto comment = std::ranges::find_if(words, [](std::string_view word) { return word.starts_with('#'); });
    words.erase(comment, words.end());
    if (words.empty()) fail(subject() + " has a colour without numbers");
    if (words[0] == "spectral" || words[0] == "xyz") {
      not_rgb_.add(lines_.where(), name_);
      return glm::vec3(0.6f);
    }
    glm::vec3 read;
    for (std::size_t i = 0; i < 3; ++i) {
      const double value = number(words[std::min(i, words.size() - 1)]);
      if (!(value >= 0)) fail(subject() + " has a colour that is negative or not finite");
      read[static_cast<int>(i)] = static_cast<float>(value);
    }
    return read;
  }

  // Behind the options. A name may have spaces; some programs write none for a material without a picture.
  std::string picture(std::string_view rest, Wrap& wrap) {
    bool is_moved = false;
    while (rest.starts_with('-')) {
      std::string_view behind = rest;
      const std::string_view option = take_word(behind);
      const std::string_view value = take_word(behind);
      if (value.empty()) break;  // a name that begins so
      if (option == "-clamp" && value == "on") wrap = Wrap::clamp_to_edge;
      is_moved = is_moved || option == "-o" || option == "-s";
      const bool is_vector = option == "-o" || option == "-s" || option == "-t";
      const int more = option == "-mm" ? 1 : is_vector ? 2 : 0;
      rest = behind;
      double unused = 0;
      for (int i = 0; i < more && parse_number(take_word(behind), unused); ++i) rest = behind;
    }
    if (is_moved && !rest.empty()) moved_.add(lines_.where(), name_);
    std::string name(rest);
    std::ranges::replace(name, '\\', '/');
    return name;
  }

  // Decides on the opacity of the material that ends here.
  void end() {
    const bool has_dissolve = dissolve_.where.line > 0, has_transparency = transparency_.where.line > 0;
    if (!has_dissolve && !has_transparency) return;
    const Location& where = has_dissolve ? dissolve_.where : transparency_.where;
    double opacity = has_dissolve ? dissolve_.value : 1 - transparency_.value;
    constexpr double kRounding = 1e-3;  // of numbers with three decimals
    if (!has_dissolve && is_of_meshlab_ && transparency_.value != opacity) {
      opacity = transparency_.value;
      meshlab_.add(where, name_);
    }
    if (has_dissolve && has_transparency && std::abs(dissolve_.value + transparency_.value - 1) > kRounding) {
      contradictory_.add(where, name_);
    }
    if (!(opacity >= 0 && opacity <= 1)) fail_at(where, subject() + " has an opacity outside 0 to 1");
    if (opacity < kWhollyTransparent) {
      opacity = 1;
      clear_.add(where, name_);
    }
    material_->opacity = opacity;
  }

  PartSource& source_;
  TextLines lines_;
  MtlMaterials& materials_;
  std::string name_;
  MtlMaterial* material_ = nullptr;  // of name_
  Written dissolve_, transparency_;
  bool is_of_meshlab_ = false;
  RepeatedWarning meshlab_, contradictory_, clear_, not_rgb_, moved_;
};

}  // namespace

void read_mtl(PartSource& source, const std::filesystem::path& mtl, MtlMaterials& materials) {
  MtlReader(source, mtl, materials).read();
}

}  // namespace simvis
