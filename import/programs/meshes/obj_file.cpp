#include "import/programs/meshes/obj_file.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <simvis/location.h>
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "engine/base/srgb.h"
#include "engine/base/words.h"
#include "import/programs/back_to_back.h"
#include "import/programs/meshes/mtl_file.h"
#include "import/programs/meshes/obj_text.h"
#include "import/programs/meshes/polygon_meshes.h"
#include "import/programs/repeated_warning.h"

namespace simvis {
namespace {

namespace fs = std::filesystem;

// The materials of a scene, each made when it is first asked for.
class ObjMaterials {
 public:
  ObjMaterials(PartSource& source, ImportedScene& scene) : source_(source), scene_(scene) {}

  // Names have spaces, or a line has several names.
  void read_files(const std::vector<std::string>& lines) {
    for (std::string line : lines) {
      std::ranges::replace(line, '\\', '/');
      const bool is_one = line.find(' ') == std::string::npos || may_read(place_of_file(line));
      for (const std::string_view name : is_one ? std::vector<std::string_view>{line} : words_of(line)) {
        read_file(name);
      }
    }
  }

  std::uint32_t get(const std::string& name, bool shaded, bool one_sided) {
    const auto [known, is_new] =
        numbers_.try_emplace({name, shaded, one_sided}, static_cast<std::uint32_t>(scene_.materials.size()));
    if (!is_new) return known->second;
    ImportedMaterial imported;
    imported.is_fallback = name.empty();
    if (!imported.is_fallback) imported = converted(name, materials_[name]);
    imported.material.unlit = !shaded;
    imported.material.double_sided = !one_sided;
    scene_.materials.push_back(std::move(imported));
    return known->second;
  }

  void give_warnings() const {
    absent_.give(source_, "material file", "is not there");
    outside_.give(source_, "material file", "is outside the folders of the part and is not read");
    emissive_.give(source_, "material", "its emission is multiplied by its picture");
    cut_out_.give(source_, "material", "pictures of opacity are taken only where they are the colour's own");
  }

 private:
  fs::path place_of_file(std::string_view name) const { return source_.file.parent_path() / name; }

  static bool may_read(const fs::path& file) { return is_readable(file) && is_input_file(file); }

  void read_file(std::string_view name) {
    if (name.empty()) return;
    fs::path file = place_of_file(name);
    if (!may_read(file)) {
      (is_readable(file) ? absent_ : outside_).add({.file = source_.file.string()}, file.string());
      file = fs::path(source_.file).replace_extension(".mtl");
      if (!may_read(file)) return;
    }
    if (files_.insert(file).second) read_mtl(source_, file, materials_);
  }

  ImportedMaterial converted(const std::string& name, const MtlMaterial& mtl) {
    ImportedMaterial imported;
    Material& material = imported.material;
    const Location here{.file = source_.file.string()};
    material.name = name;
    for (int i = 0; i < 3; ++i) {
      material.base_color[i] = linear_from_srgb(mtl.diffuse[i]);
      material.emissive[i] = linear_from_srgb(mtl.emissive[i]);
    }
    material.base_color.a = static_cast<float>(mtl.opacity);
    if (mtl.opacity < 1) material.alpha_mode = AlphaMode::blend;
    if (mtl.picture.empty()) return imported;
    imported.texture = texture(mtl.picture, mtl.wrap);
    if (material.emissive != glm::vec3(0)) {
      imported.textured_emission = true;
      emissive_.add(here, name);
    }
    if (mtl.cut_out == mtl.picture) {
      material.alpha_mode = AlphaMode::mask;
    } else if (!mtl.cut_out.empty()) {
      cut_out_.add(here, name);
    }
    return imported;
  }

  std::uint32_t texture(const std::string& picture, Wrap wrap) {
    const auto [known, is_new] =
        textures_.try_emplace({picture, wrap}, static_cast<std::uint32_t>(scene_.textures.size()));
    if (!is_new) return known->second;
    ImportedTexture& made = scene_.textures.emplace_back();
    made.file = made.texture.name = picture;
    made.texture.sampler = {.wrap_u = wrap, .wrap_v = wrap};
    return known->second;
  }

  PartSource& source_;
  ImportedScene& scene_;
  MtlMaterials materials_;
  std::set<fs::path> files_;  // that have been read
  RepeatedWarning absent_, outside_, emissive_, cut_out_;
  std::map<std::tuple<std::string, bool, bool>, std::uint32_t> numbers_;
  std::map<std::pair<std::string, Wrap>, std::uint32_t> textures_;
};

class ObjScene {
 public:
  ObjScene(PartSource& source, ObjText text) : source_(source), text_(std::move(text)), materials_(source, scene_) {}

