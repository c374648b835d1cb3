#include "import/programs/meshes/stl_file.h"

#include <strings.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "engine/base/words.h"
#include "import/programs/clouds/point_columns.h"
#include "import/programs/meshes/polygon_meshes.h"
#include "import/programs/meshes/text_lines.h"

namespace simvis {
namespace {

constexpr std::size_t kHeaderBytes = 84, kTitleBytes = 80, kFacetBytes = 50, kAttributeAt = 48;
constexpr std::string_view kStlSpaces = " \t\r\n", kSolid = "solid";

using Corners = std::array<PolygonCorner, 3>;

// A scene with one material, and a node for each solid below the root.
class StlScene {
 public:
  explicit StlScene(PartSource& source) : source_(source) { scene_.nodes.emplace_back(); }

  void add_solid(const std::string& name) {
    end_solid();
    ImportedNode& node = scene_.nodes.emplace_back();
    node.name = name;
    node.parent = 0;
    meshes_.emplace(source_, name);
  }

  void add(Corners& corners, const glm::vec3& normal) {
    for (PolygonCorner& corner : corners) {
      corner.position = corner_position(source_, vertices_++, corner.position);
      corner.attributes.normal = corner_normal(normal);
    }
    meshes_->add(corners);
  }

  ImportedScene take(const std::string& root_name) {
    end_solid();
    if (scene_.meshes.empty()) source_.fail("holds nothing to draw");
    scene_.nodes[0].name = root_name;
    ImportedMaterial& material = scene_.materials.emplace_back();
    material.is_fallback = true;
    material.material.double_sided = true;
    scene_.warnings = source_.warnings;
    return std::move(scene_);
  }

 private:
  void end_solid() {
    if (!meshes_) return;
    for (Mesh& mesh : meshes_->take()) {
      scene_.nodes.back().shapes.push_back({static_cast<std::uint32_t>(scene_.meshes.size()), 0});
      scene_.meshes.push_back(std::move(mesh));
    }
    meshes_.reset();
    vertices_ = 0;
  }

  PartSource& source_;
  ImportedScene scene_;
  std::optional<PolygonMeshes> meshes_;  // of the solid
  std::size_t vertices_ = 0;             // of the solid
};

class StlBinary {
 public:
  StlBinary(PartSource& source, std::string_view bytes) : source_(source), bytes_(bytes) {}

  ImportedScene read() {
    if (bytes_.size() == kHeaderBytes) source_.fail("holds nothing to draw");
    StlScene scene(source_);
    scene.add_solid("");
    read_marks();
    for (std::size_t i = 0; i < facets(); ++i) {
      Corners corners;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        corners[k].position = vector(3 * (k + 1), i);
        if (has_colors_) corners[k].attributes.color = corner_color(source_, color(i));
      }
      scene.add(corners, vector(0, i));
    }
    return scene.take("<STL_BINARY>");
  }

 private:
  std::size_t facets() const { return (bytes_.size() - kHeaderBytes) / kFacetBytes; }

  double number(std::size_t at, NumberType type, std::size_t facet) const {
    return PointColumn{reinterpret_cast<const std::uint8_t*>(bytes_.data()) + at, kFacetBytes, type}.at(facet);
  }

  glm::vec3 vector(std::size_t first, std::size_t facet) const {
    glm::vec3 v;
    for (std::size_t i = 0; i < 3; ++i) {
      v[static_cast<int>(i)] = static_cast<float>(number(kHeaderBytes + 4 * (first + i), {}, facet));
    }
    return v;
  }

  // The two bytes behind a facet. The upper bit marks a colour of 15 bits (VisCAM, SolidView, Magics).
  unsigned attribute(std::size_t facet) const {
    return static_cast<unsigned>(number(kHeaderBytes + kAttributeAt, {NumberType::Kind::natural, 2}, facet));
  }

  void read_marks() {
    constexpr std::string_view kMagics = "COLOR=";
    const std::size_t found = bytes_.substr(0, kTitleBytes).find(kMagics);
    is_magics_ = found != std::string_view::npos;
    if (is_magics_) {
      for (std::size_t i = 0; i < 4; ++i) {
        const auto value = static_cast<unsigned char>(bytes_[found + kMagics.size() + i]);
        default_color_[static_cast<int>(i)] = value * (1.0f / 255);
      }
    }
    bool is_marked = false;
    for (std::size_t i = 0; i < facets(); ++i) {
      is_marked = is_marked || (attribute(i) & kMark) != 0;
      has_colors_ = has_colors_ || ((attribute(i) & kMark) != 0 && (is_magics_ || attribute(i) != kMark));
    }
    if (is_marked && !has_colors_) {
      source_.warn("facets are marked as coloured, but every colour is 0; no colour is read");
    }
  }

  glm::vec4 color(std::size_t facet) const {
    const unsigned bits = attribute(facet);
    if ((bits & kMark) == 0) return default_color_;
    const auto channel = [&](unsigned first_bit) { return static_cast<float>(bits >> first_bit & 31) * (1.0f / 31); };
    const glm::vec4 color(channel(10), channel(5), channel(0), 1);
    return is_magics_ ? glm::vec4(color.b, color.g, color.r, 1) : color;
  }

  static constexpr unsigned kMark = 0x8000;

