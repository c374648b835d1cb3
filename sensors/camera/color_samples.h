// The pictures whose mean is the colour of an image that is exposed over time, through an open lens, or through one
// that magnifies colours unequally.
#pragma once

#include <array>
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
  double time_s = 0;                             ///< relative to the row's time, at most 0
  glm::dvec2 lens_m{0};                          ///< point of the lens from which the picture is taken; V
  double magnification = 1;                      ///< of the picture about the optical axis
  std::array<bool, 3> colors{true, true, true};  ///< those of red, green and blue that are taken from the picture
};

/// The samples of an exposure. Times are the middles of equal parts of it. Points of the lens are
/// those of even_point_of_disc(); points that follow each other have times far apart. Where colours are magnified
/// unequally, each time and point has a picture for each magnification.
std::vector<ColorSample> color_samples(const ColorExposure& exposure);

/// The samples of the same exposure where nothing moves and the lens is a pinhole: one for each magnification.
std::vector<ColorSample> still_samples(const ColorExposure& exposure);

/// The pinhole of a sample's picture, whose eye stands at the sample's point of the lens: the plane at the focus stays
/// where it is in the image.
Pinhole pinhole_of(const ColorSample& sample, const Pinhole& pinhole, double focus_m);

/// The mean of pictures of one size, number by number; there is at least one of each colour.
class ColorMean {
 public:
  void begin() { counts_ = {}; }
  /// Numbers beyond the three colours are taken from every picture.
  void add(const Image& picture, const std::array<bool, 3>& colors);
  /// Sets the numbers of `image`, which has the size of the pictures.
  void finish(Image& image) const;

 private:
  std::vector<double> sum_;
  std::array<std::uint32_t, 4> counts_{};  // of pictures, for each channel
};

}  // namespace simvis
