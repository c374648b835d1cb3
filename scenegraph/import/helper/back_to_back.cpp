#include "scenegraph/import/helper/back_to_back.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <unordered_map>

namespace simvis {
namespace {

struct MeshFace {
  unsigned mesh = 0, face = 0;
};

bool comes_first(const aiVector3D& a, const aiVector3D& b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Corners in the order of the face, from the one that comes first: the same for all rotations of a face.
void read_corners_of(const aiScene& scene, MeshFace at, bool reversed, std::vector<aiVector3D>& corners) {
  const aiMesh& mesh = *scene.mMeshes[at.mesh];
  const aiFace& face = mesh.mFaces[at.face];
  corners.clear();
  for (unsigned i = 0; i < face.mNumIndices; ++i) corners.push_back(mesh.mVertices[face.mIndices[i]]);
  if (reversed) std::ranges::reverse(corners);
  std::ranges::rotate(corners, std::ranges::min_element(corners, comes_first));
}

bool are_equal(const std::vector<aiVector3D>& a, const std::vector<aiVector3D>& b) {
  return std::ranges::equal(
      a, b, [](const aiVector3D& p, const aiVector3D& q) { return p.x == q.x && p.y == q.y && p.z == q.z; });
}

std::size_t hash_of(const std::vector<aiVector3D>& corners) {
  std::size_t hash = corners.size();
  for (const aiVector3D& corner : corners) {
    for (const float value : {corner.x, corner.y, corner.z}) {
      constexpr std::size_t kOddNumber = 0x9e3779b97f4a7c15u;
      hash = (hash ^ std::hash<float>()(value)) * kOddNumber;  // std::hash: 0 and -0 are equal
      hash ^= hash >> 32;
    }
  }
  return hash;
}

bool has_several_materials(const aiScene& scene, const aiNode& node) {
  std::set<unsigned> materials;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) materials.insert(scene.mMeshes[node.mMeshes[i]]->mMaterialIndex);
  return materials.size() > 1;
}

}  // namespace

std::map<unsigned, std::vector<bool>> faces_back_to_back(const aiScene& scene, const aiNode& node) {
  std::map<unsigned, std::vector<bool>> found;
  if (!has_several_materials(scene, node)) return found;
  const auto mark = [&](MeshFace at) {
    std::vector<bool>& faces = found[at.mesh];
    faces.resize(scene.mMeshes[at.mesh]->mNumFaces);
    faces[at.face] = true;
  };
  std::unordered_multimap<std::size_t, MeshFace> seen;
  std::vector<aiVector3D> corners, others;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    MeshFace at{node.mMeshes[i], 0};
    const aiMesh& mesh = *scene.mMeshes[at.mesh];
    for (; at.face < mesh.mNumFaces; ++at.face) {
      if (mesh.mFaces[at.face].mNumIndices < 3) continue;
      read_corners_of(scene, at, true, corners);
      const auto [first, last] = seen.equal_range(hash_of(corners));
      for (auto each = first; each != last; ++each) {
        read_corners_of(scene, each->second, false, others);
        if (scene.mMeshes[each->second.mesh]->mMaterialIndex == mesh.mMaterialIndex || !are_equal(corners, others)) {
          continue;
        }
        mark(at);
        mark(each->second);
      }
      read_corners_of(scene, at, false, corners);
      seen.emplace(hash_of(corners), at);
    }
  }
  return found;
}

}  // namespace simvis