  PartSource& source_;
  std::string_view bytes_;
  bool is_magics_ = false, has_colors_ = false;
  glm::vec4 default_color_{0.6f};
};

class StlText {
 public:
  StlText(PartSource& source, std::string_view text) : source_(source), text_(text) {}

  ImportedScene read() {
    StlScene scene(source_);
    for (std::string_view word = next(); !word.empty(); word = next()) {
      if (!is_open_) {
        if (is(word.substr(0, kSolid.size()), kSolid)) begin_solid(scene, word);
      } else if (is(word, "endsolid")) {
        end_facet();
        is_open_ = false;
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else {
        read_word(scene, word);
      }
    }
    end_facet();
    return scene.take(has_nameless_ ? "<STL_ASCII>" : "");
  }

 private:
  std::string_view next(std::string_view spaces = kStlSpaces) {
    while (at_ < text_.size() && spaces.find(text_[at_]) != std::string_view::npos) line_ += text_[at_++] == '\n';
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(kStlSpaces, at_), text_.size());
    return text_.substr(begin, at_ - begin);
  }

  // The name is the first word behind "solid".
  void begin_solid(StlScene& scene, std::string_view word) {
    is_open_ = true;
    word.remove_prefix(kSolid.size());
    const std::string name(word.empty() ? next(" \t") : word);
    at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());  // a name may have several words
    has_nameless_ = has_nameless_ || name.empty();
    scene.add_solid(name);
  }

  void read_word(StlScene& scene, std::string_view word) {
    if (is(word, "facet")) {
      end_facet();
      count_ = 0;
      facet_line_ = line_;
      normal_ = glm::vec3(0);
    } else if (is(word, "endfacet")) {
      end_facet();
    } else if (is(word, "normal")) {
      normal_ = vector("a normal");
    } else if (is(word, "vertex")) {
      if (count_ == 3) fail(line_, "a facet has more than 3 vertices, or a vertex is in no facet");
      corners_[count_++].position = vector("a vertex");
      if (count_ == 3) scene.add(corners_, normal_);
    } else if (!is(word, "outer") && !is(word, "loop") && !is(word, "endloop")) {
      fail(line_, "has " + shown_word(word) +
                      ", expected one of facet, normal, outer, loop, vertex, endloop, endfacet, endsolid");
    }
  }

  static bool is(std::string_view word, std::string_view keyword) {
    return word.size() == keyword.size() && ::strncasecmp(word.data(), keyword.data(), keyword.size()) == 0;
  }

  void end_facet() const {
    if (count_ == 3) return;
    fail(facet_line_, "a facet has " + std::to_string(count_) + " vertices, expected 3");
  }

  glm::vec3 vector(const std::string& subject) {
    glm::vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = number(subject);
    return v;
  }

  float number(const std::string& subject) {
    const std::string_view word = next();
    std::string text(word);
    std::ranges::replace(text, ',', '.');  // as some programs write in some languages
    const std::size_t sign = text.starts_with('+') ? 1 : 0;
    if (const std::optional<double> value = as_number<double>(std::string_view(text).substr(sign))) {
      return static_cast<float>(*value);
    }
    fail(line_, no_number(subject, word));
  }

  [[noreturn]] void fail(int line, const std::string& message) const {
    fail_at({.file = source_.file.string(), .line = line}, message);
  }

  PartSource& source_;
  std::string_view text_;
  std::size_t at_ = 0, count_ = 3;  // vertices of the facet; 3: none is open
  int line_ = 1, facet_line_ = 0;
  bool is_open_ = false, has_nameless_ = false;
  Corners corners_;
  glm::vec3 normal_{0};
};

// Returns whether the last line that is not empty begins with "endsolid".
bool ends_with_endsolid(std::string_view text) {
  const std::size_t last = text.find_last_not_of(kStlSpaces);
  if (last == std::string_view::npos) return false;
  text = text.substr(0, last + 1);
  const std::size_t line = text.find_last_of("\r\n");
  if (line != std::string_view::npos) text.remove_prefix(line + 1);
  const std::size_t start = text.find_first_not_of(kStlSpaces);
  return start != std::string_view::npos && text.substr(start).starts_with("endsolid");
}

}  // namespace

ImportedScene read_stl(const std::filesystem::path& file) {
  PartSource source{file};
  source.check_size();
  const Bytes bytes = read_whole_file(file);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::size_t facets = 0;
  if (bytes.size() >= kHeaderBytes) {
    constexpr NumberType kCount{NumberType::Kind::natural, 4};
    facets = static_cast<std::size_t>(PointColumn{bytes.data() + kTitleBytes, 0, kCount}.at(0));
    if (bytes.size() == kHeaderBytes + kFacetBytes * facets) return StlBinary(source, text).read();
  }
  const std::size_t word = text.substr(0, kHeaderBytes).find_first_not_of(kStlSpaces);
  if (word == std::string_view::npos || !text.substr(word).starts_with("solid")) {
    source.fail("has " + std::to_string(bytes.size()) + " bytes and claims " + std::to_string(facets) +
                " facets, expected binary STL of 84 bytes and 50 per facet, or text that begins with \"solid\"");
  }
  if (!ends_with_endsolid(text)) {
    source.fail("begins with \"solid\" but does not end with \"endsolid\": it is incomplete, or is not STL");
  }
  return StlText(source, text).read();
}

}  // namespace simvis
