// Masks of pixels: as pictures, and as the run lengths of COCO.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/measurement.h>

namespace simvis {

/// Pixels of a picture, rows from the top: 1 or 0.
struct PixelMask {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<std::uint8_t> pixels;
};

/// The pixels of an image of ids that have this one.
PixelMask mask_of(const MeasuredArray& ids, std::uint32_t id);
/// One channel of an image of 0 and 1.
PixelMask mask_channel(const MeasuredArray& image, std::uint32_t channel);

/// A PNG of one channel: 255 where the mask is 1.
std::string mask_png(const PixelMask& mask);

/// The run lengths of a mask as a text. They are counted column by column, and the first one is of zeros. Each number
/// has 5 bits in a character, the lowest first, bit 5 for more characters, from '0' on; from the third number on it is
/// the difference from the one two before, with its sign. Source: rleToString() of cocoapi, common/maskApi.c.
std::string coco_rle(const PixelMask& mask);

}  // namespace simvis
