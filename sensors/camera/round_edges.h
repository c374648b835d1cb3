// Pixels of a drawn image in which the outline of a round shape may lie between the drawn mesh and the shape itself.
//
// The mesh of a round shape lies inside of it, by up to a known deviation. So the pixels between both outlines lie
// within that distance, as it appears in the image, of a pixel that shows the mesh and has a neighbour that does not. A
// shape, or the tip of a cone, that appears narrower than a few pixels may lack such pixels: there all pixels around it
// are found. Where a shape reaches beyond the border of the view, such pixels may lie beyond it, too: there all pixels
// of the shape's box are found that are within that distance of the border. Where a shape of the radius r stands out of
// another surface by little, not all pixels are found, because there an outline moves by up to sqrt(2 r d) for the
// deviation d. Pixels that are not found keep what is drawn.
//
// Solid clouds are drawn as squares, and their spheres are cast: all pixels in the box of a cloud are open.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/exact_surface.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>

namespace simvis {

class RoundEdges {
 public:
  /// Starts an image of this list. Returns whether it has round shapes. `clouds`: solid clouds count, too.
  bool begin(const DrawList& list, bool clouds);
  /// Adds the pixels of a drawn view, which are those of an image of this width from `first_row` on. The pass has
  /// items. `whole`: all pixels that show a round shape count, too.
  void add(const Pass& pass, const View& view, const PassResult& result, std::uint32_t width_px,
           std::uint32_t first_row, bool whole);
  /// Whether rays meet an item of the list.
  bool meets_rays(std::uint32_t item) const { return deviation_m_[item] != kNoSurface; }
  /// In the image, ascending if the views were added from the top.
  std::span<const std::uint32_t> pixels() const { return pixels_; }

 private:
  static constexpr float kNoSurface = -1;  // no ray meets lines and points, so their pixels stay as they are drawn

  /// A box in the frame of an item's mesh.
  struct Box {
    std::uint32_t item = 0;
    glm::dmat4 world_from_mesh{1.0};
    glm::dvec3 low{0}, high{0};
  };
  /// A round shape, in the frame of its mesh.
  struct Round {
    Box box;
    ExactSurface shape;
  };
  /// Where a view shows a box.
  struct BoxPixels {
    glm::dvec2 low_px{0}, high_px{0};  ///< whole numbers, beyond the view too; infinite: it may be anywhere
    double nearest_m = 0;              ///< the least depth, at least `near`
  };
  static glm::dmat4 view_from_mesh(const View& view, const Box& box);
  static BoxPixels pixels_of(const View& view, const Box& box);
  void open_box(const View& view, const Box& box);
  void open_narrow(const View& view, const Round& round);
  void open_border(const View& view, const Round& round);
  double border_reach_px(const View& view, const Round& round, double nearest_m) const;
  /// Columns or rows from `first` to before `end`.
  struct Span {
    std::uint32_t first = 0, end = 0;
  };
  void open(const Span& columns, const Span& rows, std::uint32_t width_px);
  void open(const View& view, const glm::dvec2& low_px, const glm::dvec2& high_px);
  static std::uint32_t reach_px(const View& view, double depth_m, std::uint32_t column, std::uint32_t row,
                                double deviation_m);

  std::vector<float> deviation_m_;  // by item; 0: it is not round, or kNoSurface
  std::vector<Box> clouds_;
  std::vector<Round> rounds_;
  bool any_ = false;
  // By pixel of a view, with one column more: the opened rectangles that begin there in its row, less those that end.
  std::vector<std::int32_t> begins_;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace simvis
