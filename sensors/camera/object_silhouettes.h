// The silhouette of an object in a camera's picture, hidden pixels included: the pixels that would show the object if
// it stood alone in the scene.
//
// Rays    Pixels that show the object have it for certain. Of the others, those whose rays meet the box of one of its
//         items take a ray into a world of this item alone, until one of them meets its item. These rays are
//         SurfaceRays: no back faces of single-sided materials, nothing nearer than `near`, and of transparent surfaces
//         those that are depth-visible.
// Shown   A pixel of the picture that shows something behind the item's box, or nothing, takes no ray: the item would
//         be nearer, and so be shown. Of an object that nothing hides hardly any pixel of the picture is cast.
// Canvas  See PixelCanvas. Rows above the picture are taken at the time of its first rows, rows below at that of the
//         last.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>
#include "sensors/camera/pixel_canvas.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/surface_rays.h"

namespace simvis {

/// Pixels and the rectangle that they fill: tight, so that each of its sides touches a pixel.
struct PixelSet {
  CanvasRect rect{};
  std::uint64_t pixels = 0;

  void add(int x, int y);
  /// Adds the pixels of one row from x_begin to before x_end, of which there is at least one.
  void add_run(int x_begin, int x_end, int y);
};

/// Where one object is.
struct Silhouette {
  PixelSet visible;  ///< pixels of the picture that show it
  PixelSet picture;  ///< pixels of the picture that would show it if it stood alone
  PixelSet full;     ///< as `picture`, of the whole canvas
};

class ObjectSilhouettes {
 public:
  /// `canvas` must outlive it.
  explicit ObjectSilhouettes(const PixelCanvas& canvas) : canvas_(canvas) {}

  /// Starts a picture of this list, whose rays are cast on so many threads. The trees of meshes that it does not have
  /// are dropped.
  void begin(const DrawList& list, unsigned threads);

  /// What the pixels of the picture show.
  struct Shown {
    std::span<const std::uint32_t> objects;  ///< [y * width + x]: the number of the object, or another number
    std::span<const float> range_m;          ///< [y * width + x]: along the ray; +infinity: nothing
    std::span<const PixelRows> rows;         ///< from the top
  };
  /// Of the object that has these items and the number `object` in `shown`. `visible` are the pixels that show it. If
  /// `mask` is not empty, mask[y * width + x] of the other pixels of Silhouette::picture is set to 1. An item that no
  /// ray hits, of lines, of points without a shape or of Gaussian splats, has only the pixels that show it.
  Silhouette find(const DrawList& list, std::uint32_t object, std::span<const std::uint32_t> items, const Shown& shown,
                  const PixelSet& visible, std::span<std::uint8_t> mask);

  /// Number of rays since it was made.
  std::uint64_t rays() const { return rays_.rays(); }
  /// Number of meshes whose trees were made ready for rays since it was made.
  std::uint64_t meshes_built() const;

 private:
  struct Pixel {
    int x, y;
  };
  struct Rows {
    int first, end;  // of the canvas
  };
  void find_item(const DrawList& list, std::uint32_t item, std::uint32_t object, const Shown& shown,
                 Silhouette& silhouette, std::span<std::uint8_t> mask);
  void choose(const Mesh& mesh, const glm::dmat4& mesh_from_view, const Rows& rows, std::uint32_t object,
              const Shown& shown);
  std::size_t place(int x, int y) const;
  void cast(const DrawList& list, std::uint32_t item, const glm::dmat4& world_from_mesh,
            const glm::dmat4& world_from_view);
  void add(const Pixel& pixel, Silhouette& silhouette, std::span<std::uint8_t> mask);

  // The world of one item, which others with the same mesh take over. Its caster keeps the tree of the mesh.
  struct Alone {
    DrawList list;
    std::unique_ptr<RayCaster> caster;
  };

  const PixelCanvas& canvas_;
  unsigned threads_ = 1;
  std::vector<std::shared_ptr<const Mesh>> meshes_;  // of the list
  std::unordered_map<const Mesh*, Alone> alone_;     // of meshes that rays were cast at
  std::uint64_t dropped_meshes_built_ = 0;           // by casters that are no more
  // Of an object of several items: by pixel of the canvas, whether one of them has been found there, and these pixels.
  std::vector<bool> is_found_;
  std::vector<std::size_t> found_;
  bool notes_found_ = false;  // other items of the object follow
  std::vector<Pixel> chosen_;
  std::vector<glm::dvec3> directions_;  // of the chosen pixels
  std::vector<double> near_range_m_;
  std::vector<SeenSurface> seen_;
  SurfaceRays rays_;
};

}  // namespace simvis
