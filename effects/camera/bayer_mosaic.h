// The effect `bayer_mosaic`: each pixel measures one of the three colours.
//
//   <sensor type="camera" ... bayer="rggb" demosaic="bilinear"/>
//
// Pattern  the colours of the pixels of the first two rows, from the left: rggb has red at (0, 0), green at (1, 0) and
//          (0, 1), blue at (1, 1), and so on all over the image. Noise and converter act before; what a pixel would
//          have measured of the other colours is lost.
// Picture  demosaic="bilinear": each missing colour is the mean of those neighbours, of the eight around the pixel,
// that
//          are nearest and have it. At the borders only those inside the image count. A colour that changes linearly
//          over the image comes out as it was, borders excepted; edges get coloured seams.
//          demosaic="none": the raw mosaic; all three channels of a pixel are the number that it has measured.
// Source   B. E. Bayer, "Color imaging array", US patent 3,971,065, 1976.
#pragma once

#include <array>
#include <cstdint>

#include <simvis/camera_effect.h>

namespace simvis {

/// Channels, 0 to 2, of the pixels (0, 0), (1, 0), (0, 1) and (1, 1).
using BayerPattern = std::array<std::uint8_t, 4>;

class BayerMosaic : public CameraEffect {
 public:
  BayerMosaic(const BayerPattern& pattern, bool demosaics) : pattern_(pattern), demosaics_(demosaics) {}

  void post_process(const FrameTime&, const CameraLayout&, Image& color) const override;

 private:
  std::uint8_t channel_of(std::uint32_t x, std::uint32_t y) const { return pattern_[2 * (y % 2) + x % 2]; }

  BayerPattern pattern_;
  bool demosaics_;
};

}  // namespace simvis
