// The mean and its error of random samples of the pixels of an image, with as many samples as the error needs.
//
// Fixed    Without `noise`, each pixel takes `samples`.
// Noise    Else the samples are kParts parts, of which each takes every third one. The first kPilotSamples of a part
//          decide how many the part before it takes in each tile of kTileSize_px: as many as bring the standard error
//          of the tile, the root mean square over its pixels and R, G and B, to `noise`. So the number of samples of a
//          part is independent of them, and the mean of all parts is unbiased. The errors of two parts are
//          uncorrelated, because at most one of them decides about the other. Therefore the square of the error is
//          unbiased, too. A number that followed from the same samples would leave out bright ones where the first were
//          dark. The error that is reached scatters around the wanted one as the pilot samples do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace simvis {

/// What an image has reached. Errors are standard errors of tiles.
struct ReachedNoise {
  double samples = 0;             ///< of a pixel, in the mean
  std::uint32_t max_samples = 0;  ///< of a pixel
  double error = 0;               ///< root mean square of all tiles
  double max_error = 0;           ///< of a tile
  std::size_t tiles = 0;
  std::size_t tiles_above = 0;  ///< with a larger error than `noise`
};

class PixelEstimate {
 public:
  static constexpr std::uint32_t kMaxSamples = 65536, kParts = 3, kPilotSamples = 6, kTileSize_px = 16;

  /// `noise`, if given, takes the place of `samples`.
  PixelEstimate(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t samples, std::optional<double> noise);

  /// Starts an image.
  void begin();
  /// Whether some pixel takes this sample, and whether that pixel does. All samples before it have been taken.
  bool wants(std::uint32_t sample);
  bool takes(std::uint32_t sample, std::uint32_t pixel) const;
  /// Calls action(pixel) for each pixel of these rows that takes a sample. Eight columns of a tile come after each
  /// other, row by row: whole packets of rays.
  template <typename Action>
  void for_pixels(std::uint32_t sample, std::uint32_t first_row, std::uint32_t rows, const Action& action) const;
  /// Whether there is such a pixel.
  bool takes_some(std::uint32_t sample, std::uint32_t first_row, std::uint32_t rows) const;
  /// Adds a sample of a pixel that takes it: each of them must be added, in their order.
  void add(std::uint32_t sample, std::uint32_t pixel, const glm::dvec3& value);

  glm::dvec3 mean(std::uint32_t pixel) const;
  /// Of the mean, as the spread of the samples shows it; there are at least two.
  glm::dvec3 variance(std::uint32_t pixel) const;
  ReachedNoise reached() const;  ///< with `noise`

 private:
  /// Samples with a mean of their own.
  struct Part {
    std::vector<glm::dvec3> mean{}, deviations{};  // by pixel; the latter sums of squares
    std::vector<std::uint32_t> samples{};          // by tile
  };
  std::uint32_t pixels() const { return width_px_ * height_px_; }
  std::size_t tile_of(std::uint32_t pixel) const;
  // Calls action(top, bottom, left) for each part of a tile that is in these rows and takes the sample.
  template <typename Action>
  void for_tiles(std::uint32_t sample, std::uint32_t first_row, std::uint32_t rows, const Action& action) const;
  template <typename Number>
  std::vector<double> means_of_tiles(const Number& of_pixel) const;
  void decide();

  std::uint32_t width_px_, height_px_;
  std::uint32_t tiles_across_, tiles_;
  std::uint32_t samples_;  // of each part before any decision
  std::optional<double> noise_;
  std::vector<Part> parts_;  // one without `noise`
  std::uint32_t end_ = 0;    // samples that some pixel takes
};

template <typename Action>
void PixelEstimate::for_tiles(std::uint32_t sample, std::uint32_t first_row, std::uint32_t rows,
                              const Action& action) const {
  const std::uint32_t end = first_row + rows;
  for (std::uint32_t top = first_row, bottom = 0; top < end; top = bottom) {
    bottom = std::min(end, (top / kTileSize_px + 1) * kTileSize_px);
    for (std::uint32_t left = 0; left < width_px_; left += kTileSize_px) {
      if (takes(sample, top * width_px_ + left)) action(top, bottom, left);
    }
  }
}

template <typename Action>
void PixelEstimate::for_pixels(std::uint32_t sample, std::uint32_t first_row, std::uint32_t rows,
                               const Action& action) const {
  constexpr std::uint32_t kColumns = 8;
  static_assert(kTileSize_px % kColumns == 0);
  const auto add_columns = [&](std::uint32_t top, std::uint32_t bottom, std::uint32_t left) {
    const std::uint32_t right = std::min(left + kColumns, width_px_);
    for (std::uint32_t row = top; row < bottom; ++row) {
      for (std::uint32_t column = left; column < right; ++column) action(row * width_px_ + column);
    }
  };
  for_tiles(sample, first_row, rows, [&](std::uint32_t top, std::uint32_t bottom, std::uint32_t left) {
    for (std::uint32_t from = left; from < left + kTileSize_px; from += kColumns) add_columns(top, bottom, from);
  });
}

}  // namespace simvis
