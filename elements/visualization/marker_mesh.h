// Markers for visualization: points, lines and arrows in plain colours, collected in one mesh.
//
// Frames   the mesh's own frame. Meshes are float32. Markers that may lie anywhere in the world therefore stand below a
//          Transform that holds a nearby origin in double precision, and their coordinates are relative to that origin.
//          Each corner is rounded once.
// Colours  linear RGBA, stored in the vertices; the material is white and unlit.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/mesh.h>
#include <simvis/node.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

class MarkerMesh {
 public:
  /// Adds an octahedron whose opposite corners are `size_m` apart. Adds nothing for the size 0.
  void add_point(const glm::dvec3& center, double size_m, const glm::vec4& color);
  /// Adds a bar with three sides, each `width_m` wide. Adds nothing for the width 0 or between equal points.
  void add_line(const glm::dvec3& from, const glm::dvec3& to, double width_m, const glm::vec4& color);
  /// Adds a line with a cone at its end. The tip of the cone is at `to`.
  void add_arrow(const glm::dvec3& from, const glm::dvec3& to, double width_m, const glm::vec4& color);

  /// Returns a mesh of all added markers, and clears this object. It is short-lived: markers are drawn
  /// again when what they show changes.
  std::shared_ptr<const Mesh> take(const std::string& name);

 private:
  std::uint32_t add_vertex(const glm::dvec3& position, const glm::vec4& color);
  std::uint32_t add_ring(const glm::dvec3& center, const glm::dvec3& axis, double radius_m, std::uint32_t corners,
                         const glm::vec4& color);
  void add_cone(const glm::dvec3& base, const glm::dvec3& tip, double radius_m, const glm::vec4& color);
  void add_cap(std::uint32_t ring, std::uint32_t corners, bool front);

  Mesh mesh_;
};

/// The subgraph that shows a mesh of markers: separator { material, place, shape }. Only visualization cameras see it.
/// The material is opaque.
struct MarkerNodes {
  std::shared_ptr<VisualSeparator> separator;
  std::shared_ptr<MaterialNode> material;
  std::shared_ptr<Transform> place;  ///< position of the mesh's origin
  std::shared_ptr<Shape> shape;      ///< holds an empty mesh at first
};
MarkerNodes make_marker_nodes(const std::string& name);

/// Returns a white and unlit material. `mode` is blend if vertices may be transparent.
std::shared_ptr<const Material> marker_material(AlphaMode mode);

/// The largest size of a marker in metres.
inline constexpr double kMaxMarker_m = 10000;
inline constexpr AttributeLimits kMarkerSize_m{.min = 0, .max = kMaxMarker_m}, kMarkerColor{.min = 0, .max = 1};

}  // namespace simvis
