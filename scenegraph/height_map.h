// The surface of a picture of heights.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>
#include "scenegraph/picture_reader.h"

namespace simvis {

/// A surface that holds the picture without rounding: the vertices stand at multiples of powers of two, and `place`,
/// in double, brings them to the heights and distances of the scene.
struct HeightMap {
  Mesh mesh;
  glm::dmat4 place{1.0};  ///< scales by 1 to 2 along each axis, and lifts by low_m
};

/// Each pixel is a vertex; the outer pixels lie on the edges of a rectangle of `size_m` around the origin. The
/// picture's left column is at -x and its top row at +y. A value v of the file has the height low_m + v * (high_m -
/// low_m). Each cell of four pixels is two triangles, which meet between its top left and its bottom right pixel.
/// Normals are those of central differences; texture coordinates are those of the picture. The picture has at least two
/// pixels on a side, and `size_m` is above 0; `high_m` may be `low_m` or less.
HeightMap height_map(const HeightPicture& picture, const glm::dvec2& size_m, double low_m, double high_m);

/// The same in one mesh, in metres, each coordinate rounded once to float32.
Mesh mesh_in_place(const HeightMap& map);

}  // namespace simvis
