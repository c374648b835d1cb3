// Markers for people: points, lines and arrows in plain colours, gathered into one mesh.
//
// Frames   the mesh's own. Meshes are float32, so what may lie anywhere in the world hangs below a Transform that holds
//          an origin nearby in double, and is given here relative to that. Each corner is rounded once.
// Colours  linear RGBA, kept in the vertices; the material is white and unlit.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/mesh.h>
#include <simvis/node.h>

namespace simvis {

class MarkerMesh {
 public:
  /// An octahedron whose opposite corners are `size_m` apart; none for 0.
  void add_point(const glm::dvec3& center, double size_m, const glm::vec4& color);
  /// A bar of three sides, each `width_m` wide; none for 0 or between equal points.
  void add_line(const glm::dvec3& from, const glm::dvec3& to, double width_m, const glm::vec4& color);
  /// A line with a cone at its end, whose tip is at `to`.
  void add_arrow(const glm::dvec3& from, const glm::dvec3& to, double width_m, const glm::vec4& color);

  /// What was added; nothing is kept.
  std::shared_ptr<const Mesh> take(const std::string& name);

 private:
  std::uint32_t add_vertex(const glm::dvec3& position, const glm::vec4& color);
  std::uint32_t add_ring(const glm::dvec3& center, const glm::dvec3& axis, double radius_m, std::uint32_t corners,
                         const glm::vec4& color);
  void add_cone(const glm::dvec3& base, const glm::dvec3& tip, double radius_m, const glm::vec4& color);
  void add_cap(std::uint32_t ring, std::uint32_t corners, bool front);

  Mesh mesh_;
};

/// The part of the graph that shows a mesh of markers: separator { material, place, shape }, for people only.
/// The material is the opaque one.
struct MarkerNodes {
  std::shared_ptr<VisualSeparator> separator;
  std::shared_ptr<MaterialNode> material;
  std::shared_ptr<Transform> place;  ///< of the mesh's origin
  std::shared_ptr<Shape> shape;      ///< with no mesh in it yet: an empty one
};
MarkerNodes make_marker_nodes(const std::string& name);

/// White and unlit; blended where vertices may be transparent.
std::shared_ptr<const Material> marker_material(AlphaMode mode);

/// A live row for one part of a linear RGB colour.
constexpr AttributeSpec color_row(std::string_view name, std::string_view default_value, std::string_view text) {
  return {.name = name,
          .kind = AttributeKind::number,
          .default_value = default_value,
          .text = text,
          .min = 0,
          .max = 1,
          .live = true};
}

/// No marker is larger, in metres.
inline constexpr double kMaxMarker_m = 10000;

/// A live row for the size of a marker.
constexpr AttributeSpec marker_size_row(std::string_view name, std::string_view default_value, std::string_view text) {
  return {.name = name,
          .kind = AttributeKind::number,
          .default_value = default_value,
          .unit = "m",
          .text = text,
          .min = 0,
          .max = kMaxMarker_m,
          .live = true};
}

}  // namespace simvis
