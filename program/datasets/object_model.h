// The shape of an item as a model of its own: triangles in the frame of its box.
//
// Frames   B = the item's box in the table `boxes`: its origin is the middle of the box, its axes are the item's.
// Units    millimetres, as BOP has them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include <simvis/draw_list.h>

namespace simvis {

inline constexpr double kMillimetres = 1000;  ///< of a metre

struct ObjectModel {
  std::vector<glm::vec3> positions_mm, normals;
  std::vector<std::uint32_t> indices;  ///< three for each triangle
  glm::dvec3 low_mm{0}, high_mm{0};    ///< of positions_mm
};

/// The factors by which an item is larger than its mesh along its axes, to nine digits, so that they are the same in
/// every frame. Throws InputError naming `what` if it is sheared or mirrored: it has no such factors.
glm::dvec3 scale_of(const DrawList& list, std::uint32_t item, const std::string& what);

/// A hash of the model that object_model() gives. A model of triangles has vertices.
std::uint64_t model_hash(const Mesh& mesh, const glm::dvec3& scale);
ObjectModel object_model(const Mesh& mesh, const glm::dvec3& scale);

/// The largest distance between two vertices.
double diameter_mm(const ObjectModel& model);

/// PLY, binary little-endian: x y z nx ny nz as float32, triangles as uchar and int32.
std::string model_ply(const ObjectModel& model);

}  // namespace simvis
