// Selects the points of a cloud that can change a pixel of a view.
//
// A CPU device takes points one after the other, and takes longer for a point than the host takes to find its pixels.
// In a picture of a dense cloud most points lie outside of the view or behind the squares of nearer points. The test
// takes the rounding of the device and its own into account, and whatever is uncertain is selected, in the order of the
// mesh. So no byte of a picture changes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

/// The sizes of the squares that a device draws for points, in pixels.
struct PointSizes {
  double max_px = 1;   ///< larger ones are drawn with this size
  double step_px = 0;  ///< a size is off by up to this
};

/// All points of a mesh with fewer points are drawn, because selecting costs at least the clearing of a view.
inline constexpr std::size_t kWorthSelectingPoints = 16384;

/// For opaque points in perspective views that are no strips.
class PointSelector {
 public:
  /// `supersampling` is that of the pass, `snap_px` that of PassResult. Both lengths count samples from here on.
  void begin(const View& view, std::uint32_t supersampling, double snap_px, const PointSizes& sizes);

  /// Appends those of `points`, indices of `positions`, that can change a sample. `size_m` is the side of the square of
  /// a point, in the frame of the mesh: see Drawable::point_m. Rounding moves points by up to `slack_m`.
  void select(const glm::dmat4& view_from_mesh, double slack_m, double size_m, std::span<const glm::vec3> positions,
              std::span<const std::uint32_t> points, std::vector<std::uint32_t>& selected);

 private:
  double width_ = 0, height_ = 0, near_m_ = 0;
  double fx_ = 0, fy_ = 0, cx_ = 0, cy_ = 0;
  double snap_ = 0;
  PointSizes sizes_;
  std::size_t stride_ = 0;
  std::vector<float> nearest_m_;  ///< by sample: a drawn point is at most so far away; infinity: none is drawn there
};

}  // namespace simvis
