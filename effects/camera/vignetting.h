// The effect `vignetting`: images grow darker towards their corners.
//
//   natural      cos^4 of the angle between the optical axis and the ray, as for a thin lens without a barrel. S. B.
//                Kang and R. Weiss, "Can we calibrate a camera using an image of a flat, textureless Lambertian
//                surface?", ECCV 2000, section 2. The factor is 0 from 90 degrees on
//   polynomial   1 + v1 r^2 + v2 r^4 + v3 r^6, where r is the distance from the principal point divided by half the
//                diagonal of the image: D. B. Goldman, "Vignette and exposure calibration and compensation", PAMI 32,
//                2010
#pragma once

#include <array>
#include <cstdint>

#include <simvis/camera_effect.h>

namespace simvis {

enum class VignettingLaw : std::uint8_t { natural, polynomial };

class Vignetting : public CameraEffect {
 public:
  /// `where` is the location of the law attribute, for messages; `v` holds the coefficients of the polynomial.
  Vignetting(VignettingLaw law, const std::array<double, 3>& v, Location where)
      : law_(law), v_(v), where_(std::move(where)) {}

  /// Throws InputError with the location if the polynomial is negative within the image.
  void configure_rays(CameraLayout& layout) const override;
  void post_process(const FrameTime&, const CameraLayout& layout, Image& color) const override;

  /// The factor by which the light of a pixel is multiplied.
  double factor(const CameraLayout& layout, std::uint32_t x, std::uint32_t y) const;

 private:
  VignettingLaw law_;
  std::array<double, 3> v_;
  Location where_;
};

}  // namespace simvis
