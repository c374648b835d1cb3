#include "import/programs/inventor/inventor_shapes.h"

#include <Inventor/SoFullPath.h>
#include <Inventor/VRMLnodes/SoVRMLCoordinate.h>
#include <Inventor/VRMLnodes/SoVRMLPointSet.h>
#include <Inventor/VRMLnodes/SoVRMLVertexLine.h>
#include <Inventor/VRMLnodes/SoVRMLVertexPoint.h>
#include <Inventor/VRMLnodes/SoVRMLVertexShape.h>
#include <Inventor/details/SoFaceDetail.h>
#include <Inventor/details/SoLineDetail.h>
#include <Inventor/fields/SoMFInt32.h>
#include <Inventor/fields/SoSFBool.h>
#include <Inventor/fields/SoSFNode.h>
#include <Inventor/nodes/SoVertexShape.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "engine/base/fnv1a.h"
#include "import/programs/inventor/inventor_round_shapes.h"

namespace simvis {
namespace {

glm::vec3 vec3_of(const SbVec3f& v) { return {v[0], v[1], v[2]}; }

glm::dvec3 cross_of_edges(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

bool is_made_of_vertices(const SoShape& shape) {
  return shape.isOfType(SoVertexShape::getClassTypeId()) || shape.isOfType(SoVRMLVertexShape::getClassTypeId()) ||
         shape.isOfType(SoVRMLVertexLine::getClassTypeId()) || shape.isOfType(SoVRMLVertexPoint::getClassTypeId());
}

// The coordinates of a PointSet of VRML97 are in its own field, and not in the state.
const SoVRMLCoordinate* points_of(const SoShape& shape) {
  if (!shape.isOfType(SoVRMLPointSet::getClassTypeId())) return nullptr;
  SoNode* const points = static_cast<const SoVRMLPointSet&>(shape).coord.getValue();
  const bool is_known = points != nullptr && points->isOfType(SoVRMLCoordinate::getClassTypeId());
  return is_known ? static_cast<const SoVRMLCoordinate*>(points) : nullptr;
}

}  // namespace

// Coin multiplies row vectors from the left, so its rows are glm's columns.
glm::dmat4 matrix_of(const SbMatrix& matrix) {
  glm::dmat4 m;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) m[i][k] = matrix[i][k];
  }
  return m;
}

std::string innermost_name(const SoCallbackAction& action) {
  const auto* const path = static_cast<const SoFullPath*>(const_cast<SoCallbackAction&>(action).getCurPath());
  for (int i = path->getLength(); i-- > 0;) {
    const SbName name = path->getNode(i)->getName();
    if (name.getLength() > 0) return name.getString();
  }
  return {};
}

