// Readers of picture files for shapes. The importers have the decoders and register them here, because this module
// includes nothing of theirs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <simvis/mesh.h>
#include <simvis/sky_picture.h>
#include "engine/draw/sky_sphere.h"

namespace simvis {

/// A picture of heights.
///
/// Shape   values[row * width + column], rows from the top; width and height are at least 2.
/// Units   value * unit is that of the file, in double: PNG: from 0, black, to 1, white. EXR: as in the file, finite.
struct HeightPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<float> values;  ///< exact: codes of a PNG are whole numbers
  double unit = 1;            ///< above 0
};

inline constexpr std::uint32_t kMaxHeightsSide = 4097;  ///< pixels: 4096 cells

/// What is wrong with the size of a picture of heights; empty: nothing.
inline std::string refusal_of_heights(std::int64_t width, std::int64_t height) {
  const bool fits = std::min(width, height) >= 2 && std::max(width, height) <= std::int64_t{kMaxHeightsSide};
  if (fits) return "";
  return "has " + std::to_string(width) + " x " + std::to_string(height) + " pixels, expected from 2 to " +
         std::to_string(kMaxHeightsSide) + " on a side";
}

/// What is wrong with the size of a picture of the sky; empty: nothing.
inline std::string refusal_of_sky(std::int64_t width, std::int64_t height) {
  if (height >= 1 && width == 2 * height && width <= std::int64_t{kMaxSkyWidth_px}) return "";
  return "has " + std::to_string(width) + " x " + std::to_string(height) +
         " pixels, expected twice as many columns as rows, at most " + std::to_string(kMaxSkyWidth_px) + " columns";
}

/// All throw InputError "FILE: error: ...".
struct PictureReader {
  Texture (*texture)(const std::filesystem::path& file) = nullptr;
  HeightPicture (*heights)(const std::filesystem::path& file) = nullptr;
  SkyPicture (*sky)(const std::filesystem::path& file) = nullptr;
};

/// A static object of this type registers the reader.
struct PictureReaderRegistration {
  explicit PictureReaderRegistration(const PictureReader& reader);
};

/// The registered reader.
const PictureReader& picture_reader();

}  // namespace simvis
