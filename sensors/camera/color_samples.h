// The pictures whose mean is the colour of an image that is exposed over time or through an open lens.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/camera_layout.h>
#include <simvis/image.h>

namespace simvis {

/// One of the pictures.
///
/// Frames   V = view frame of the camera at the row's time: x right, y down, z forward.
struct ColorSample {
  double time_s = 0;     ///< relative to the row's time, at most 0
  glm::dvec2 lens_m{0};  ///< point of the lens from which the picture is taken; V
};

/// The samples of an exposure. Times are the middles of equal parts of it. Points of the lens lie on Vogel's spiral,
/// each in the middle of an equal area ("A better way to construct the sunflower head", Mathematical Biosciences 44,
/// 1979); points that follow each other on it have times far apart.
std::vector<ColorSample> color_samples(const ColorExposure& exposure);

/// The pinhole of the picture from a point of the lens whose eye stands at that point: the plane at the focus stays
/// where it is in the image.
Pinhole sheared(const Pinhole& pinhole, const glm::dvec2& lens_m, double focus_m);

/// The mean of pictures of one size, number by number; there is at least one.
class ColorMean {
 public:
  void begin() { count_ = 0; }
  void add(const Image& picture);
  /// Sets the numbers of `image`, which has the size of the pictures.
  void finish(Image& image) const;

 private:
  std::vector<double> sum_;
  std::uint32_t count_ = 0;
};

}  // namespace simvis
