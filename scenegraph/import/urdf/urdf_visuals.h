// Makes nodes from the visuals of a URDF robot's links.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "scenegraph/import/urdf/urdf_file.h"

namespace simvis {

/// Turns <visual> into nodes; collision geometry is ignored. Boxes, cylinders and spheres are the meshes of
/// primitive_meshes.h. Mesh files keep their axes as written, whatever their <up_axis>, as in ROS programs. A visual's
/// material applies to the shapes of its mesh file that have no material. Colours are read as sRGB.
class UrdfVisuals {
 public:
  UrdfVisuals(const UrdfFile& file, ContentPool& pool) : file_(file), pool_(pool) {}

  /// Throws InputError at the link for files that are missing or broken, and for sizes that are not above 0.
  NodePtr make(const urdf::Link& link, const urdf::Visual& visual);

  std::vector<std::string> release_warnings() { return std::move(warnings_); }

 private:
  std::shared_ptr<const Material> material_of(const urdf::Link& link, const urdf::Visual& visual);
  void add_mesh(const urdf::Link& link, const urdf::Mesh& mesh, const std::shared_ptr<const Material>& material,
                Group& group);
  std::filesystem::path find(const urdf::Link& link, const std::string& name, const char* kind) const;

  const UrdfFile& file_;
  ContentPool& pool_;
  std::map<std::pair<std::filesystem::path, const Material*>, NodePtr> meshes_;
  std::vector<std::string> warnings_;
};

}  // namespace simvis
