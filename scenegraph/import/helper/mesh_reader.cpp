// Reads mesh files as imported scenes, with one node for each node of the file, in the file's order.
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "scenegraph/import/helper/assimp_import.h"
#include "scenegraph/import/helper/assimp_materials.h"
#include "scenegraph/import/helper/assimp_meshes.h"
#include "scenegraph/import/helper/part_reader.h"

namespace simvis {
namespace {

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

class MeshSceneReader {
 public:
  explicit MeshSceneReader(AssimpFile& file) : file_(file), materials_(file, scene_) {}

  // Reads the nodes depth first. The explicit stack allows any depth.
  ImportedScene read() {
    struct Pending {
      const aiNode* node;
      std::uint32_t parent;
    };
    std::vector<Pending> stack{{file_.scene->mRootNode, kNoParent}};
    while (!stack.empty()) {
      const auto [node, parent] = stack.back();
      stack.pop_back();
      const auto number = static_cast<std::uint32_t>(scene_.nodes.size());
      add_node(*node, parent);
      for (unsigned i = node->mNumChildren; i > 0; --i) stack.push_back({node->mChildren[i - 1], number});
    }
    if (scene_.meshes.empty()) file_.fail("holds nothing to draw");
    scene_.warnings = std::move(file_.warnings);
    return std::move(scene_);
  }

 private:
  void add_node(const aiNode& source, std::uint32_t parent) {
    ImportedNode node;
    node.name = source.mName.C_Str();
    node.parent = parent;
    node.parent_from_node = read_matrix(file_, source.mTransformation);
    for (unsigned i = 0; i < source.mNumMeshes; ++i) add_mesh(source.mMeshes[i], node);
    scene_.nodes.push_back(std::move(node));
  }

  void add_mesh(unsigned index, ImportedNode& node) {
    const aiMesh& source = *file_.scene->mMeshes[index];
    const auto [known, is_new] = meshes_.try_emplace(index);
    if (is_new) {
      for (Mesh& mesh : convert_mesh(file_, source)) {
        known->second.push_back(static_cast<std::uint32_t>(scene_.meshes.size()));
        scene_.meshes.push_back(std::move(mesh));
      }
    }
    for (const std::uint32_t mesh : known->second) {
      const bool is_surface = scene_.meshes[mesh].topology == Topology::triangles;
      node.shapes.push_back({mesh, materials_.get(source.mMaterialIndex, is_surface || source.HasNormals())});
    }
  }

  AssimpFile& file_;
  ImportedScene scene_;
  AssimpMaterials materials_;
  std::map<unsigned, std::vector<std::uint32_t>> meshes_;  // meshes of the scene, by mesh of Assimp
};

}  // namespace

ImportedScene read_part(const ReadRequest& request, AnswerWriter&) {
  AssimpFile file = read_assimp_file(request.file, request.ignore_up_axis);
  return MeshSceneReader(file).read();
}

}  // namespace simvis
