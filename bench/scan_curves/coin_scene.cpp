#include "bench/scan_curves/coin_scene.h"

#include <Inventor/SbViewportRegion.h>
#include <Inventor/SoDB.h>
#include <Inventor/actions/SoGetBoundingBoxAction.h>
#include <Inventor/nodes/SoCoordinate3.h>
#include <Inventor/nodes/SoIndexedFaceSet.h>
#include <Inventor/nodes/SoLightModel.h>
#include <Inventor/nodes/SoMatrixTransform.h>

#include <cstdint>
#include <vector>

#include "bench/bare_embree.h"

namespace simvis::bench {

namespace {

SoGroup* shape_of(const Mesh& mesh) {
  auto* const shape = new SoGroup;
  auto* const coordinates = new SoCoordinate3;
  coordinates->point.setValues(0, static_cast<int>(mesh.positions.size()),
                               reinterpret_cast<const float(*)[3]>(mesh.positions.data()));
  std::vector<std::int32_t> corners;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) corners.push_back(static_cast<std::int32_t>(mesh.indices[i + k]));
    corners.push_back(-1);
  }
  auto* const faces = new SoIndexedFaceSet;
  faces->coordIndex.setValues(0, static_cast<int>(corners.size()), corners.data());
  shape->addChild(coordinates);
  shape->addChild(faces);
  return shape;
}

SbMatrix to_coin(const glm::dmat4& m) {
  SbMatrix matrix;  // for row vectors: its rows are the columns of a matrix for column vectors
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix[row][column] = static_cast<float>(m[row][column]);
  }
  return matrix;
}

}  // namespace

SbVec3f to_coin(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

CoinScene make_coin_scene(const DrawList& list) {
  SoDB::init();
  auto* const root = new SoSeparator;
  root->ref();
  root->renderCaching = SoSeparator::OFF;  // so that items are culled individually
  auto* const unlit = new SoLightModel;
  unlit->model = SoLightModel::BASE_COLOR;
  root->addChild(unlit);
  std::vector<SoGroup*> shapes(list.meshes.size());
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (mesh.topology != Topology::triangles || lets_pass(*list.materials[item.material])) continue;
    SoGroup*& shape = shapes[item.mesh];
    if (shape == nullptr) shape = shape_of(mesh);
    auto* const placed = new SoSeparator;
    placed->renderCaching = SoSeparator::ON;
    placed->renderCulling = SoSeparator::ON;
    placed->boundingBoxCaching = SoSeparator::ON;
    placed->pickCulling = SoSeparator::ON;
    auto* const place = new SoMatrixTransform;
    place->matrix = to_coin(list.world_from_node[item.transform]);
    placed->addChild(place);
    placed->addChild(shape);
    root->addChild(placed);
  }
  SoGetBoundingBoxAction boxes(SbViewportRegion(1, 1));  // culling uses cached boxes
  boxes.apply(root);
  return CoinScene(root);
}

}  // namespace simvis::bench
