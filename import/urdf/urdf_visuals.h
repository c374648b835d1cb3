// Makes nodes from the visuals of a URDF robot's links.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "import/mesh/mesh_file.h"
#include "import/model/model_meshes.h"
#include "import/model/package_files.h"
#include "import/model/shape_nodes.h"
#include "import/model/shown_visuals.h"
#include "import/urdf/urdf_file.h"

namespace simvis {

/// Turns <visual> into nodes; collision geometry is ignored. Boxes, cylinders and spheres are the meshes of
/// primitive_meshes.h. Mesh files keep their axes as written by default, whatever their <up_axis>, as in ROS programs.
/// A visual's material applies to the shapes of its mesh file that have no material. Colours are read as sRGB.
class UrdfVisuals {
 public:
  UrdfVisuals(const ImportRequest& request, PackageFiles& packages, ModelMeshes& meshes, MeshFileAxes axes,
              ContentPool& pool)
      : packages_(packages), meshes_(meshes), axes_(axes), pool_(pool), shape_meshes_(pool), shown_(request) {}

  /// Warns as make() of a visual whose mesh file is missing or of another kind, without reading it.
  void look(const UrdfLink& link, const UrdfVisual& visual);

  /// A visual whose mesh file is missing, broken or of another kind than COLLADA, OBJ, PLY and STL is left out with a
  /// warning; then, the result is null. A texture that is missing or broken is replaced by the material's colour with a
  /// warning. Throws InputError at the link for sizes that are too large.
  NodePtr make(const UrdfLink& link, const UrdfVisual& visual);

  /// As ShownVisuals::require(). Visuals that were looked at count as made.
  void require_half() const { shown_.require(true); }

  std::vector<std::string> release_warnings();
  /// The mesh files that make() has read, by the names in the URDF. What the part may not read is not among them.
  std::map<std::string, std::filesystem::path> release_mesh_files() { return std::move(mesh_files_); }

 private:
  std::shared_ptr<const Material> material_of(const UrdfLink& link, const UrdfVisual& visual);
  bool add_mesh(const UrdfLink& link, const UrdfVisual& visual, const std::shared_ptr<const Material>& material,
                Group& group);
  NodePtr read_mesh(const UrdfLink& link, const std::string& name, const std::shared_ptr<const Material>& material);
  std::optional<std::filesystem::path> find_mesh(const UrdfLink& link, const std::string& name);
  void leave_out(const UrdfLink& link, const std::string& why);
  std::shared_ptr<const Texture> read_texture(const UrdfLink& link, const std::string& name, PictureUse use,
                                              const glm::vec4& color);
  std::optional<std::filesystem::path> find(const UrdfLink& link, const std::string& name);

  PackageFiles& packages_;
  ModelMeshes& meshes_;
  MeshFileAxes axes_;
  ContentPool& pool_;
  ShapeMeshes shape_meshes_;
  // By name, use, and the colour that replaces a picture that cannot be read.
  std::map<std::tuple<std::string, PictureUse, std::array<float, 3>>, std::shared_ptr<const Texture>> textures_;
  std::map<std::string, std::filesystem::path> mesh_files_;
  std::vector<std::string> warnings_;
  ShownVisuals shown_;
};

}  // namespace simvis
