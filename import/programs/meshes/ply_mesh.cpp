#include "import/programs/meshes/ply_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include "engine/base/input_file.h"
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/meshes/ply_file.h"
#include "import/programs/meshes/polygon_meshes.h"

namespace simvis {
namespace {

enum Column : std::size_t { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kU, kV, kRed, kGreen, kBlue, kAlpha, kColumns };
constexpr std::pair<std::string_view, Column> kColumnNames[] = {
    {"x", kX},       {"y", kY},         {"z", kZ},        {"nx", kNormalX},  {"ny", kNormalY},  {"nz", kNormalZ},
    {"s", kU},       {"u", kU},         {"tx", kU},       {"texture_u", kU}, {"t", kV},         {"v", kV},
    {"ty", kV},      {"texture_v", kV}, {"red", kRed},    {"r", kRed},       {"green", kGreen}, {"g", kGreen},
    {"blue", kBlue}, {"b", kBlue},      {"alpha", kAlpha}};
constexpr std::string_view kStrips = "tristrips";

std::optional<Column> column_of(std::string_view property) {
  const auto* const found = std::ranges::find(kColumnNames, property, &std::pair<std::string_view, Column>::first);
  return found != std::end(kColumnNames) ? std::optional(found->second) : std::nullopt;
}

bool is_index_list(const PlyProperty& property) {
  return property.name == "vertex_indices" || property.name == "vertex_index";
}

// The columns of the vertices; empty: the file does not have it.
class PlyVertices {
 public:
  void add(const PlyElement& element, const std::vector<std::vector<double>>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::optional<Column> column = column_of(element.properties[i].name);
      if (!column) continue;
      const auto value = static_cast<float>(values[i][0]);
      columns_[*column].resize(count_);  // drops the value of another name of this column
      columns_[*column].push_back(*column < kRed ? value : value / color_range(element.properties[i].type));
    }
    ++count_;
  }

  std::size_t count() const { return count_; }
  bool has_normals() const { return has(kNormalX, kNormalY, kNormalZ); }

  void set_uv(std::size_t vertex, double u, double v) {
    for (const Column column : {kU, kV}) columns_[column].resize(count_);
    columns_[kU][vertex] = static_cast<float>(u);
    columns_[kV][vertex] = static_cast<float>(v);
  }

  PolygonCorner corner(PartSource& source, std::size_t vertex) const {
    const auto value = [&](Column column, float absent = 0) {
      return columns_[column].empty() ? absent : columns_[column][vertex];
    };
    PolygonCorner corner{corner_position(source, vertex, {value(kX), value(kY), value(kZ)})};
    corner.attributes.normal = corner_normal({value(kNormalX), value(kNormalY), value(kNormalZ)});
    if (has(kU, kV)) corner.attributes.uv[0] = corner_uv(source, {value(kU), value(kV)});
    if (has(kRed, kGreen, kBlue, kAlpha)) {
      corner.attributes.color = corner_color(source, {value(kRed), value(kGreen), value(kBlue), value(kAlpha, 1)});
    }
    return corner;
  }

 private:
  template <class... Columns>
  bool has(Columns... columns) const {
    return (!columns_[columns].empty() || ...);
  }

  std::array<std::vector<float>, kColumns> columns_;
  std::size_t count_ = 0;
};

class PlyMesh {
 public:
  PlyMesh(PartSource& source, PlyFile file) : source_(source), file_(std::move(file)) {}

  ImportedScene read() {
    source_.check_size();
    check_elements();
    PlyBody body(source_, file_);
    for (const PlyElement& element : file_.elements) {
      for (std::uint64_t i = 0; i < element.count; ++i) {
        const std::vector<std::vector<double>>& values = body.next(element, i);
        if (element.name == "vertex") vertices_.add(element, values);
        if (element.name == "face") add_face(element, values, body);
        if (element.name == kStrips) add_strip(values[0], body);
      }
    }
    body.finish();
    for (const TexturedFace& face : textured_) set_uvs(face);
    return scene();
  }

 private:
  struct TexturedFace {
    std::size_t first = 0;  // corner
    std::vector<double> uv;
  };

  [[noreturn]] void fail(const std::string& message, int line = 0) const {
    fail_at({.file = source_.file.string(), .line = line > 0 ? line : file_.lines}, message);
  }

  void check_elements() {
    for (PlyElement& element : file_.elements) {
      const std::string subject = "element " + in_quotes(element.name);
      // Every element has at least one byte of the file, so a larger count is an error and never costs time.
      if (element.count > file_.text.size()) {
        fail(subject + " has the count \"" + std::to_string(element.count) +
                 "\", expected a whole number that the file can hold",
             element.line);
      }
      if (element.properties.empty()) fail(subject + " has no properties");
      if (element.name == "vertex") check_vertex(element);
      if (element.name == "face" || element.name == kStrips) check_face(element);
      if (element.name == kStrips && element.properties.size() > 1) fail("element tristrips has other properties");
    }
    const auto has = [&](std::string_view name) {
      return std::ranges::count(file_.elements, name, &PlyElement::name) > 0;
    };
    if (!has("vertex")) fail("the header has no element vertex");
    if (has("face") && has(kStrips)) fail("the file has faces and tristrips, expected one of them");
  }

