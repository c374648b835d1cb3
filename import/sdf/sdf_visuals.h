// Makes nodes from the visuals of SDF links.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "import/mesh/mesh_file.h"
#include "import/model/model_meshes.h"
#include "import/model/shape_nodes.h"
#include "import/model/shown_visuals.h"
#include "import/sdf/sdf_materials.h"

namespace simvis {

/// What a visual says of its look besides its material.
struct SdfLook {
  double opacity = 1;           ///< a factor of that of the material
  float retro_reflectance = 0;  ///< <laser_retro>, as that of Material; 0: as the material says
  auto operator<=>(const SdfLook&) const = default;
};

/// Collision geometry is ignored. Boxes, spheres, cylinders, capsules and cones are the meshes of primitive_meshes.h;
/// an ellipsoid is a sphere with three scales, and the highest pixel of a heightmap has the height of its <size>. A
/// plane faces along its normal and is as large as its size. A mesh file keeps its axes as written by default, and its
/// materials, unless the visual has a material of its own.
class SdfVisuals {
 public:
  SdfVisuals(const ImportRequest& request, SdfFiles& files, ModelMeshes& meshes, ImportReport& report,
             MeshFileAxes axes, ContentPool& pool)
      : shown_(request),
        files_(files),
        meshes_(meshes),
        report_(report),
        axes_(axes),
        pool_(pool),
        shape_meshes_(pool),
        materials_(files, report, pool) {}

  /// A visual whose geometry is missing, wrong or of an unknown kind is left out with a warning; then, the result is
  /// null. `link_from_visual` is called for its pose, whose errors leave the visual out, too.
  NodePtr make(const SdfElement& visual, const std::string& link, const std::function<glm::dmat4()>& link_from_visual);

  /// Which of the visuals have been made.
  const ShownVisuals& shown() const { return shown_; }

 private:
  struct MeshKey {
    std::filesystem::path file;
    std::string submesh;
    bool center = false;
    std::shared_ptr<const Material> material;
    SdfLook look{};
    auto operator<=>(const MeshKey&) const = default;
  };
  NodePtr build(const SdfElement& visual, const glm::dmat4& link_from_visual);
  void add_geometry(const SdfElement& shape, const std::shared_ptr<const Material>& material, const SdfLook& look,
                    Group& group);
  void add_heightmap(const SdfElement& map, const std::shared_ptr<const Material>& material, const SdfLook& look,
                     Group& group);
  void add_mesh(const SdfElement& mesh, const std::shared_ptr<const Material>& material, const SdfLook& look,
                Group& group);
  std::shared_ptr<const Material> plain_of(const SdfLook& look);
  NodePtr read_mesh(const SdfElement& mesh, const MeshKey& key);
  GroupPtr read_file(const std::filesystem::path& file, const SdfElement& mesh);

  ShownVisuals shown_;
  SdfFiles& files_;
  ModelMeshes& meshes_;
  ImportReport& report_;
  MeshFileAxes axes_;
  ContentPool& pool_;
  ShapeMeshes shape_meshes_;
  SdfMaterials materials_;
  const std::shared_ptr<const Material> plain_ = std::make_shared<const Material>(SdfMaterials::plain(1));
  std::map<MeshKey, NodePtr> changed_meshes_;
};

}  // namespace simvis
