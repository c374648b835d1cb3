// The viewing directions of a camera's pixels, and of those that its picture would have if it were larger: a canvas of
// three times the width and height, with the picture in its middle. Silhouettes of objects that the picture cuts are
// taken from it.
//
// Beyond  Pixels outside the picture look where the pinhole, or the lens with its coefficients, makes them look. A lens
//         that folds, or that ends at 110 degrees, has no direction there. A layout whose rays are of another model
//         than those of `lens_distortion` has no pixel outside the picture.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include <simvis/camera_layout.h>
#include "effects/camera/lens.h"
#include "sensors/camera/camera_views.h"

namespace simvis {

/// Pixels [x_begin, x_end) x [y_begin, y_end); 0, 0 is the first pixel of the picture.
struct CanvasRect {
  int x_begin = 0, y_begin = 0, x_end = 0, y_end = 0;

  bool empty() const { return x_begin >= x_end || y_begin >= y_end; }
  bool has(int x, int y) const { return x >= x_begin && x < x_end && y >= y_begin && y < y_end; }
  bool operator==(const CanvasRect&) const = default;
};

/// Frames   V = view frame of the camera at the time of the row: x right, y down, z forward.
class PixelCanvas {
 public:
  /// `views` are those of the layout, both of which must outlive the canvas. `near_m` is as in PixelRays.
  PixelCanvas(const CameraLayout& layout, const CameraViews& views, double near_m);

  CanvasRect picture() const { return {0, 0, width_, height_}; }
  CanvasRect canvas() const { return canvas_; }

  /// V, unit length; zero: the pixel sees nothing. The pixel is on the canvas.
  glm::dvec3 direction(int x, int y) const;
  /// What is nearer along this direction of the pixel is not seen.
  double near_range_m(int x, int y, const glm::dvec3& direction) const;

  /// A rectangle of the canvas that has all pixels whose directions meet the convex hull of these points of V. It is
  /// the whole canvas with a lens, and of a pinhole if a point is not in front of it.
  CanvasRect around(std::span<const glm::dvec3> points) const;

  /// A rectangle of pixels, and a cone around their directions.
  struct Tile {
    CanvasRect pixels;
    glm::dvec3 axis{0, 0, 1};  ///< V, unit length
    double angle_rad = 0;      ///< from the axis to the farthest direction
  };
  /// All pixels that see something are in one of them.
  std::span<const Tile> tiles() const { return tiles_; }

 private:
  void add_tile(const CanvasRect& pixels);

  const CameraLayout& layout_;
  const CameraViews& views_;
  double near_m_;
  int width_, height_;
  CanvasRect canvas_;
  bool is_flat_;  // all views look along the optical axis
  std::optional<Lens> lens_;
  std::vector<Tile> tiles_;
};

}  // namespace simvis
