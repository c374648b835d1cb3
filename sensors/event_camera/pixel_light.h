// The light of each pixel of a camera at any time between two measurements: the mean over the pixel's square.
//
// Exactness  The area that each surface covers in the square is exact (visible_faces.h). The light of a surface in the
//            square is that of the centroid of its visible part, which is exact where it is affine there.
// Demand     A pixel is `in motion` if a triangle that moves in the view comes into its square, hidden or not. Of those
//            triangles is also known by how many pixels the surface that the pixel's centre sees moves in the time.
// Touches    Between two times the light may only change and come back if an edge of something that moves comes into
//            the square and leaves it: the border of a surface, an edge between its front and its back, or one at which
//            its normals, colours or texture jump. edge_touch.h finds these times. Not looked for are touches by the
//            line in which two surfaces penetrate each other, and by the cut at the plane z = near.
// Lens       The square of a pixel is a parallelogram before the lens, see PixelSquare: a pinhole of its own sees it as
//            a square. A triangle that moves is looked for in all tiles of the image whose cones touch its own.
// Surfaces   Triangles of visible items whose material is opaque enough for depth cameras as a whole (see Material):
//            textures that cut holes, lines and points are not seen, and round shapes are the meshes that stand for
//            them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <simvis/frame_plan.h>
#include "sensors/camera/pixel_optics.h"
#include "sensors/event_camera/edge_touch.h"
#include "sensors/event_camera/scene_over_time.h"
#include "sensors/event_camera/visible_faces.h"

namespace simvis {

/// What a thread needs to compute the light of pixels.
class PixelWork {
 public:
  void begin();                                       ///< forgets the scene and the samples
  std::uint64_t samples() const { return samples_; }  ///< calls of PixelLight::light() since it began

 private:
  friend class PixelLight;
  VisibleFaces faces_;
  /// Where items stand at one time.
  struct Places {
    double share = -1;
    std::vector<std::pair<std::uint32_t, glm::dmat4>> of_items;
  };
  std::array<Places, 3> places_;  // of the last times; an interval needs those of its begin, its end and one between
  std::size_t oldest_ = 0;
  std::vector<std::pair<std::uint32_t, std::array<glm::dvec3, 3>>> outlined_;  // triangles and their corners
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;                 // triangles and corners
  std::uint64_t samples_ = 0;
};

class PixelLight {
 public:
  /// `optics` must outlive it.
  PixelLight(const PixelOptics& optics, double near_m);

  /// Takes another scene. Sorts triangles into the pixels that they come into, or only those that come into pixels in
  /// motion unless `all_pixels`. The scene must live until the last call of light().
  void set(const SceneOverTime& scene, bool all_pixels);

  bool in_motion(std::uint32_t pixel) const { return in_motion_[pixel] != 0; }
  /// The longest way of a surface across this pixel.
  double way_px(std::uint32_t pixel) const;

  /// Luminance of a pixel at a time. The pixel is in motion, or all were asked for. Several threads may call it at a
  /// time, each with its own `work`, which has begun since set().
  double light(std::uint32_t pixel, double share, PixelWork& work) const;
  /// Finds the edges of objects that move which may come into the pixel's square between two times; returns whether
  /// there are any. As light() otherwise.
  bool find_edges(std::uint32_t pixel, double begin, double end, PixelWork& work) const;
  /// Appends the times at which one of the edges that find_edges() found last is deepest in the square, if it touches
  /// the square between two of the times `looked_at`, ascending, and at neither of the two.
  void add_touches(std::uint32_t pixel, std::span<const double> looked_at, PixelWork& work,
                   std::vector<double>& shares) const;

 private:
  using Neighbours = std::vector<std::array<std::uint32_t, 3>>;
  struct Triangle {
    std::uint32_t item = 0, primitive = 0;
    bool both_sides = false, moves = false, mirrored = false;
    std::uint32_t way = 0;  // in ways_, if it moves
    // Bit k: the light may jump at the edge from corner k to corner k + 1, always or while its triangle or the one
    // beyond it shows its other side.
    std::uint8_t outlines = 0, folds = 0;
    double acceleration_m = 0;              // of its corners at most, if it has outlines
    std::array<glm::dvec3, 3> corners_m{};  // V, if it stands still
  };
  /// The places of an item at equal times, V from its mesh.
  static constexpr std::size_t kSurfaceSteps = 4;
  struct Way {
    std::array<glm::dmat4, kSurfaceSteps + 1> view_from_mesh;
    glm::dmat4 mesh_from_half_way{1.0};
    std::shared_ptr<const Neighbours> neighbours;
  };
  /// Pixels that a triangle may come into.
  struct Rect {
    std::uint32_t x_begin = 0, y_begin = 0, x_end = 0, y_end = 0;
  };
  using Corners = std::array<glm::dvec3, 3>;
  /// Which sides of a triangle are seen over the time.
  struct Facing {
    bool front = false, back = false;

    bool operator==(const Facing&) const = default;
  };
  void add_item(std::uint32_t item);
  void find_outlines(std::uint32_t item, std::size_t first_triangle, const std::vector<Facing>& facing);
  std::shared_ptr<const Neighbours> neighbours_of(const std::shared_ptr<const Mesh>& mesh);
  /// A rectangle of pixels, and a cone around their squares.
  struct Tile {
    Rect pixels;
    glm::dvec3 axis{0};  // V
    double angle_rad = 0;
  };
  void add_tile(const Rect& pixels);
  std::optional<Rect> swept(const std::vector<Corners>& ways) const;
  std::optional<Rect> swept_through_lens(const std::vector<Corners>& ways) const;
  bool is_blind(std::size_t pixel) const { return !squares_.empty() && squares_[pixel].focal_px == 0; }
  Corners in_square(std::uint32_t pixel, Corners corners) const;
  Corners corners(const Triangle& triangle, double share, PixelWork& work) const;
  Corners placed(std::uint32_t item, std::uint32_t primitive, double share, PixelWork& work) const;
  EdgeTouch square_of(std::uint32_t pixel) const;
  bool is_fold(const Triangle& triangle, std::uint32_t corner, double begin, double end, PixelWork& work) const;
  static EdgeTouch::Ends edge_of(const Corners& corners, std::uint32_t corner);
  const glm::dmat4& view_from_mesh(std::uint32_t item, double share, PixelWork& work) const;
  void sort_in(bool all_pixels);
  double way_px(const Triangle& triangle, std::uint32_t pixel) const;

  Pinhole pinhole_;
  std::uint32_t width_px_, height_px_;
  double near_m_;
  std::vector<PixelSquare> squares_;  // by pixel; empty: those of the pinhole
  std::vector<Tile> tiles_;           // of all pixels that see something; empty: the same
  const SceneOverTime* scene_ = nullptr;
  double background_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<Rect> rects_;              // of triangles_
  std::vector<Way> ways_;                // of items that move
  std::vector<std::size_t> first_;       // of pixel p: near_[first_[p]] to before near_[first_[p + 1]]
  std::vector<std::uint32_t> near_;      // triangles, by pixel
  std::vector<std::uint8_t> in_motion_;  // by pixel
  struct KeptNeighbours {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const Neighbours> neighbours;
    bool is_used = false;  // in this scene
  };
  std::vector<KeptNeighbours> neighbours_;
};

}  // namespace simvis
