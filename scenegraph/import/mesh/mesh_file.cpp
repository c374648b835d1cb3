#include "scenegraph/import/mesh/mesh_file.h"

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <simvis/node.h>
#include <simvis/part_importer.h>
#include "scenegraph/import/mesh/assimp_file.h"
#include "scenegraph/import/mesh/assimp_materials.h"
#include "scenegraph/import/mesh/assimp_meshes.h"

namespace simvis {
namespace {

// (x, y, z) -> (x, -z, y): a y-up frame in SimVis's z-up frame.
const glm::dmat4 kZUpFromYUp(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);

glm::dmat4 read_matrix(const AssimpFile& file, const aiMatrix4x4& source) {
  glm::dmat4 matrix{1.0};
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      const double value = source[row][column];
      if (!std::isfinite(value)) file.fail("a node has a matrix that is not finite");
      matrix[static_cast<int>(column)][static_cast<int>(row)] = value;
    }
  }
  if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1) {
    file.fail("a node has a matrix whose last row is not 0 0 0 1");
  }
  return matrix;
}

class MeshGraphBuilder {
 public:
  MeshGraphBuilder(AssimpFile& file, ContentPool& pool, std::shared_ptr<const Material> fallback)
      : file_(file), pool_(pool), materials_(file, pool, std::move(fallback)) {}

  // Depth first, in the file's order, with an explicit stack: depth is no limit.
  GroupPtr build(const glm::dmat4& part_from_file) {
    const auto root = std::make_shared<Separator>();
    root->name = file_.file.stem().string();
    struct Pending {
      const aiNode* node;
      Group* parent;
    };
    std::vector<Pending> stack{{file_.scene->mRootNode, root.get()}};
    while (!stack.empty()) {
      const auto [node, parent] = stack.back();
      stack.pop_back();
      const bool is_root = node == file_.scene->mRootNode;
      const glm::dmat4 own = read_matrix(file_, node->mTransformation);
      Group& group = add_node(*node, is_root ? part_from_file * own : own, *parent);
      for (unsigned i = node->mNumChildren; i > 0; --i) stack.push_back({node->mChildren[i - 1], &group});
    }
    if (is_empty_) file_.fail("holds nothing to draw");
    return root;
  }

 private:
  Group& add_node(const aiNode& node, const glm::dmat4& parent_from_node, Group& parent) {
    const auto separator = std::make_shared<Separator>();
    separator->name = node.mName.C_Str();
    if (parent_from_node != glm::dmat4(1)) separator->add(std::make_shared<Transform>(parent_from_node));
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add_mesh(node.mMeshes[i], *separator);
    parent.add(separator);
    return *separator;
  }

  void add_mesh(unsigned index, Group& group) {
    const aiMesh& source = *file_.scene->mMeshes[index];
    auto known = shapes_.find(index);
    if (known == shapes_.end()) {
      std::vector<std::shared_ptr<Shape>> shapes;
      for (Mesh& mesh : convert_mesh(file_, source)) {
        shapes.push_back(std::make_shared<Shape>(pool_.intern(std::move(mesh))));
        shapes.back()->name = source.mName.C_Str();
        is_empty_ = false;
      }
      known = shapes_.emplace(index, std::move(shapes)).first;
    }
    for (const auto& shape : known->second) {
      const bool is_surface = shape->mesh()->topology == Topology::triangles;
      group.add(materials_.get(source.mMaterialIndex, is_surface || source.HasNormals()));
      group.add(shape);
    }
  }

  AssimpFile& file_;
  ContentPool& pool_;
  AssimpMaterials materials_;
  std::map<unsigned, std::vector<std::shared_ptr<Shape>>> shapes_;
  bool is_empty_ = true;
};

PartContent import_mesh_file(const ImportRequest& request, ContentPool& pool) {
  MeshFileAxes axes = MeshFileAxes::of_format;
  if (request.up_given) axes = request.up == UpAxis::y ? MeshFileAxes::y_up : MeshFileAxes::as_written;
  Material plain;
  plain.double_sided = true;
  return read_mesh_file(request.file, axes, std::make_shared<Material>(plain), pool);
}

const PartImporterRegistration registration({".dae", ".obj", ".ply", ".stl"}, import_mesh_file);

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) { return find_part_importer(file) == import_mesh_file; }

PartContent read_mesh_file(const std::filesystem::path& file, MeshFileAxes axes,
                           std::shared_ptr<const Material> fallback, ContentPool& pool) {
  AssimpFile read = read_assimp_file(file, axes != MeshFileAxes::of_format);
  const bool y_up = axes == MeshFileAxes::y_up || (axes == MeshFileAxes::of_format && read.is_collada);
  PartContent content;
  content.root = MeshGraphBuilder(read, pool, std::move(fallback)).build(y_up ? kZUpFromYUp : glm::dmat4(1));
  content.warnings = std::move(read.warnings);
  return content;
}

}  // namespace simvis
