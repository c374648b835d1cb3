// Meshes, materials and textures of an MJCF model.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include <simvis/node.h>
#include "import/mjcf/mjcf_element.h"
#include "import/model/import_report.h"

namespace simvis {

/// The shapes of a mesh asset, with its scale and reference frame applied, without materials.
struct MjcfMesh {
  NodePtr shapes;  ///< null: it cannot be read
  std::string error;
};

/// How a geom looks.
struct MjcfLook {
  std::shared_ptr<const Material> material;
  bool has_cube = false;  ///< its picture is meant for the sides of a cube
};

/// The assets of a model and of those that it attaches: each name counts in its own model.
class MjcfAssets {
 public:
  MjcfAssets(ImportReport& report, ContentPool& pool) : report_(report), pool_(pool) {}

  /// The mesh that a geom names. Its file is read when it is first asked for. `with_cube`: with the texture coordinates
  /// of a cube texture, around the middle of the mesh.
  const MjcfMesh& mesh(const MjcfElement& geom, bool with_cube = false);

  /// The surface of a field of heights. It is read when it is first asked for. Throws InputError if there is none of
  /// this name, and as mjcf_height_mesh().
  std::shared_ptr<const Mesh> heights(const MjcfElement& geom);

  /// The look of a geom: its `material`, its `rgba`, or the picture of its material times its `rgba`. Colours are read
  /// as sRGB. Without metalness and roughness, `shininess` makes a surface smooth, unless `specular` is 0.
  MjcfLook look_of(const MjcfElement& geom);

 private:
  // Of one model, by name.
  struct Tables {
    std::map<std::string, MjcfElement> meshes, materials, textures, fields;
  };
  using Key = std::pair<const MjcfModel*, std::string>;
  Tables& tables_of(const MjcfModel& model);
  MjcfMesh read_mesh(const MjcfElement& asset);
  MjcfMesh cube_mesh(const MjcfMesh& plain);
  NodePtr read_mesh_content(const MjcfElement& asset);
  bool add_picture(const MjcfElement& asset, const MjcfElement& geom, Material& material);

  ImportReport& report_;
  ContentPool& pool_;
  std::map<const MjcfModel*, Tables> tables_;
  std::map<Key, std::shared_ptr<const Mesh>> read_fields_;
  std::map<Key, MjcfMesh> read_meshes_, cube_meshes_;
};

}  // namespace simvis
