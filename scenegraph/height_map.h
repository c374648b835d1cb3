// The mesh of a picture of heights.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>
#include "scenegraph/picture_reader.h"

namespace simvis {

/// Each pixel is a vertex; the outer pixels lie on the edges of a rectangle of `size_m` around the origin. The
/// picture's left column is at -x and its top row at +y. A value v has the height low_m + v * (high_m - low_m). Each
/// cell of four pixels is two triangles, which meet between its top left and its bottom right pixel. Normals are those
/// of central differences; texture coordinates are those of the picture.
Mesh height_map_mesh(const HeightPicture& picture, const glm::dvec2& size_m, double low_m, double high_m);

}  // namespace simvis