  void check_vertex(PlyElement& vertex) {
    if (vertex.count == 0) source_.fail("holds nothing to draw");
    vertex_count_ = vertex.count;
    for (const std::string_view axis : {"x", "y", "z"}) {
      const PlyProperty* const found = vertex.find(axis);
      if (found == nullptr || found->length) {
        fail("element vertex has no property " + std::string(axis) + " that is a number");
      }
    }
    for (PlyProperty& property : vertex.properties) {
      property.is_used = column_of(property.name).has_value();
      if (property.length && property.is_used) fail("element vertex has the list " + in_quotes(property.name));
    }
  }

  void check_face(const PlyElement& face) const {
    if (std::ranges::count_if(face.properties, is_index_list) != 1) {
      fail("element " + std::string(face.name) + " has no list vertex_indices, or two of them");
    }
    for (const PlyProperty& property : face.properties) {
      if (is_index_list(property) && (!property.length || property.type.kind == NumberType::Kind::real)) {
        fail("property " + in_quotes(property.name) + " is not a list of whole numbers");
      }
    }
  }

  void add_face(const PlyElement& element, const std::vector<std::vector<double>>& values, const PlyBody& body) {
    TexturedFace textured{corners_.size(), {}};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (is_index_list(property)) {
        for (const double vertex : values[i]) corners_.push_back(checked_vertex(vertex, body));
      }
      if (property.name == "texcoord" && property.length) textured.uv = values[i];
    }
    const std::size_t count = corners_.size() - textured.first;
    if (count < 3) body.fail("has " + std::to_string(count) + " vertices, expected at least 3");
    ends_.push_back(corners_.size());
    if (textured.uv.empty()) return;
    if (textured.uv.size() != 2 * count) body.fail("has texture coordinates that do not fit");
    textured_.push_back(std::move(textured));
  }

  // Of the faces at a vertex the last one counts.
  void set_uvs(const TexturedFace& face) {
    for (std::size_t i = 0; i < face.uv.size(); i += 2) {
      vertices_.set_uv(corners_[face.first + i / 2], face.uv[i], face.uv[i + 1]);
    }
  }

  // Every second triangle of a strip is turned round; triangles with two equal corners, which only connect parts of a
  // strip, are left out. -1 ends a strip, and the next vertex begins another one.
  void add_strip(const std::vector<double>& strip, const PlyBody& body) {
    std::uint32_t a = 0, b = 0;
    std::size_t count = 0;  // corners of the strip so far
    for (const double vertex : strip) {
      if (vertex == -1) {
        count = 0;
        continue;
      }
      const std::uint32_t corner = checked_vertex(vertex, body);
      if (++count >= 3 && a != b && b != corner && a != corner) {
        const bool turned = count % 2 == 0;
        corners_.insert(corners_.end(), {turned ? b : a, turned ? a : b, corner});
        ends_.push_back(corners_.size());
      }
      a = std::exchange(b, corner);
    }
  }

  std::uint32_t checked_vertex(double vertex, const PlyBody& body) const {
    if (vertex >= 0 && vertex < static_cast<double>(vertex_count_)) return static_cast<std::uint32_t>(vertex);
    body.fail("has the vertex " + format_number(vertex) + ", but there are " + std::to_string(vertex_count_));
  }

  ImportedScene scene() {
    PolygonMeshes meshes(source_, "");
    std::vector<PolygonCorner> polygon;
    std::size_t first = 0;
    for (const std::size_t end : ends_) {
      polygon.clear();
      for (; first < end; ++first) polygon.push_back(vertices_.corner(source_, corners_[first]));
      meshes.add(polygon);
    }
    for (std::size_t i = 0; ends_.empty() && i < vertices_.count(); ++i) {
      const PolygonCorner point = vertices_.corner(source_, i);
      meshes.add({&point, 1});
    }
    ImportedScene scene;
    scene.meshes = meshes.take();
    scene.nodes.emplace_back().shapes = {{0, 0}};
    ImportedMaterial& material = scene.materials.emplace_back();
    material.is_fallback = file_.picture.empty();
    material.material.unlit = ends_.empty() && !vertices_.has_normals();
    material.material.double_sided = true;
    if (!file_.picture.empty()) {
      std::string name(file_.picture);
      std::ranges::replace(name, '\\', '/');
      material.texture = 0;
      ImportedTexture& texture = scene.textures.emplace_back();
      texture.file = texture.texture.name = name;
    }
    return scene;
  }

  PartSource& source_;
  PlyFile file_;
  PlyVertices vertices_;
  std::size_t vertex_count_ = 0;
  std::vector<std::uint32_t> corners_;  // vertices of all faces
  std::vector<std::size_t> ends_;       // of each face, in `corners_`
  std::vector<TexturedFace> textured_;
};

}  // namespace

ImportedScene read_ply(const std::filesystem::path& file) {
  PartSource source{file};
  const Bytes bytes = read_whole_file(file);
  PlyFile ply = read_ply_header(source, bytes);
  ImportedScene scene = is_ply_of_points(ply) ? read_ply_points(source, ply)
                        : is_packed_ply(ply)  ? read_packed_ply(source, ply)
                                              : PlyMesh(source, std::move(ply)).read();
  scene.warnings.insert(scene.warnings.begin(), source.warnings.begin(), source.warnings.end());
  return scene;
}

}  // namespace simvis
