// What a view sees: the rows that take a mesh to clip coordinates, and what lies outside. Plain arithmetic in double.
#pragma once

#include <glm/glm.hpp>

#include <simvis/frame_plan.h>
#include <simvis/mesh.h>
#include "shaders/interop.h"

namespace simvis {

/// A view, worked out for one frame.
struct ViewProjection {
  glm::dmat4 view_from_world{1};
  double near_m = 0;
  /// Of the viewport, guard rows included: clip.x = scale_x * x + shift_x * z, clip.y = scale_y * y + shift_y * z,
  /// clip.w = z in the view frame.
  double scale_x = 0, shift_x = 0, scale_y = 0, shift_y = 0;
  /// Of parallel views instead: clip.x = scale_x * x + shift_x, clip.y likewise, clip.z = depth_scale * z +
  /// depth_shift, clip.w = 1.
  bool orthographic = false;
  double depth_scale = 0, depth_shift = 0;
  /// Unit normals, pointing inwards, of the planes that the rectangle's sides lie in, in the view frame, and the same
  /// turned into the world's axes; how far inwards the eye lies, in metres: 0 unless the view is parallel.
  glm::dvec3 side_view[4], side_world[4];
  double side_offset[4] = {};
  glm::dvec3 forward_world{0};  ///< the optical axis in the world's axes
};

ViewProjection make_projection(const View& view);

/// Rows above and below a strip's rectangle that its viewport covers as well, the scissor cutting them off: the
/// viewport is as high as wide. So the triangles that cross a strip need not be cut at its long edges, which is the
/// dearest thing that can happen to them on a CPU device. 0 for views that are not at least eight times as wide as
/// high.
std::uint32_t guard_rows(const View& view);

/// Writes the rows of clip_from_mesh. The product is formed in double and rounded once.
void write_clip_rows(const ViewProjection& projection, const glm::dmat4& world_from_mesh, shader::Instance& instance);

/// A box around a mesh, in the world: centre + a * axis[0] + b * axis[1] + c * axis[2] with a, b, c in [-1, 1].
struct WorldBox {
  glm::dvec3 center{0};
  glm::dvec3 axis[3]{};
  double radius = 0;  ///< of the sphere around it
};

/// By how much rounding can move what lies in a box whose centre is seen here in the view frame, in metres.
double rounding_of(const glm::dvec3& center_view, const WorldBox& box);

WorldBox make_box(const glm::dmat4& world_from_mesh, const glm::dvec3& mesh_center, const glm::dvec3& mesh_half);

/// Whether nothing of the box can appear in the view: it lies beyond a side or before the near plane, by more than
/// the rounding of float32 vertices could take back.
bool outside(const ViewProjection& projection, const WorldBox& box);

/// Whether outside() is certain of every box that lies within this one, whose sides are along the world's axes.
bool all_outside(const ViewProjection& projection, const glm::dvec3& center, const glm::dvec3& half_size);

/// The planes of a view in the frame of a mesh, for its clusters.
struct MeshPlanes {
  glm::dvec4 plane[5];  ///< top, bottom, left, right and near: plane . (p, 1) is the distance inwards, in metres
  double slack = 0;     ///< what is farther out than this is outside
};

/// `box` is that of the whole mesh at the same place; its rounding is enough for each of its parts.
MeshPlanes make_mesh_planes(const ViewProjection& projection, const glm::dmat4& world_from_mesh, const WorldBox& box);

/// Whether nothing of a box in the mesh's frame can appear in the view.
bool outside(const MeshPlanes& planes, const glm::dvec3& center, const glm::dvec3& half_size);

/// Whether all of the box lies within the view, and would after rounding, too.
bool inside(const MeshPlanes& planes, const glm::dvec3& center, const glm::dvec3& half_size);

/// Depth along the optical axis of the farthest corner of the box, in metres.
double farthest_depth(const ViewProjection& projection, const WorldBox& box);

/// Whether nothing of a triangle in the mesh's frame can appear in the view: its corners lie beyond one plane.
bool outside(const MeshPlanes& planes, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

}  // namespace simvis
