#include "sensors/camera/pixel_estimate.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

std::uint32_t tiles_along(std::uint32_t size_px) {
  return (size_px + PixelEstimate::kTileSize_px - 1) / PixelEstimate::kTileSize_px;
}

}  // namespace

PixelEstimate::PixelEstimate(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t samples,
                             std::optional<double> noise)
    : width_px_(width_px),
      height_px_(height_px),
      tiles_across_(tiles_along(width_px)),
      tiles_(tiles_across_ * tiles_along(height_px)),
      samples_(noise ? kPilotSamples : samples),
      noise_(noise),
      parts_(noise ? kParts : 1) {}

void PixelEstimate::begin() {
  for (Part& part : parts_) {
    part.mean.assign(pixels(), glm::dvec3(0));
    part.deviations = part.mean;
    part.samples.assign(tiles_, samples_);
  }
  end_ = samples_ * static_cast<std::uint32_t>(parts_.size());
}

std::size_t PixelEstimate::tile_of(std::uint32_t pixel) const {
  return std::size_t{pixel / width_px_ / kTileSize_px} * tiles_across_ + pixel % width_px_ / kTileSize_px;
}

// The mean over the pixels of each tile, and over R, G and B, of a number of each pixel.
template <typename Number>
std::vector<double> PixelEstimate::means_of_tiles(const Number& of_pixel) const {
  std::vector<double> sums(tiles_, 0), counts(tiles_, 0);
  for (std::uint32_t pixel = 0; pixel < pixels(); ++pixel) {
    const glm::dvec3 number = of_pixel(pixel);
    sums[tile_of(pixel)] += (number.r + number.g + number.b) / 3;
    ++counts[tile_of(pixel)];
  }
  for (std::size_t tile = 0; tile < tiles_; ++tile) sums[tile] /= counts[tile];
  return sums;
}

bool PixelEstimate::wants(std::uint32_t sample) {
  if (noise_ && sample == kParts * kPilotSamples) decide();
  return sample < end_;
}

// With n samples of the variance v in each part, the mean of all has the variance v / (kParts n).
void PixelEstimate::decide() {
  constexpr std::uint32_t kMaxOfPart = kMaxSamples / kParts;
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::vector<glm::dvec3>& deviations = parts_[(part + 1) % kParts].deviations;
    const std::vector<double> variances =
        means_of_tiles([&](std::uint32_t pixel) { return deviations[pixel] / (kPilotSamples - 1.0); });
    for (std::size_t tile = 0; tile < tiles_; ++tile) {
      // One division after the other: the square of a tiny noise is 0.
      const double wanted = std::ceil(variances[tile] / kParts / *noise_ / *noise_);
      std::uint32_t& samples = parts_[part].samples[tile];
      samples = static_cast<std::uint32_t>(std::clamp(wanted, double{kPilotSamples}, double{kMaxOfPart}));
      end_ = std::max(end_, kParts * samples);
    }
  }
}

bool PixelEstimate::takes(std::uint32_t sample, std::uint32_t pixel) const {
  const Part& part = parts_[sample % parts_.size()];
  return sample / parts_.size() < part.samples[tile_of(pixel)];
}

bool PixelEstimate::takes_some(std::uint32_t sample, std::uint32_t first_row, std::uint32_t rows) const {
  bool some = false;
  for_tiles(sample, first_row, rows, [&](std::uint32_t, std::uint32_t, std::uint32_t) { some = true; });
  return some;
}

// Welford, "Note on a Method for Calculating Corrected Sums of Squares and Products" (1962).
void PixelEstimate::add(std::uint32_t sample, std::uint32_t pixel, const glm::dvec3& value) {
  Part& part = parts_[sample % parts_.size()];
  glm::dvec3& mean = part.mean[pixel];
  const glm::dvec3 before = value - mean;
  const std::size_t taken = sample / parts_.size() + 1;
  mean += before / static_cast<double>(taken);
  part.deviations[pixel] += before * (value - mean);
}

// All parts have the same weight: one that followed from their numbers of samples would bias.
glm::dvec3 PixelEstimate::mean(std::uint32_t pixel) const {
  glm::dvec3 sum(0);
  for (const Part& part : parts_) sum += part.mean[pixel];
  return sum / static_cast<double>(parts_.size());
}

glm::dvec3 PixelEstimate::variance(std::uint32_t pixel) const {
  glm::dvec3 sum(0);
  for (const Part& part : parts_) {
    const double samples = part.samples[tile_of(pixel)];
    sum += glm::max(part.deviations[pixel], glm::dvec3(0)) / (samples * (samples - 1));
  }
  return sum / static_cast<double>(parts_.size() * parts_.size());
}

ReachedNoise PixelEstimate::reached() const {
  const std::vector<double> squares = means_of_tiles([this](std::uint32_t pixel) { return variance(pixel); });
  ReachedNoise reached{.max_error = std::sqrt(std::ranges::max(squares)), .tiles = tiles_};
  double square = 0;
  for (std::size_t tile = 0; tile < tiles_; ++tile) {
    square += squares[tile] / tiles_;
    if (squares[tile] > *noise_ * *noise_) ++reached.tiles_above;
  }
  reached.error = std::sqrt(square);
  for (std::uint32_t pixel = 0; pixel < pixels(); ++pixel) {
    std::uint32_t samples = 0;
    for (const Part& part : parts_) samples += part.samples[tile_of(pixel)];
    reached.samples += static_cast<double>(samples) / pixels();
    reached.max_samples = std::max(reached.max_samples, samples);
  }
  return reached;
}

}  // namespace simvis
