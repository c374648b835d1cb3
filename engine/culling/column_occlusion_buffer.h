// Which triangles the depth of a strip can show: a look along its columns, before the device draws any of them.
//
// A strip is a few rows high, so what it sees is nearly a function of the column. In a first round every triangle that
// fills a column from top to bottom says how far one can see there at the most; in a second one, those that lie behind
// that in all their columns are left out, and so are those that meet no column that is read. Depth is the nearest of
// what is drawn, whatever the order, so neither changes a bit of it.
//
// What is left out is certain: see pixel_polygon.h. A triangle is taken to reach a whole pixel farther than it does
// where it may be hidden, and less far where it hides others.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/culling/pixel_polygon.h"
#include "engine/culling/strip_columns.h"

namespace simvis {

/// A triangle of a strip.
struct StripTriangle {
  std::uint32_t owner = 0;        ///< as given to place()
  std::uint32_t corners[3] = {};  ///< numbers of positions given to add()
};

/// Keeps its memory from view to view.
class ColumnOcclusionBuffer {
 public:
  /// `columns`, those of the view, must stay until the next view.
  void begin(const View& view, const StripColumns& columns);

  /// Triangles that are added from here on are those of this owner, in a mesh that is seen here; rounding moves its
  /// vertices by up to `slack_m`, in any direction.
  void place(std::uint32_t owner, const glm::dmat4& view_from_mesh, double slack_m);

  /// Triangles without holes that are drawn from either side, three corners each: which of `vertices`, whose numbers
  /// are those of positions, in the mesh's frame.
  void add(std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> corners,
           std::span<const glm::vec3> positions);

  /// Those of all added that may be seen, in their order.
  std::span<const StripTriangle> visible();

 private:
  // In the columns that are read, [first, end) of them: at u its w is at most most + slope * u.
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
  const StripColumns* columns_ = nullptr;  // of this view
  std::vector<float> hidden_below_;        // by column that is read: what has a smaller w cannot be seen there
  std::uint32_t owner_ = 0;
  glm::dvec4 row_x_{0}, row_y_{0}, row_z_{0};  // u z, v z and z of a point of the mesh
  double slack_m_ = 0, slack_x_ = 0, slack_y_ = 0, min_z_m_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<StripTriangle> seen_;
};

}  // namespace simvis
