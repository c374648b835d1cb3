// The shape of an object as a model of its own: triangles in the frame of its box.
//
// Frames   B = the object's box in the table `boxes`: its origin is the middle of the box, its axes are those of the
//          object's frame.
// Units    millimetres, as BOP has them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/object_tree.h>

namespace simvis {

inline constexpr double kMillimetres = 1000;  ///< of a metre

struct ObjectModel {
  std::vector<glm::vec3> positions_mm, normals;
  std::vector<std::uint32_t> indices;  ///< three for each triangle
  glm::dvec3 low_mm{0}, high_mm{0};    ///< of positions_mm
};

/// The factors by which an object is larger than in its frame along the axes of that, to nine digits, so that they are
/// the same in every frame of a run. Throws InputError naming `what` if it is sheared or mirrored: it has no such
/// factors.
glm::dvec3 scale_of(const DrawList& list, const SceneObject& object, const std::string& what);

/// Whether the object has triangles.
bool has_model(const DrawList& list, const SceneObject& object);
/// A hash of the model that object_model() gives of an object with triangles.
std::uint64_t model_hash(const DrawList& list, const SceneObject& object, const glm::dvec3& scale);
ObjectModel object_model(const DrawList& list, const SceneObject& object, const glm::dvec3& scale);

/// The largest distance between two vertices.
double diameter_mm(const ObjectModel& model);

/// PLY, binary little-endian: x y z nx ny nz as float32, triangles as uchar and int32.
std::string model_ply(const ObjectModel& model);

}  // namespace simvis
