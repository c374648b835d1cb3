#include "import/programs/obj_text.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/mesh/picture_file.h"
#include "import/programs/repeated_warning.h"
#include "import/programs/utf16_text.h"

namespace simvis {
namespace {

constexpr std::string_view kSpaces = " \t\r\n\v\f";

struct ObjText {
  std::string text;
  bool is_converted = false;  // it is not what the file holds
};

// Assimp takes a byte order mark for a part of the first word.
ObjText read_text(const std::filesystem::path& path, AssimpFile& file) {
  const Bytes bytes = read_whole_file(path);
  ObjText read{.text = {bytes.begin(), bytes.end()}};
  if (const std::optional<Utf16> order = utf16_of(read.text)) {
    read.text = utf8_of_utf16(read.text, *order);
    read.is_converted = true;
    file.warn_at({.file = path.string()}, "is text in UTF-16, which few programs read");
  }
  if (read.text.starts_with(kUtf8Mark)) {
    read.text.erase(0, kUtf8Mark.size());
    read.is_converted = true;
  }
  return read;
}

// Lines with their ends, so that joining them gives the text again.
std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return lines;
}

// Removes the first word from `line` and returns it.
std::string_view take_word(std::string_view& line) {
  const std::size_t start = line.find_first_not_of(kSpaces);
  if (start == std::string_view::npos) return line = {};
  const std::size_t end = std::min(line.find_first_of(kSpaces, start), line.size());
  const std::string_view word = line.substr(start, end - start);
  line.remove_prefix(end);
  return word;
}

std::string_view first_word(std::string_view line) { return take_word(line); }

// "1/2/3" -> "1//3", "1/2" -> "1"
std::string without_texture_coordinate(std::string_view corner) {
  const std::size_t first = corner.find('/');
  if (first == std::string_view::npos) return std::string(corner);
  const std::size_t second = corner.find('/', first + 1);
  const std::string vertex(corner.substr(0, first));
  return second == std::string_view::npos ? vertex : vertex + "/" + std::string(corner.substr(second));
}

bool names_texture_coordinate(std::string_view corner) {
  const std::size_t slash = corner.find('/');
  return slash != std::string_view::npos && slash + 1 < corner.size() && corner[slash + 1] != '/';
}

bool is_flat_vertex(std::string_view line) {
  if (take_word(line) != "v") return false;
  take_word(line);
  return !take_word(line).empty() && take_word(line).empty();
}

// Lines at which Assimp refuses a whole file; 0: there are none.
struct ObjOddities {
  int face = 0;         // the first that names texture coordinates, if the file has none
  int flat_vertex = 0;  // the first with two coordinates
};

ObjOddities oddities_of(const std::string& obj) {
  std::istringstream stream(obj);
  std::string text;
  ObjOddities first;
  bool has_coordinates = false;
  for (int number = 1; std::getline(stream, text); ++number) {
    std::string_view line = text;
    const std::string_view word = take_word(line);
    has_coordinates = has_coordinates || word == "vt";
    if (first.face == 0 && word == "f" && names_texture_coordinate(first_word(line))) first.face = number;
    if (first.flat_vertex == 0 && word == "v" && is_flat_vertex(text)) first.flat_vertex = number;
  }
  if (has_coordinates) first.face = 0;
  return first;
}

// One `d` or `Tr` of a material.
struct Written {
  double value = 0;
  int line = 0;  // counts from 1; 0: not written
};

struct MtlMaterial {
  std::string name;
  Written dissolve, transparency;
  bool is_rewritten = false;
  double opacity = 1;
};

class MtlOpacities {
 public:
  MtlOpacities(const std::filesystem::path& mtl, AssimpFile& file)
      : mtl_(mtl.string()), file_(file), text_(read_text(mtl, file)), lines_(lines_of(text_.text)) {
    check_start();
  }

  std::optional<std::string> prepared() {
    read();
    bool is_changed = text_.is_converted;
    for (MtlMaterial& material : materials_) {
      decide(material);
      is_changed = is_changed || material.is_rewritten;
    }
    meshlab_.give(file_, "material", "MeshLab writes the opacity as Tr; it is read so");
    contradictory_.give(file_, "material", "d and Tr contradict each other; d is taken");
    clear_.give(file_, "material", "is wholly transparent; it is read as opaque");
    if (!is_changed) return std::nullopt;
    return written();
  }

