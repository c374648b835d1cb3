#include "import/programs/back_to_back.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>

namespace simvis {
namespace {

struct MeshFace {
  const FacedMesh* mesh = nullptr;
  std::size_t face = 0;
};

bool comes_first(const glm::vec3& a, const glm::vec3& b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Corners in the order of the face, from the one that comes first: the same for all rotations of a face.
void read_corners_of(MeshFace at, bool reversed, std::vector<glm::vec3>& corners) {
  corners.clear();
  at.mesh->corners(at.face, corners);
  if (reversed) std::ranges::reverse(corners);
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), comes_first), corners.end());
}

std::size_t hash_of(const std::vector<glm::vec3>& corners) {
  std::size_t hash = corners.size();
  for (const glm::vec3& corner : corners) {
    for (const float value : {corner.x, corner.y, corner.z}) {
      constexpr std::size_t kOddNumber = 0x9e3779b97f4a7c15u;
      hash = (hash ^ std::hash<float>()(value)) * kOddNumber;  // std::hash: 0 and -0 are equal
      hash ^= hash >> 32;
    }
  }
  return hash;
}

// The faces of a node by their corners: at most two materials for each sequence of corners, however often a file
// repeats it. Two tell for any third whether there is another.
class FacesByCorners {
 public:
  explicit FacesByCorners(const std::vector<FacedMesh>& meshes) {
    for (const FacedMesh& mesh : meshes) {
      for (MeshFace at{&mesh, 0}; at.face < mesh.faces; ++at.face) {
        read_corners_of(at, false, corners_);
        const std::size_t hash = hash_of(corners_);
        if (is_needed(hash, mesh.material)) faces_.emplace(hash, at);
      }
    }
  }

  bool has_back_of(MeshFace at) {
    read_corners_of(at, true, corners_);
    return corners_.size() >= 3 &&
           holds(hash_of(corners_), [&](std::uint32_t material) { return material != at.mesh->material; });
  }

 private:
  // Whether a face with the corners `corners_` tells something new.
  bool is_needed(std::size_t hash, std::uint32_t material) {
    int others = 0;
    const auto is_enough = [&](std::uint32_t known) { return known == material || ++others == 2; };
    const auto [first, last] = faces_.equal_range(hash);
    return std::none_of(first, last, [&](const auto& each) {
      read_corners_of(each.second, false, others_);
      return corners_ == others_ && is_enough(each.second.mesh->material);
    });
  }

  // Whether there is a face with the corners `corners_` whose material passes.
  template <class Passes>
  bool holds(std::size_t hash, const Passes& passes) {
    const auto [first, last] = faces_.equal_range(hash);
    return std::any_of(first, last, [&](const auto& each) {
      if (!passes(each.second.mesh->material)) return false;
      read_corners_of(each.second, false, others_);
      return corners_ == others_;
    });
  }

  std::unordered_multimap<std::size_t, MeshFace> faces_;
  std::vector<glm::vec3> corners_, others_;
};

}  // namespace

std::map<std::size_t, std::vector<bool>> faces_back_to_back(const std::vector<FacedMesh>& meshes) {
  std::map<std::size_t, std::vector<bool>> found;
  const auto is_other = [&](const FacedMesh& mesh) { return mesh.material != meshes.front().material; };
  if (std::ranges::none_of(meshes, is_other)) return found;
  FacesByCorners known(meshes);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    for (MeshFace at{&meshes[i], 0}; at.face < meshes[i].faces; ++at.face) {
      if (!known.has_back_of(at)) continue;
      std::vector<bool>& faces = found[i];
      faces.resize(meshes[i].faces);
      faces[at.face] = true;
    }
  }
  return found;
}

}  // namespace simvis
