// Reads mesh files as imported scenes, with one node for each node of the file, in the file's order.
#include <strings.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <assimp/ColladaMetaData.h>

#include <simvis/location.h>
#include "import/programs/assimp_import.h"
#include "import/programs/assimp_materials.h"
#include "import/programs/assimp_meshes.h"
#include "import/programs/back_to_back.h"
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/meshes/obj_file.h"
#include "import/programs/meshes/ply_mesh.h"
#include "import/programs/meshes/stl_file.h"
#include "import/programs/part_reader.h"

namespace simvis {
namespace {

bool is_finite(const aiMatrix4x4& matrix) {
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      if (!std::isfinite(matrix[row][column])) return false;
    }
  }
  return true;
}

glm::dmat4 read_matrix(const AssimpFile& file, const aiMatrix4x4& source) {
  glm::dmat4 matrix{1.0};
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      const double value = source[row][column];
      matrix[static_cast<int>(column)][static_cast<int>(row)] = value;
    }
  }
  if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1) {
    file.fail("a node has a matrix whose last row is not 0 0 0 1");
  }
  return matrix;
}

bool has_meshes(const aiNode& top) {
  std::vector<const aiNode*> stack{&top};
  while (!stack.empty()) {
    const aiNode& node = *stack.back();
    stack.pop_back();
    if (node.mNumMeshes > 0) return true;
    for (unsigned i = 0; i < node.mNumChildren; ++i) stack.push_back(node.mChildren[i]);
  }
  return false;
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
      if (!is_finite(node->mTransformation)) {
        leave_out(*node);
        continue;
      }
      const auto number = static_cast<std::uint32_t>(scene_.nodes.size());
      add_node(*node, parent);
      for (unsigned i = node->mNumChildren; i > 0; --i) stack.push_back({node->mChildren[i - 1], number});
    }
    if (left_out_ > 0) {
      const std::string more = left_out_ > 1 ? " (and " + std::to_string(left_out_ - 1) + " more)" : "";
      file_.warn("node " + in_quotes(first_left_out_) + more +
                 ": its matrix is not finite; it is left out, with what is below it");
    }
    if (scene_.meshes.empty()) file_.fail("holds nothing to draw");
    scene_.warnings = std::move(file_.warnings);
    return std::move(scene_);
  }

 private:
  // The meshes of a mesh of Assimp: at most one of triangles, one of lines and one of points.
  struct Converted {
    std::vector<std::uint32_t> meshes;
    bool one_sided = false;
  };

  // Of COLLADA: its name, else its id. Assimp makes up a name where there is none.
  static std::string name_of(const aiNode& node) {
    const std::string name = node.mName.C_Str();
    aiString id;
    const bool is_made_up = name.starts_with("$ColladaAutoName$");
    if (!is_made_up || node.mMetaData == nullptr || !node.mMetaData->Get(AI_METADATA_COLLADA_ID, id)) return name;
    return id.C_Str();
  }

  // Exporters write such matrices for cameras, which are ignored.
  void leave_out(const aiNode& node) {
    if (has_meshes(node) && left_out_++ == 0) first_left_out_ = name_of(node);
  }

  void add_node(const aiNode& source, std::uint32_t parent) {
    ImportedNode node;
    node.name = name_of(source);
    node.parent = parent;
    node.parent_from_node = read_matrix(file_, source.mTransformation);
    const auto back_to_back = faces_back_to_back(faces_of(source));
    for (unsigned i = 0; i < source.mNumMeshes; ++i) {
      const unsigned mesh = source.mMeshes[i];
      const auto faces = back_to_back.find(i);
      if (faces == back_to_back.end()) {
        add_shapes(mesh, whole(mesh), node);
      } else {
        for (const Converted& part : split(mesh, faces->second)) add_shapes(mesh, part, node);
      }
    }
    scene_.nodes.push_back(std::move(node));
  }

  std::vector<FacedMesh> faces_of(const aiNode& node) const {
    std::vector<FacedMesh> meshes;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *file_.scene->mMeshes[node.mMeshes[i]];
      const auto read = [&mesh](std::size_t number, std::vector<glm::vec3>& corners) {
        const aiFace& face = mesh.mFaces[number];
        for (unsigned corner = 0; corner < face.mNumIndices; ++corner) {
          const aiVector3D& position = mesh.mVertices[face.mIndices[corner]];
          corners.emplace_back(position.x, position.y, position.z);
        }
      };
      meshes.push_back({.material = mesh.mMaterialIndex, .faces = mesh.mNumFaces, .corners = read});
    }
    return meshes;
  }

  void add_shapes(unsigned source, const Converted& converted, ImportedNode& node) {
    const aiMesh& mesh = *file_.scene->mMeshes[source];
    for (const std::uint32_t number : converted.meshes) {
      const bool is_surface = scene_.meshes[number].topology == Topology::triangles;
      node.shapes.push_back(
          {number, materials_.get(mesh.mMaterialIndex, is_surface || mesh.HasNormals(), converted.one_sided)});
    }
  }

  const Converted& whole(unsigned source) {
    const auto [known, is_new] = whole_.try_emplace(source);
    if (is_new) known->second.meshes = add_meshes(source, nullptr);
    return known->second;
  }

  // The faces of which `one_sided` holds, and the others.
  const std::vector<Converted>& split(unsigned source, std::vector<bool> one_sided) {
    const auto [known, is_new] = split_.try_emplace({source, one_sided});
    if (!is_new) return known->second;
    known->second.push_back({add_meshes(source, &one_sided), true});
    one_sided.flip();
    known->second.push_back({add_meshes(source, &one_sided), false});
    return known->second;
  }

  std::vector<std::uint32_t> add_meshes(unsigned source, const std::vector<bool>* faces) {
    std::vector<std::uint32_t> numbers;
    for (Mesh& mesh : convert_mesh(file_, *file_.scene->mMeshes[source], faces)) {
      numbers.push_back(static_cast<std::uint32_t>(scene_.meshes.size()));
      scene_.meshes.push_back(std::move(mesh));
    }
    return numbers;
  }

  AssimpFile& file_;
  ImportedScene scene_;
  AssimpMaterials materials_;
  // By mesh of Assimp, and by its faces that lie back to back.
  std::map<unsigned, Converted> whole_;
  std::map<std::pair<unsigned, std::vector<bool>>, std::vector<Converted>> split_;
  int left_out_ = 0;
  std::string first_left_out_;
};

}  // namespace

const std::span<const std::string_view> kFoldersOfReader;
const HelperProgram kProgramOfReader = HelperProgram::mesh;

ImportedScene read_part(const ReadRequest& request, AnswerWriter&) {
  const auto ends_with = [&](const char* ending) {
    return ::strcasecmp(request.file.extension().c_str(), ending) == 0;
  };
  if (ends_with(".pcd")) return read_pcd(request.file);
  if (ends_with(".las")) return read_las(request.file);
  if (ends_with(".spz")) return read_spz(request.file);
  if (ends_with(".ply")) return read_ply(request.file);
  if (ends_with(".stl")) return read_stl(request.file);
  if (ends_with(".obj")) return read_obj(request.file);
  AssimpFile file = read_assimp_file(request.file, request.ignore_up_axis);
  return MeshSceneReader(file).read();
}

}  // namespace simvis