 private:
  // Assimp 5.2 dereferences a null pointer if a material file sets a property before it names a material.
  void check_start() const {
    for (const std::string_view line : lines_) {
      const std::string_view word = first_word(line);
      if (word.empty() || word.starts_with('#')) continue;
      if (word == "newmtl") return;
      throw std::runtime_error(mtl_ + ": begins with " + in_quotes(word) + ", expected \"newmtl\"");
    }
  }

  void read() {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      std::string_view line = lines_[i];
      const std::string_view word = take_word(line);
      is_of_meshlab_ = is_of_meshlab_ || (word == "#" && line.find("Meshlab") != std::string_view::npos);
      if (word == "newmtl") materials_.emplace_back().name = first_word(line);
      if (materials_.empty() || (word != "d" && word != "Tr")) continue;
      std::string_view value = take_word(line);
      if (value == "-halo") value = take_word(line);
      Written& written = word == "d" ? materials_.back().dissolve : materials_.back().transparency;
      if (parse_number(value, written.value)) written.line = static_cast<int>(i) + 1;
    }
  }

  void decide(MtlMaterial& material) {
    const Written &dissolve = material.dissolve, &transparency = material.transparency;
    const int line = dissolve.line > 0 ? dissolve.line : transparency.line;
    if (line == 0) return;
    material.opacity = dissolve.line > 0 ? dissolve.value : 1 - transparency.value;
    const Location where{.file = mtl_, .line = line};
    constexpr double kRounding = 1e-3;  // of numbers with three decimals
    if (dissolve.line == 0 && is_of_meshlab_ && transparency.value != material.opacity) {
      material.opacity = transparency.value;
      material.is_rewritten = true;
      meshlab_.add(where, material.name);
    }
    if (dissolve.line > 0 && transparency.line > 0 && std::abs(dissolve.value + transparency.value - 1) > kRounding) {
      material.is_rewritten = true;
      contradictory_.add(where, material.name);
    }
    if (material.opacity >= 0 && material.opacity < kWhollyTransparent) {
      material.opacity = 1;
      material.is_rewritten = true;
      clear_.add(where, material.name);
    }
  }

  std::string written() const {
    std::string text;
    auto material = materials_.begin();
    bool is_before_first = true;
    for (const std::string_view line : lines_) {
      const std::string_view word = first_word(line);
      if (word == "newmtl") {
        if (!is_before_first) ++material;
        is_before_first = false;
      }
      const bool is_rewritten = !is_before_first && material->is_rewritten;
      if (!is_rewritten || (word != "d" && word != "Tr")) text += line;
      if (is_rewritten && word == "newmtl") text += "d " + format_number(material->opacity) + "\n";
    }
    return text;
  }

  std::string mtl_;
  AssimpFile& file_;
  ObjText text_;
  std::vector<std::string_view> lines_;
  std::vector<MtlMaterial> materials_;
  bool is_of_meshlab_ = false;
  RepeatedWarning meshlab_, contradictory_, clear_;
};

}  // namespace

std::optional<std::string> prepared_obj(AssimpFile& file) {
  ObjText read = read_text(file.file, file);
  const ObjOddities first = oddities_of(read.text);
  const std::string name = file.file.string();
  if (first.face == 0 && first.flat_vertex == 0) {
    return read.is_converted ? std::optional(std::move(read.text)) : std::nullopt;
  }
  if (first.face > 0) {
    file.warn_at({.file = name, .line = first.face},
                 "faces name texture coordinates, but the file has none; they are left out");
  }
  if (first.flat_vertex > 0) {
    file.warn_at({.file = name, .line = first.flat_vertex}, "vertices have two coordinates; the third is taken as 0");
  }
  std::string prepared, text;
  std::istringstream stream(read.text);
  while (std::getline(stream, text)) {
    std::string_view line = text;
    const std::string_view word = take_word(line);
    if (word == "v" && is_flat_vertex(text)) {
      prepared += "v " + std::string(take_word(line));
      prepared += " " + std::string(take_word(line)) + " 0";
    } else if (word == "f" && first.face > 0) {
      prepared += "f";
      for (std::string_view corner = take_word(line); !corner.empty(); corner = take_word(line)) {
        prepared += " " + without_texture_coordinate(corner);
      }
    } else {
      prepared += text;
    }
    prepared += "\n";
  }
  return prepared;
}

std::optional<std::string> prepared_mtl(const std::filesystem::path& mtl, AssimpFile& file) {
  return MtlOpacities(mtl, file).prepared();
}

}  // namespace simvis
