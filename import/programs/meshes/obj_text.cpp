#include "import/programs/meshes/obj_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <simvis/location.h>
#include "import/programs/meshes/text_lines.h"
#include "import/programs/polygon.h"

namespace simvis {
namespace {

constexpr std::string_view kSurfaces[] = {"curv", "curv2", "surf"};  // of curves and of free form

// A number beyond the range of float: nearly 0, or infinite. It has the syntax of a number.
float out_of_range(std::string_view word) {
  double value = 0;
  const bool fits_double = std::from_chars(word.data(), word.data() + word.size(), value).ec == std::errc();
  const std::size_t exponent = word.find_first_of("eE");
  const bool is_small = fits_double ? std::abs(value) < 1 : exponent != word.npos && word[exponent + 1] == '-';
  return is_small ? static_cast<float>(value) : std::numeric_limits<float>::infinity();
}

// What MSVC's programs write for a result that is none, such as 1.#QNAN, is no number.
bool read_float(std::string_view word, float& value) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (stop == word.data() + word.size() && error == std::errc()) return true;
  if (stop == word.data() + word.size() && error == std::errc::result_out_of_range) {
    value = out_of_range(word);
    return true;
  }
  if (word.find(".#") == std::string_view::npos) return false;
  value = std::numeric_limits<float>::quiet_NaN();
  return true;
}

// One kind of what faces name: vertices, texture coordinates or normals.
struct Named {
  std::string_view what;
  std::size_t count = 0;  // in the file so far
  // Corners that name one that the file does not have yet, each a higher one.
  std::vector<std::pair<std::uint64_t, int>> ahead{};  // its number, and the line of the face
  int first_line = 0;                                  // of a face that names one; 0: none does
};

class ObjTextReader {
 public:
  explicit ObjTextReader(PartSource& source) : source_(source), lines_(source, source.file) {}

  ObjText read() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      std::string_view rest = *line;
      const std::string_view word = take_word(rest);
      if (!word.empty()) read_line(word, rest);
    }
    check_named();
    check_finite();
    return std::move(read_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { fail_at(lines_.where(), message); }
  [[noreturn]] void fail_corner(std::string_view corner) const {
    fail("a face has the corner " + shown_word(corner) +
         ", expected V, V/VT, V//VN or V/VT/VN, whole numbers other than 0");
  }

  void read_line(std::string_view word, std::string_view rest) {
    if (word == "v") return add_vertex(rest);
    if (word == "vt") return add_uv(rest);
    if (word == "vn") return add_normal(rest);
    if (word == "f" || word == "fo") return add_face(rest);
    if (word == "l") return add_line(rest);
    if (word == "p") return add_points(rest);
    if (word == "o") return enter_object(std::string(rest));
    if (word == "g") return enter_group(std::string(rest));
    if (word == "usemtl") return use_material(std::string(rest));
    if (word == "mtllib") return add_material_files(std::string(rest));
    if (std::ranges::find(kSurfaces, word) != std::end(kSurfaces) && !std::exchange(has_surfaces_, true)) {
      source_.warn_at(lines_.where(), "curves and surfaces of free form are left out");
    }
  }

  // The numbers of a line, up to a comment.
  std::span<const float> numbers(std::string_view rest, std::string_view what) {
    std::size_t count = 0;
    while (!rest.empty() && rest.front() != '#') {
      const std::string_view word = take_word(rest);
      if (count == numbers_.size()) fail(std::string(what) + " has too many numbers");
      if (!read_float(word, numbers_[count++])) fail(no_number(what, word));
    }
    return {numbers_.data(), count};
  }

  void add_vertex(std::string_view rest) {
    const std::span<const float> n = numbers(rest, "a vertex");
    if (n.size() < 2 || n.size() == 5) {
      fail("a vertex has " + std::to_string(n.size()) + " numbers, expected 3, 4, or 6 with a colour");
    }
    if (n.size() == 2 && !std::exchange(is_flat_, true)) {
      source_.warn_at(lines_.where(), "vertices have two coordinates; the third is taken as 0");
    }
    glm::vec3 position(n[0], n[1], n.size() > 2 ? n[2] : 0);
    if (n.size() == 4) position /= n[3];  // homogeneous
    if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) {
      not_finite_.try_emplace(static_cast<std::uint32_t>(read_.positions.size()), lines_.line());
    }
    read_.positions.push_back(position);
    if (n.size() >= 6) {
      read_.colors.resize(read_.positions.size() - 1, glm::vec4(1));
      read_.colors.emplace_back(n[3], n[4], n[5], 1);
    }
    ++vertices_.count;
  }

