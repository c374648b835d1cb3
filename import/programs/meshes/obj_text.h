// The text of an OBJ file as arrays.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "import/programs/part_source.h"

namespace simvis {

/// Faces that follow each other in one object with one material.
struct ObjRun {
  std::string name{};              ///< of the object or group
  std::string material{};          ///< empty: none
  std::size_t first = 0, end = 0;  ///< faces, without `end`
};

struct ObjObject {
  std::string name{};
  std::vector<ObjRun> runs{};
};

/// All numbers of a file, in its own axes and unit, neither of which OBJ names. A face has three corners or more; one
/// of two corners is a piece of a line, one of one corner is a point.
struct ObjText {
  std::vector<glm::vec3> positions{}, normals{};  ///< those that a face has are finite; normals need not be
  std::vector<glm::vec4> colors{};                ///< sRGB, of each vertex; empty: none has one
  std::vector<glm::vec2> uvs{};
  /// By corner. `vertex` counts from 0; `uv` and `normal` count from 1, and 0 means none. These two are empty if no
  /// face names any.
  std::vector<std::uint32_t> vertex{}, uv{}, normal{};
  std::vector<std::uint32_t> ends{};  ///< of each face, in `vertex`
  std::vector<ObjObject> objects{};   ///< of `o` and `g`, in the file's order
  std::vector<std::string> material_files{};

  std::size_t first_corner(std::size_t face) const { return face == 0 ? 0 : ends[face - 1]; }
};

/// Throws InputError with the line for a number that is none, a vertex without three coordinates, a corner that names
/// nothing in the file, and more than kMaxPolygonCorners corners of a face (polygon.h).
ObjText read_obj_text(PartSource& source);

}  // namespace simvis
