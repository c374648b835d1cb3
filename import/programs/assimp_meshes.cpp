#include "import/programs/assimp_meshes.h"

#include <string>

#include "import/programs/meshes/polygon_meshes.h"

namespace simvis {
namespace {

glm::vec3 vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

PolygonCorner read_corner(AssimpFile& file, const aiMesh& source, unsigned index) {
  PolygonCorner corner{corner_position(file, index, vec3(source.mVertices[index]))};
  corner.attributes.normal = source.HasNormals() ? corner_normal(vec3(source.mNormals[index])) : glm::vec3(0);
  for (unsigned set = 0; set < 2; ++set) {
    if (!source.HasTextureCoords(set)) continue;
    corner.attributes.uv[set] = corner_uv(file, glm::vec2(vec3(source.mTextureCoords[set][index])));
  }
  if (source.HasVertexColors(0)) {
    const aiColor4D& color = source.mColors[0][index];
    corner.attributes.color = corner_color(file, {color.r, color.g, color.b, color.a});
  }
  return corner;
}

}  // namespace

std::vector<Mesh> convert_mesh(AssimpFile& file, const aiMesh& source, const std::vector<bool>* faces) {
  PolygonMeshes meshes(file, source.mName.C_Str());
  std::vector<PolygonCorner> corners;
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    if (faces != nullptr && !(*faces)[f]) continue;
    const aiFace& face = source.mFaces[f];
    corners.clear();
    for (unsigned i = 0; i < face.mNumIndices; ++i) corners.push_back(read_corner(file, source, face.mIndices[i]));
    meshes.add(corners);
  }
  // For a file with points only, Assimp returns vertices without faces.
  for (unsigned i = 0; source.mNumFaces == 0 && i < source.mNumVertices; ++i) {
    const PolygonCorner corner = read_corner(file, source, i);
    meshes.add({&corner, 1});
  }
  return meshes.take();
}

}  // namespace simvis
