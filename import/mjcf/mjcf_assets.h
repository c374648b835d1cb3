// Meshes, materials and textures of an MJCF model.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

/// The surface of a field of heights, see HeightMap.
struct MjcfHeights {
  std::shared_ptr<const Mesh> mesh;
  glm::dmat4 place{1.0};
};

class MjcfAssets {
 public:
  MjcfAssets(const MjcfModel& model, ImportReport& report, ContentPool& pool);

  /// The mesh of this name. Its file is read when it is first asked for.
  const MjcfMesh& mesh(const std::string& name);

  /// The surface of a field of heights. It is read when it is first asked for. Throws InputError if there is none of
  /// this name, and as mjcf_height_map().
  const MjcfHeights& heights(const MjcfElement& geom);

  /// The look of a geom: its `material`, or its `rgba`. Colours are read as sRGB. Built-in textures have their first
  /// colour.
  std::shared_ptr<const Material> material_of(const MjcfElement& geom);

 private:
  MjcfMesh read_mesh(const MjcfElement& asset);
  NodePtr read_mesh_content(const MjcfElement& asset);
  std::shared_ptr<const Texture> picture_of(const MjcfElement& texture, Material& material);
  void read_material(const MjcfElement& asset, Material& material);

  const MjcfModel& model_;
  ImportReport& report_;
  ContentPool& pool_;
  std::map<std::string, MjcfElement> meshes_, materials_, textures_, fields_;
  std::map<std::string, MjcfHeights> read_fields_;
  std::map<std::string, MjcfMesh> read_meshes_;
};

}  // namespace simvis
