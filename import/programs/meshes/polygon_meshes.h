// Turns the polygons of a mesh file into SimVis meshes.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include <simvis/mesh.h>
#include "import/programs/part_source.h"
#include "import/programs/vertex_numbers.h"

namespace simvis {

/// A corner of a polygon. A zero normal means that the file has none.
struct PolygonCorner {
  glm::vec3 position{0};
  VertexAttributes attributes{};
};

/// The values of a corner, from those of a file. Normals are scaled to unit length, and are zero if that is not
/// possible. Texture coordinates have v up in files. Those that are not finite become 0 0, and sRGB colours that are
/// negative or not finite white, with a warning. Throws InputError for a position that is not finite.
glm::vec3 corner_position(const PartSource& source, std::size_t vertex, const glm::vec3& position);
glm::vec3 corner_normal(const glm::vec3& normal);
glm::vec2 corner_uv(PartSource& source, const glm::vec2& uv);
glm::vec4 corner_color(PartSource& source, const glm::vec4& srgb);

/// Collects polygons. Corners with equal bits become one vertex.
class PolygonMeshes {
 public:
  /// `source` must outlive this object.
  PolygonMeshes(PartSource& source, const std::string& name);

  /// Adds a polygon, which is cut into triangles, a line of two corners, or a point of one. A corner without a normal
  /// gets that of its face. Throws InputError for more than kMaxPolygonCorners corners.
  void add(std::span<const PolygonCorner> corners);

  /// Returns at most one mesh of triangles, one of lines and one of points; no mesh is empty. Warns if only some
  /// corners had normals. Throws InputError for more than 2^32 - 1 corners in total.
  std::vector<Mesh> take();

 private:
  struct Builder {
    Mesh mesh{};
    VertexNumbers numbers{};

    void add(PolygonCorner corner);
  };
  static void add_triangle(const std::array<PolygonCorner, 3>& corners, Builder& builder);
  void add_polygon(std::span<const PolygonCorner> corners);

  PartSource& source_;
  std::array<Builder, 3> builders_;  // by topology
  bool lacks_normals_ = false, has_normals_ = false;
};

}  // namespace simvis
