// Whether two colour pictures agree, for tests of robot software: part of <simvis/testing.h>.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include <simvis/export.h>
#include <simvis/image.h>
#include <simvis/verdict.h>

namespace simvis::test_kit {

/// A colour picture as sRGB codes: red, green and blue of each pixel, row by row from the top.
struct ColorCodes {
  std::uint32_t width = 0,              ///< in pixels
      height = 0;                       ///< in pixels
  std::span<const std::uint8_t> codes;  ///< 3 * width * height codes, which must live as long
};

/// Whether at most the share `share` of the pixels of two colour images (4 channels, linear) differs by more than
/// `codes` sRGB codes of 0 to 255 in red, green or blue.
///
/// `difference`: where the images differ and this is not empty, a PNG of this name shows by how much, white for 16
/// codes and more. Errors: MachineError if it cannot be written, InputError if it is there and no regular file.
SIMVIS_API Verdict pictures_near(const Image& one, const Image& other, int codes = 1, double share = 0,
                                 const std::filesystem::path& difference = {});
/// The same of pictures that are codes already.
SIMVIS_API Verdict pictures_near(const ColorCodes& one, const ColorCodes& other, int codes = 1, double share = 0,
                                 const std::filesystem::path& difference = {});

}  // namespace simvis::test_kit
