#include "import/programs/back_to_back.h"

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
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), comes_first), corners.end());
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

// The faces of a node by their corners: one for each sequence of corners and material, however often a file repeats it.
class FacesByCorners {
 public:
  FacesByCorners(const aiScene& scene, const aiNode& node) : scene_(scene) {
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      MeshFace at{node.mMeshes[i], 0};
      for (; at.face < scene.mMeshes[at.mesh]->mNumFaces; ++at.face) {
        read_corners_of(scene, at, false, corners_);
        const std::size_t hash = hash_of(corners_);
        if (!holds(hash, [&](unsigned material) { return material == material_of(at); })) faces_.emplace(hash, at);
      }
    }
  }

  bool has_back_of(MeshFace at) {
    read_corners_of(scene_, at, true, corners_);
    return corners_.size() >= 3 &&
           holds(hash_of(corners_), [&](unsigned material) { return material != material_of(at); });
  }

 private:
  unsigned material_of(MeshFace at) const { return scene_.mMeshes[at.mesh]->mMaterialIndex; }

  // Whether there is a face with the corners `corners_` whose material passes.
  template <class Passes>
  bool holds(std::size_t hash, const Passes& passes) {
    const auto [first, last] = faces_.equal_range(hash);
    return std::any_of(first, last, [&](const auto& each) {
      if (!passes(material_of(each.second))) return false;
      read_corners_of(scene_, each.second, false, others_);
      return are_equal(corners_, others_);
    });
  }

  const aiScene& scene_;
  std::unordered_multimap<std::size_t, MeshFace> faces_;
  std::vector<aiVector3D> corners_, others_;
};

bool has_several_materials(const aiScene& scene, const aiNode& node) {
  std::set<unsigned> materials;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) materials.insert(scene.mMeshes[node.mMeshes[i]]->mMaterialIndex);
  return materials.size() > 1;
}

}  // namespace

std::map<unsigned, std::vector<bool>> faces_back_to_back(const aiScene& scene, const aiNode& node) {
  std::map<unsigned, std::vector<bool>> found;
  if (!has_several_materials(scene, node)) return found;
  FacesByCorners known(scene, node);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    MeshFace at{node.mMeshes[i], 0};
    const unsigned count = scene.mMeshes[at.mesh]->mNumFaces;
    for (; at.face < count; ++at.face) {
      if (!known.has_back_of(at)) continue;
      std::vector<bool>& faces = found[at.mesh];
      faces.resize(count);
      faces[at.face] = true;
    }
  }
  return found;
}

}  // namespace simvis