  ImportedScene take() {
    if (text_.positions.empty()) source_.fail("holds nothing to draw");
    materials_.read_files(text_.material_files);
    ImportedNode root;
    root.name = source_.file.filename().string();
    scene_.nodes.push_back(std::move(root));
    if (text_.ends.empty()) add_points();
    for (const ObjObject& object : text_.objects) {
      if (!object.runs.empty()) add_object(object);
    }
    materials_.give_warnings();
    scene_.warnings = std::move(source_.warnings);
    return std::move(scene_);
  }

 private:
  PolygonCorner corner_of_vertex(std::size_t vertex) {
    PolygonCorner corner{corner_position(source_, vertex + 1, text_.positions[vertex])};
    if (!text_.colors.empty()) corner.attributes.color = corner_color(source_, text_.colors[vertex]);
    return corner;
  }

  PolygonCorner corner(std::size_t at) {
    PolygonCorner made = corner_of_vertex(text_.vertex[at]);
    const std::uint32_t uv = text_.uv.empty() ? 0 : text_.uv[at];
    const std::uint32_t normal = text_.normal.empty() ? 0 : text_.normal[at];
    made.attributes.normal = normal == 0 ? glm::vec3(0) : corner_normal(text_.normals[normal - 1]);
    if (uv > 0) made.attributes.uv[0] = corner_uv(source_, text_.uvs[uv - 1]);
    return made;
  }

  void add_points() {
    PolygonMeshes meshes(source_, "");
    for (std::size_t i = 0; i < text_.positions.size(); ++i) {
      PolygonCorner point = corner_of_vertex(i);
      point.attributes.normal = glm::vec3(0);
      meshes.add({&point, 1});
    }
    add_shapes(meshes, "", false, false, scene_.nodes[0]);
  }

  void add_object(const ObjObject& object) {
    ImportedNode node;
    node.name = object.name;
    node.parent = 0;
    const auto back_to_back = faces_back_to_back(faces_of(object));
    for (std::size_t i = 0; i < object.runs.size(); ++i) {
      const auto found = back_to_back.find(i);
      if (found == back_to_back.end()) {
        add_run(object.runs[i], nullptr, false, node);
        continue;
      }
      std::vector<bool> faces = found->second;
      add_run(object.runs[i], &faces, true, node);
      faces.flip();
      add_run(object.runs[i], &faces, false, node);
    }
    scene_.nodes.push_back(std::move(node));
  }

  std::vector<FacedMesh> faces_of(const ObjObject& object) const {
    std::map<std::string_view, std::uint32_t> numbers;
    std::vector<FacedMesh> meshes;
    for (const ObjRun& run : object.runs) {
      const auto read = [this, &run](std::size_t face, std::vector<glm::vec3>& corners) {
        for (std::size_t at = text_.first_corner(run.first + face); at < text_.ends[run.first + face]; ++at) {
          corners.push_back(text_.positions[text_.vertex[at]]);
        }
      };
      const std::uint32_t material =
          numbers.try_emplace(run.material, static_cast<std::uint32_t>(numbers.size())).first->second;
      meshes.push_back({.material = material, .faces = run.end - run.first, .corners = read});
    }
    return meshes;
  }

  void add_run(const ObjRun& run, const std::vector<bool>* faces, bool one_sided, ImportedNode& node) {
    PolygonMeshes meshes(source_, run.name);
    bool has_normals = false;
    for (std::size_t face = run.first; face < run.end; ++face) {
      if (faces != nullptr && !(*faces)[face - run.first]) continue;
      corners_.clear();
      for (std::size_t at = text_.first_corner(face); at < text_.ends[face]; ++at) {
        corners_.push_back(corner(at));
        has_normals = has_normals || (!text_.normal.empty() && text_.normal[at] != 0);
      }
      meshes.add(corners_);
    }
    add_shapes(meshes, run.material, has_normals, one_sided, node);
  }

  // Lines and points without normals are shown unlit.
  void add_shapes(PolygonMeshes& meshes, const std::string& material, bool has_normals, bool one_sided,
                  ImportedNode& node) {
    for (Mesh& mesh : meshes.take()) {
      const bool shaded = has_normals || mesh.topology == Topology::triangles;
      node.shapes.push_back(
          {static_cast<std::uint32_t>(scene_.meshes.size()), materials_.get(material, shaded, one_sided)});
      scene_.meshes.push_back(std::move(mesh));
    }
  }

  PartSource& source_;
  ObjText text_;
  ImportedScene scene_;
  ObjMaterials materials_;
  std::vector<PolygonCorner> corners_;  // of a face
};

}  // namespace

ImportedScene read_obj(const fs::path& file) {
  PartSource source{file};
  source.check_size();
  ObjText text = read_obj_text(source);
  return ObjScene(source, std::move(text)).take();
}

}  // namespace simvis