  void add_uv(std::string_view rest) {
    const std::span<const float> n = numbers(rest, "a texture coordinate");
    if (n.empty() || n.size() > 3) {
      fail("a texture coordinate has " + std::to_string(n.size()) + " numbers, expected 1, 2 or 3");
    }
    read_.uvs.emplace_back(n[0], n.size() > 1 ? n[1] : 0);
    ++uvs_.count;
  }

  void add_normal(std::string_view rest) {
    const std::span<const float> n = numbers(rest, "a normal");
    if (n.size() != 3) fail("a normal has " + std::to_string(n.size()) + " numbers, expected 3");
    read_.normals.emplace_back(n[0], n[1], n[2]);
    ++normals_.count;
  }

  struct Corner {
    std::uint32_t vertex = 0, uv = 0, normal = 0;  // from 1; 0: none
  };

  // The number, from 1, that a corner has at the start of `text`, and removes it from there.
  std::uint32_t take_index(std::string_view& text, Named& named, std::string_view corner) {
    std::int64_t written = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), written);
    const auto count = static_cast<std::int64_t>(named.count);
    const std::int64_t index = written < 0 ? count + 1 + written : written;
    if (error != std::errc() || index <= 0 || index >= std::numeric_limits<std::uint32_t>::max()) {
      if (error == std::errc() && written < 0) {
        fail("a face has the " + std::string(named.what) + " " + std::to_string(written) + ", but " +
             std::to_string(count) + " come before it");
      }
      fail_corner(corner);
    }
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    const auto number = static_cast<std::uint64_t>(index);
    if (number > named.count && (named.ahead.empty() || named.ahead.back().first < number)) {
      named.ahead.emplace_back(number, lines_.line());
    }
    if (named.first_line == 0) named.first_line = lines_.line();
    return static_cast<std::uint32_t>(index);
  }

  Corner corner_of(std::string_view word) {
    std::string_view text = word;
    Corner corner{.vertex = take_index(text, vertices_, word)};
    for (Named* const named : {&uvs_, &normals_}) {
      if (!text.starts_with('/')) break;
      text.remove_prefix(1);
      if (text.empty() || text.starts_with('/')) continue;
      (named == &uvs_ ? corner.uv : corner.normal) = take_index(text, *named, word);
    }
    if (!text.empty()) fail_corner(word);
    return corner;
  }

  const std::vector<Corner>& corners_of(std::string_view rest) {
    corners_.clear();
    while (!rest.empty() && rest.front() != '#') corners_.push_back(corner_of(take_word(rest)));
    return corners_;
  }

  void add_corner(const Corner& corner) {
    const std::size_t before = read_.vertex.size();
    read_.vertex.push_back(corner.vertex - 1);
    const auto add = [&](std::uint32_t number, std::vector<std::uint32_t>& numbers) {
      if (number == 0 && numbers.empty()) return;
      numbers.resize(before, 0);
      numbers.push_back(number);
    };
    add(corner.uv, read_.uv);
    add(corner.normal, read_.normal);
  }

  void end_face() {
    if (read_.vertex.size() > std::numeric_limits<std::uint32_t>::max()) {
      source_.fail("the faces have over 2^32 - 1 corners");
    }
    read_.ends.push_back(static_cast<std::uint32_t>(read_.vertex.size()));
    run().end = read_.ends.size();
  }

  void add_face(std::string_view rest) {
    const std::vector<Corner>& corners = corners_of(rest);
    if (corners.size() > kMaxPolygonCorners) {
      fail("a polygon has " + std::to_string(corners.size()) + " corners, expected at most " +
           std::to_string(kMaxPolygonCorners));
    }
    if (corners.empty()) return;
    for (const Corner& corner : corners) add_corner(corner);
    end_face();
  }

  void add_line(std::string_view rest) {
    const std::vector<Corner>& corners = corners_of(rest);
    for (std::size_t i = 1; i < corners.size(); ++i) {
      add_corner(corners[i - 1]);
      add_corner(corners[i]);
      end_face();
    }
  }

  void add_points(std::string_view rest) {
    for (const Corner& corner : corners_of(rest)) {
      add_corner(corner);
      end_face();
    }
  }

  // The run that the next face belongs to.
  ObjRun& run() {
    if (read_.objects.empty()) read_.objects.push_back({.name = "defaultobject"});  // as Assimp calls it
    std::vector<ObjRun>& runs = read_.objects[object_].runs;
    const bool is_new = runs.empty() || runs.back().material != material_ || runs.back().end != read_.ends.size() - 1;
    if (is_new) {
      const std::string& object = read_.objects[object_].name;
      const std::string& later = group_.empty() ? material_ : group_;
      const std::size_t first = read_.ends.size() - 1;
      runs.push_back({.name = runs.empty() ? object : later, .material = material_, .first = first, .end = first});
    }
    return runs.back();
  }

  void enter_object(std::string name) {
    if (name.empty()) return;
    const auto [known, is_new] = objects_.try_emplace(name, read_.objects.size());
    object_ = known->second;
    if (is_new) read_.objects.push_back({.name = std::move(name)});
  }

  void enter_group(std::string name) {
    if (name == group_) return;
    group_ = name;
    object_ = read_.objects.size();
    objects_.try_emplace(name, object_);
    read_.objects.push_back({.name = std::move(name)});
  }

  void add_material_files(std::string line) {
    if (material_files_.insert(line).second) read_.material_files.push_back(std::move(line));
  }

  void use_material(std::string name) {
    if (!name.empty()) material_ = std::move(name);
  }

  void check_named() {
    for (Named* const named : {&vertices_, &uvs_, &normals_}) {
      const bool is_left_out = named != &vertices_ && named->count == 0;
      if (is_left_out && named->first_line > 0) {
        source_.warn_at(lines_.place(named->first_line),
                        "faces name " + std::string(named->what) + "s, but the file has none; they are left out");
        (named == &uvs_ ? read_.uv : read_.normal).clear();
      }
      for (const auto& [number, line] : named->ahead) {
        if (number <= named->count || is_left_out) continue;
        fail_at(lines_.place(line), "a face has the " + std::string(named->what) + " " + std::to_string(number) +
                                        ", which is out of range: the file has " + std::to_string(named->count));
      }
    }
    for (std::vector<std::uint32_t>* const numbers : {&read_.uv, &read_.normal}) {
      if (!numbers->empty()) numbers->resize(read_.vertex.size(), 0);
    }
    if (!read_.colors.empty()) read_.colors.resize(read_.positions.size(), glm::vec4(1));
  }

  // A vertex that nothing shows may be anything.
  void check_finite() const {
    if (not_finite_.empty()) return;
    const auto fail_at_vertex = [&](std::uint32_t vertex) {
      const auto found = not_finite_.find(vertex);
      if (found != not_finite_.end())
        fail_at(lines_.place(found->second), "vertex " + std::to_string(vertex + 1) + " is not finite");
    };
    if (read_.ends.empty()) fail_at_vertex(not_finite_.begin()->first);
    std::ranges::for_each(read_.vertex, fail_at_vertex);
  }

  PartSource& source_;
  TextLines lines_;
  ObjText read_;
  std::map<std::uint32_t, int> not_finite_;  // vertices, with their lines
  Named vertices_{.what = "vertex"}, uvs_{.what = "texture coordinate"}, normals_{.what = "normal"};
  std::map<std::string, std::size_t> objects_;  // the first of each name
  std::set<std::string> material_files_;        // lines that name some
  std::size_t object_ = 0;                      // which faces belong to
  std::string group_, material_;                // those that are active
  std::array<float, 7> numbers_{};
  std::vector<Corner> corners_;
  bool is_flat_ = false, has_surfaces_ = false;
};

}  // namespace

ObjText read_obj_text(PartSource& source) { return ObjTextReader(source).read(); }

}  // namespace simvis