bool InventorShapes::SameBits::operator()(const Vertex& a, const Vertex& b) const {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

std::size_t InventorShapes::HashBits::operator()(const Vertex& vertex) const {
  static_assert(sizeof(Vertex) % sizeof(std::uint32_t) == 0);
  std::uint32_t words[sizeof(Vertex) / sizeof(std::uint32_t)];
  std::memcpy(words, &vertex, sizeof vertex);
  std::uint64_t hash = kFnv1aStart;
  for (const std::uint32_t word : words) hash = fnv1a_step(hash, word);
  return hash ^ hash >> 32;
}

void InventorShapes::begin(const SoCallbackAction& action, const SoShape& shape) {
  shape_ = &shape;
  look_.reset();
  colors_.clear();
  check_largest_index(shape, action.getNumCoordinates());
}

// Before Coin computes normals, for which it takes memory up to the largest index.
void InventorShapes::check_largest_index(const SoShape& shape, int count) {
  // Of VRML97, and of Inventor where they are not those before the shape.
  for (const char* const name : {"coord", "vertexProperty"}) {
    const SoField* const own = shape.getField(name);
    const SoNode* const node = own == nullptr ? nullptr : static_cast<const SoSFNode*>(own)->getValue();
    if (own != nullptr && name == std::string_view("coord") && node == nullptr) return;
    if (node == nullptr) continue;
    if (!node->isOfType(SoVRMLCoordinate::getClassTypeId())) return;
    count = static_cast<const SoVRMLCoordinate*>(node)->point.getNum();
  }
  const SoField* const field = shape.getField("coordIndex");
  if (field == nullptr || !field->isOfType(SoMFInt32::getClassTypeId())) return;
  const auto& indices = *static_cast<const SoMFInt32*>(field);
  const std::int32_t* const values = indices.getValues(0);
  const std::int32_t largest = indices.getNum() > 0 ? *std::max_element(values, values + indices.getNum()) : 0;
  check_index(largest, count, "coordinate");
}

void InventorShapes::check_index(int index, int count, const char* what) {
  if (count == 0 || index < count || !fault_.empty()) return;
  fault_ = "a shape uses the " + std::string(what) + " " + std::to_string(index) + ", but there are " +
           std::to_string(count) + ", counted from 0";
}

// The state holds the shape's own properties (colours, hints) only while Coin generates its primitives.
bool InventorShapes::starts_primitive(SoCallbackAction& action, std::size_t corners) {
  if (shape_ == nullptr || has_too_many()) return false;
  if (!look_) read_state(action, corners == 3);
  if (style_ == SoDrawStyle::INVISIBLE) return false;
  corners_ += corners;
  return !has_too_many();
}

void InventorShapes::read_state(SoCallbackAction& action, bool is_surface) {
  look_ = looks_.look(action, *shape_, is_surface);
  style_ = action.getDrawStyle();
  const bool indexed = is_made_of_vertices(*shape_);
  coordinates_ = indexed ? action.getNumCoordinates() : 0;
  if (const SoVRMLCoordinate* const points = points_of(*shape_)) coordinates_ = points->point.getNum();
  normals_ = indexed ? static_cast<int>(action.getNumNormals()) : 0;
  uvs_ = indexed && look_->textured ? action.getNumTextureCoordinates() : 0;
  // VRML97 stores in a field of the shape the hint that Inventor stores in a ShapeHints node before the shape.
  const SoField* const ccw = shape_->getField("ccw");
  if (ccw != nullptr && ccw->isOfType(SoSFBool::getClassTypeId())) {
    ordering_known_ = true;
    clockwise_ = static_cast<const SoSFBool*>(ccw)->getValue() == 0;
  } else {
    ordering_known_ = action.getVertexOrdering() != SoShapeHints::UNKNOWN_ORDERING;
    clockwise_ = action.getVertexOrdering() == SoShapeHints::CLOCKWISE;
  }
}

// Coin reads beyond the end of its arrays if a file's indices or counts are too large.
void InventorShapes::check_indices(const SoPointDetail& detail) {
  check_index(detail.getCoordinateIndex(), coordinates_, "coordinate");
  check_index(detail.getNormalIndex(), normals_, "normal");
  if (uvs_ > 0 && detail.getTextureCoordIndex() >= uvs_) has_uvs_ = false;
}

// All vertices of a primitive share one detail.
void InventorShapes::check_indices(const SoDetail* detail) {
  has_uvs_ = true;
  if (const auto* const point = dynamic_cast<const SoPointDetail*>(detail)) {
    check_indices(*point);
  } else if (const auto* const line = dynamic_cast<const SoLineDetail*>(detail)) {
    check_indices(*line->getPoint0());
    check_indices(*line->getPoint1());
  } else if (const auto* const face = dynamic_cast<const SoFaceDetail*>(detail)) {
    for (int i = 0; i < face->getNumPoints(); ++i) check_indices(*face->getPoint(i));
  }
  if (!has_uvs_) looks_.warn("texture coordinates beyond those that the file gives are taken as 0 0");
}

InventorShapes::Vertex InventorShapes::vertex_of(SoCallbackAction& action, const SoPrimitiveVertex& source) {
  Vertex vertex{vec3_of(source.getPoint()), {}};
  const glm::dvec3 normal = vec3_of(source.getNormal());
  const double length = glm::length(normal);
  if (length != 0) vertex.attributes.normal = glm::vec3(normal / length);
  if (look_->textured && has_uvs_) {
    const SbVec4f& uv = source.getTextureCoords();
    const double q = uv[3] == 0 ? 1 : uv[3];
    vertex.attributes.uv[0] = {uv[0] / q, 1 - uv[1] / q};
  }
  const auto [color, is_new] = colors_.try_emplace(source.getMaterialIndex());
  if (is_new) color->second = InventorLooks::color(action, *look_, source.getMaterialIndex());
  vertex.attributes.color = color->second;
  return vertex;
}

void InventorShapes::add(Growing& growing, const Vertex& vertex) {
  Mesh& mesh = growing.mesh;
  const auto [entry, is_new] = growing.known.try_emplace(vertex, static_cast<std::uint32_t>(mesh.positions.size()));
  if (is_new) {
    mesh.positions.push_back(vertex.position);
    mesh.attributes.push_back(vertex.attributes);
  }
  mesh.indices.push_back(entry->second);
}

void InventorShapes::triangle(SoCallbackAction& action, const SoPrimitiveVertex* const (&corners)[3]) {
  if (!starts_primitive(action, 3)) return;
  check_indices(corners[0]->getDetail());
  Vertex v[3];
  for (int i = 0; i < 3; ++i) v[i] = vertex_of(action, *corners[i]);
  if (style_ == SoDrawStyle::POINTS) {
    for (const Vertex& vertex : v) add(growing_[static_cast<int>(Topology::points)], vertex);
    return;
  }
  if (style_ == SoDrawStyle::LINES) {
    for (int i = 0; i < 3; ++i) {
      add(growing_[static_cast<int>(Topology::lines)], v[i]);
      add(growing_[static_cast<int>(Topology::lines)], v[(i + 1) % 3]);
    }
    return;
  }
  const glm::dvec3 facing = cross_of_edges(v[0].position, v[1].position, v[2].position);
  const double area = glm::length(facing);
  for (int i = 0; i < 3; ++i) {
    const bool has_normal = corners[i]->getNormal() != SbVec3f(0, 0, 0);
    if (!has_normal && area > 0) v[i].attributes.normal = glm::vec3(facing / area);
  }
  // If the vertex ordering is unknown, Inventor shades by the normals alone. The corners are therefore ordered by the
  // normals.
  const glm::dvec3 normals =
      glm::dvec3(v[0].attributes.normal) + glm::dvec3(v[1].attributes.normal) + glm::dvec3(v[2].attributes.normal);
  if (ordering_known_ ? clockwise_ : glm::dot(facing, normals) < 0) std::swap(v[1], v[2]);
  for (const Vertex& vertex : v) add(growing_[static_cast<int>(Topology::triangles)], vertex);
}

void InventorShapes::line(SoCallbackAction& action, const SoPrimitiveVertex* const (&ends)[2]) {
  if (!starts_primitive(action, 2)) return;
  check_indices(ends[0]->getDetail());
  for (const SoPrimitiveVertex* const end : ends) {
    add(growing_[static_cast<int>(Topology::lines)], vertex_of(action, *end));
  }
}

void InventorShapes::point(SoCallbackAction& action, const SoPrimitiveVertex& vertex) {
  if (!starts_primitive(action, 1)) return;
  check_indices(vertex.getDetail());
  Vertex point = vertex_of(action, vertex);
  if (!has_normals(action, *shape_) || vertex.getNormal() == SbVec3f(0, 0, 0)) point.attributes.normal = glm::vec3(0);
  add(growing_[static_cast<int>(Topology::points)], point);
}

void InventorShapes::end(SoCallbackAction& action) {
  for (int topology = 0; topology < 3; ++topology) {
    growing_[topology].mesh.topology = static_cast<Topology>(topology);
    if (!growing_[topology].mesh.indices.empty()) finish(action, growing_[topology]);
    growing_[topology] = {};
  }
  shape_ = nullptr;
}

void InventorShapes::finish(SoCallbackAction& action, Growing& growing) {
  Mesh& mesh = growing.mesh;
  ImportedMaterial material = look_->material;
  const glm::vec4 first = mesh.attributes.front().color;
  bool one_color = true, transparent = false;
  for (const VertexAttributes& attributes : mesh.attributes) {
    one_color = one_color && attributes.color == first;
    transparent = transparent || attributes.color.a < 1;
  }
  // A single colour is stored in the material, so that shapes of different colours can share a mesh.
  if (one_color) {
    material.material.base_color = first;
    for (VertexAttributes& attributes : mesh.attributes) attributes.color = glm::vec4(1);
  }
  if (transparent) material.material.alpha_mode = AlphaMode::blend;
  // The texture coordinates of Coin's triangles are those of no exact shape.
  const bool is_plain = one_color && !look_->textured && style_ == SoDrawStyle::FILLED;
  if (is_plain && mesh.topology == Topology::triangles) mesh.surface = round_shape_of(*shape_, mesh);
  ImportedNode node;
  node.name = innermost_name(action);
  node.parent_from_node = matrix_of(action.getModelMatrix());
  const std::uint32_t look = looks_.add(std::move(material));
  node.shapes.push_back({number_of(std::move(mesh)), look});
  scene_.nodes.push_back(std::move(node));
}

std::uint32_t InventorShapes::number_of(Mesh&& mesh) {
  std::shared_ptr<const Mesh> shared = pool_.intern(std::move(mesh));
  const auto [entry, is_new] = numbers_.try_emplace(shared.get(), static_cast<std::uint32_t>(scene_.meshes.size()));
  if (is_new) {
    scene_.meshes.push_back(*shared);
    kept_.push_back(std::move(shared));
  }
  return entry->second;
}

}  // namespace simvis
