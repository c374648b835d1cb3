// Where the points that an image shows are in another image of the same camera.
//
// A point keeps its place on its object: in the frame of the item's mesh and, if the mesh has another shape in the
// other image, as that of an animation does, by its weights in its triangle. What is in the other image's scene no
// more, or not yet, stands still. The sky is infinitely far away. The other image's own rows decide when a point is
// seen there: it is at the height of rows that are taken when it is there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include <simvis/camera_layout.h>
#include <simvis/frame_results.h>
#include "sensors/camera/camera_moment.h"

namespace simvis {

/// A point of an image.
struct ImagePoint {
  std::size_t rows = 0;          ///< in CameraMoment::rows
  std::uint32_t item = kNoItem;  ///< kNoItem: the sky
  std::uint32_t primitive = 0;   ///< of the item's mesh; read only if deforms(item)
  glm::dvec4 point{0};           ///< view frame of these rows; of the sky a direction, with 0 at the end
};

/// The same point of the object in the other image.
struct FollowedPoint {
  std::optional<glm::dvec2> pixel;  ///< may lie beyond the edges; empty: nowhere, as behind a pinhole camera
  bool in_rows = false;             ///< whether it is where `rows` are; false: no row meets it, or beyond the edges
  bool exists = true;               ///< whether the other scene has its item
  std::uint32_t item = kNoItem;     ///< in the other list
  std::size_t rows = 0;             ///< of the other image, those that see it or are nearest to it
  glm::dvec4 point{0};              ///< view frame of these rows; of the sky a direction, with 0 at the end
};

class PointFlow {
 public:
  /// All three must live as long as this object.
  PointFlow(const CameraLayout& layout, const CameraMoment& from, const CameraMoment& to);

  /// Whether the mesh of an item has another shape in the other image, with the same triangles.
  bool deforms(std::uint32_t item) const { return deforms_[item] != 0; }
  /// Whether any item does that can be seen.
  bool any_deforms() const { return any_deforms_; }

  FollowedPoint follow(const ImagePoint& point);
  /// FollowedPoint::pixel alone.
  std::optional<glm::dvec2> place(const ImagePoint& point);

  /// How far the point moves in the world from the image to the same rows of the other: world frame, metres.
  glm::dvec3 way_m(const ImagePoint& point);

 private:
  struct Way {
    std::uint32_t item = kNoItem;
    std::size_t from_rows = ~std::size_t{0}, to_rows = ~std::size_t{0};
    glm::dmat4 matrix{1.0};
  };
  void match();
  glm::dvec4 in_rows(const ImagePoint& point, std::size_t to_rows);
  const glm::dmat4& way(const ImagePoint& point, std::size_t to_rows);
  glm::dmat4 other_place(std::uint32_t item, std::size_t from_rows, std::size_t to_rows) const;
  glm::dvec4 deformed(std::uint32_t item, std::uint32_t primitive, const glm::dvec4& point) const;

  const CameraLayout& layout_;
  const CameraMoment &from_, &to_;
  std::vector<std::uint32_t> other_;   // by item of `from`: in the other list; kNoItem: not there
  std::vector<std::uint8_t> deforms_;  // by item of `from`
  bool any_deforms_ = false;
  Way way_;  // the last one
};

}  // namespace simvis
