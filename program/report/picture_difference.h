// How far one picture of a view is from another: colour, depth and silhouettes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace simvis {

/// The colour and the depth of one view, as PassResult has them.
struct ComparedView {
  std::uint32_t width_px = 0, height_px = 0;
  std::span<const glm::vec4> color;
  std::span<const float> depth;  ///< d = near / z, 0 where nothing is hit
};

/// Neighbouring pixels whose depths differ by more than this share of the farther one have a silhouette between them.
inline constexpr double kSilhouetteStep = 0.05;

/// Pixels whose depth differs by more than this share show another surface.
inline constexpr double kOtherSurface = 0.01;

/// A silhouette that has none in the other picture within this distance counts as this far.
inline constexpr int kFarSilhouette_px = 16;

struct PictureDifference {
  double rms_color = 0;  ///< root of the mean square over linear R, G and B
  /// From the pixels beside a silhouette of either picture to the nearest such pixel of the other one; 0 without
  /// silhouettes.
  double silhouette_p99_px = 0, silhouette_largest_px = 0;
  double other_surface_share = 0;  ///< of the pixels
};

/// Both views have the same size, above 0.
PictureDifference difference(const ComparedView& a, const ComparedView& b);

}  // namespace simvis
