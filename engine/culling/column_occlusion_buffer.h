// Occlusion culling of single triangles for strip views of depth, column by column, before the device draws them.
//
// A strip is a few rows high, so its depth is nearly a function of the column. In the first pass, every triangle that
// fills a column from top to bottom lowers that column's far limit. In the second pass, a triangle is culled if it lies
// behind the limit in all of its columns, or if it meets no column that is read. Depth is the nearest surface drawn, in
// any order, so culling changes no bit of the depth that is read.
//
// A culled triangle is certainly invisible: see pixel_polygon.h. Occludees are grown by one pixel, occluders are
// shrunk.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/culling/pixel_polygon.h"
#include "engine/culling/strip_columns.h"
#include "engine/geometry/clusters.h"

namespace simvis {

/// A triangle in a strip view.
struct StripTriangle {
  std::uint32_t owner = 0;        ///< the owner given to place()
  std::uint32_t corners[3] = {};  ///< indices into the positions given to add()
};

/// Reuses its memory from view to view.
class ColumnOcclusionBuffer {
 public:
  /// Starts a view without triangles. `columns` are the view's and must stay alive until the next begin().
  void begin(const View& view, const StripColumns& columns);

  /// Sets the owner and the transform of the triangles that are added next. Rounding moves the mesh's vertices by up to
  /// `slack_m`, in any direction.
  void place(std::uint32_t owner, const glm::dmat4& view_from_mesh, double slack_m);

  /// Adds triangles without holes that are drawn from both sides. `corners` holds three indices into `vertices` for
  /// each triangle; `vertices` holds indices into `positions`, which are in the mesh's frame.
  void add(const ClusterVertices& vertices, std::span<const std::uint8_t> corners,
           std::span<const glm::vec3> positions);

  /// The added triangles that may be visible, in the order in which they were added. Valid until the next begin().
  std::span<const StripTriangle> visible();

 private:
  // The triangle covers the read columns [first, end). At u its w is at most most + slope * u.
  struct Candidate {
    StripTriangle triangle;
    std::uint32_t first = 0, end = 0;
    float most = 0, slope = 0;
  };
  bool misses(const glm::dvec3 (&triangle)[3]) const;
  void add(const StripTriangle& named, const glm::dvec3 (&triangle)[3]);
  void test_and_insert(Candidate& candidate, const PixelPolygon& drawn, const PixelPolygon& reach);
  std::uint32_t first_read(double u) const;
  void add_occluder(const PixelPolygon& drawn, double least, double slope);

  PixelSides sides_;
  double width_ = 0, height_ = 0, near_m_ = 0;
  double fx_ = 0, fy_ = 0, cx_ = 0, cy_ = 0;
  const StripColumns* columns_ = nullptr;  // those of the current view
  std::vector<float> hidden_below_;        // by read column: a surface with a smaller w is invisible there
  std::uint32_t owner_ = 0;
  glm::dvec4 row_x_{0}, row_y_{0}, row_z_{0};  // dot products with (p, 1) give u z, v z and z of a point p
  double slack_m_ = 0, slack_x_ = 0, slack_y_ = 0, min_z_m_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<StripTriangle> seen_;
};

}  // namespace simvis
