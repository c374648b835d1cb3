// The projection of a view: the rows that transform a mesh to clip coordinates, and tests for content outside the view.
// All arithmetic is in double.
#pragma once

#include <glm/glm.hpp>

#include <simvis/frame_plan.h>
#include <simvis/mesh.h>
#include "shaders/interop.h"

namespace simvis {

/// The projection of a view, computed for one frame.
struct ViewProjection {
  glm::dmat4 view_from_world{1};
  double near_m = 0;
  /// Scale and shift of the viewport, guard rows included: clip.x = scale_x * x + shift_x * z, clip.y = scale_y * y +
  /// shift_y * z, clip.w = z in the view frame.
  double scale_x = 0, shift_x = 0, scale_y = 0, shift_y = 0;
  /// For orthographic views instead: clip.x = scale_x * x + shift_x, clip.y = scale_y * y + shift_y, clip.z =
  /// depth_scale * z + depth_shift, clip.w = 1.
  bool orthographic = false;
  double depth_scale = 0, depth_shift = 0;
  /// Inward unit normals of the planes that contain the sides of the view's rectangle, in the view frame and in the
  /// world's axes; and the distance of the eye inwards from each plane, in metres, which is 0 unless the view is
  /// orthographic.
  glm::dvec3 side_view[4], side_world[4];
  double side_offset[4] = {};
  glm::dvec3 forward_world{0};  ///< the optical axis in the world's axes
};

ViewProjection make_projection(const View& view);

/// The number of rows by which a strip's viewport extends above its rectangle, and as far below, so that the viewport
/// is as high as wide; the scissor cuts these rows off. Triangles that cross a strip then need not be clipped at its
/// long edges, which is the most expensive case for them on a CPU device. 0 for views that are not at least eight times
/// as wide as high, and for orthographic views.
std::uint32_t guard_rows(const View& view);

/// Writes the rows of clip_from_mesh. The product is formed in double and rounded once.
void write_clip_rows(const ViewProjection& projection, const glm::dmat4& world_from_mesh, shader::Instance& instance);

/// A box around a mesh, in the world: centre + a * axis[0] + b * axis[1] + c * axis[2] with a, b, c in [-1, 1].
struct WorldBox {
  glm::dvec3 center{0};
  glm::dvec3 axis[3]{};
  double radius = 0;  ///< radius of the sphere around the box
};

/// The distance, in metres, by which rounding can move the content of a box whose centre is at `center_view` in the
/// view frame.
double rounding_of(const glm::dvec3& center_view, const WorldBox& box);

WorldBox make_box(const glm::dmat4& world_from_mesh, const glm::dvec3& mesh_center, const glm::dvec3& mesh_half);

/// Returns whether no part of the box can appear in the view: it lies beyond a side or before the near plane, by more
/// than the rounding of float32 vertices can compensate.
bool outside(const ViewProjection& projection, const WorldBox& box);

/// Returns whether outside() is certainly true for every box within this one, whose sides are along the world's axes.
bool all_outside(const ViewProjection& projection, const glm::dvec3& center, const glm::dvec3& half_size);

/// The planes of a view in the frame of a mesh, for its clusters.
struct MeshPlanes {
  glm::dvec4 plane[5];  ///< top, bottom, left, right and near: plane . (p, 1) is the distance inwards, in metres
  double slack = 0;     ///< a point farther out than this, in metres, is outside
};

/// `box` is that of the whole mesh with this transform; its rounding bound is valid for each part of the mesh.
MeshPlanes make_mesh_planes(const ViewProjection& projection, const glm::dmat4& world_from_mesh, const WorldBox& box);

/// Returns whether no part of a box in the mesh's frame can appear in the view.
bool outside(const MeshPlanes& planes, const glm::dvec3& center, const glm::dvec3& half_size);

/// Returns whether the whole box lies within the view, also after rounding.
bool inside(const MeshPlanes& planes, const glm::dvec3& center, const glm::dvec3& half_size);

/// Depth along Z of the farthest corner of the box, in metres.
double farthest_depth(const ViewProjection& projection, const WorldBox& box);

/// Returns whether no part of a triangle in the mesh's frame can appear in the view: its corners lie beyond one plane.
bool outside(const MeshPlanes& planes, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

}  // namespace simvis
