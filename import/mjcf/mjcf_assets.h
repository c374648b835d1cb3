// Meshes, materials and textures of an MJCF model.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include <simvis/node.h>
#include "import/mjcf/mjcf_element.h"
#include "import/mjcf/mjcf_pictures.h"
#include "import/model/import_report.h"

namespace simvis {

/// The shapes of a mesh asset, with its scale and reference frame applied, without materials.
struct MjcfMesh {
  NodePtr shapes;  ///< null: it cannot be read
  std::string error;
};

/// The surface of a field of heights, see HeightMap.
struct MjcfHeights {
  std::shared_ptr<const Mesh> mesh;
  glm::dmat4 place{1.0};
};

/// What has been read of assets, by model and name: each file is read once, for pictures and for physics.
struct MjcfReadAssets {
  using Key = std::pair<const MjcfModel*, std::string>;
  std::map<Key, MjcfHeights> fields;
  std::map<Key, MjcfMesh> meshes;
  std::map<std::pair<Key, CubeSides>, MjcfMesh> cube_meshes;
  std::map<Key, MjcfMesh> flat_pictured_meshes;
};

/// How a geom looks.
struct MjcfLook {
  std::shared_ptr<const Material> material;  ///< shared with others that look the same, whatever their names are
  std::string name{};                        ///< of the material in the file; empty: none
  CubeSides sides = CubeSides::none;         ///< of the cube whose picture the material has
  bool is_flat = false;                      ///< the material has a flat picture
  bool is_projected = false;                 ///< it is projected along z, which other coordinates do not do
};

/// The assets of a model and of those that it attaches: each name counts in its own model.
class MjcfAssets {
 public:
  MjcfAssets(MjcfReadAssets& read, ImportReport& report, ContentPool& pool)
      : read_(read), report_(report), pool_(pool) {}

  /// The mesh that a geom names. Its file is read when it is first asked for. With the sides of a cube it
  /// has the texture coordinates of one around its middle; projected, those of a picture as large as its box.
  const MjcfMesh& mesh(const MjcfElement& geom, const MjcfLook& look = {});

  /// The surface of a field of heights. It is read when it is first asked for. Throws InputError if there is none of
  /// this name, and as mjcf_height_map().
  const MjcfHeights& heights(const MjcfElement& geom);

  /// The look of a geom: its `material`, its `rgba`, or the picture of its material times its `rgba`. Colours are read
  /// as sRGB. Without metalness and roughness, `shininess` makes a surface smooth, unless `specular` is 0.
  MjcfLook look_of(const MjcfElement& geom);

 private:
  // Of one model, by name.
  struct Tables {
    std::map<std::string, MjcfElement> meshes, materials, textures, fields;
  };
  Tables& tables_of(const MjcfModel& model);
  MjcfMesh read_mesh(const MjcfElement& asset);
  MjcfMesh cube_mesh(const MjcfMesh& plain, CubeSides sides);
  MjcfMesh projected_mesh(const MjcfMesh& plain);
  std::optional<glm::dvec2> pictured_half_m(const MjcfElement& geom);
  void lay_flat(const MjcfElement& asset, const MjcfElement& geom, Material& material, MjcfLook& look);
  NodePtr read_mesh_content(const MjcfElement& asset);
  void add_picture(const MjcfElement& asset, const MjcfElement& geom, Material& material, MjcfLook& look);

  MjcfReadAssets& read_;
  ImportReport& report_;
  ContentPool& pool_;
  std::map<const MjcfModel*, Tables> tables_;
};

}  // namespace simvis
