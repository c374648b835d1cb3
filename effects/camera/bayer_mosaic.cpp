#include "effects/camera/bayer_mosaic.h"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace simvis {

namespace {

constexpr AttributeSpec kBayerMosaicAttributes[] = {
    {.name = "bayer",
     .kind = AttributeKind::choice,
     .default_value = "none",
     .text = "colours of the first two pixels of the first two rows; none: each pixel measures all three",
     .choices = "none rggb bggr grbg gbrg"},
    {.name = "demosaic",
     .kind = AttributeKind::choice,
     .default_value = "bilinear",
     .text = "with bayer: bilinear interpolates the missing colours; none gives the raw mosaic in all channels",
     .choices = "bilinear none"},
};

std::unique_ptr<CameraEffect> create_bayer_mosaic(const CameraEffectContext& context) {
  const std::string& letters = context.attributes.choice("bayer");
  if (letters == "none") return nullptr;
  BayerPattern pattern{};
  std::ranges::transform(letters, pattern.begin(), [](char letter) {
    return static_cast<std::uint8_t>(letter == 'r' ? 0 : letter == 'g' ? 1 : 2);
  });
  return std::make_unique<BayerMosaic>(pattern, context.attributes.choice("demosaic") == "bilinear");
}

const CameraEffectRegistration kBayerMosaicRegistration(
    {.type = {.name = "bayer_mosaic",
              .summary = "Pixels that measure one colour each, and the interpolation of the others.",
              .notes =
                  "It follows noise and converter. The raw mosaic has each pixel's number in all three channels, so "
                  "that the encoding mono16 of ROS messages is the raw picture.",
              .source = "attribute bayer other than none",
              .outputs = kShownInColor,
              .reference = "colours that change linearly come out as they were; Bayer, US patent 3,971,065, 1976",
              .needs = kHasImageSensor,
              .attributes = kBayerMosaicAttributes},
     .order = CameraOrder::mosaic,
     .create = create_bayer_mosaic});

struct Offset {
  int x, y;
};
constexpr Offset kBeside[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
constexpr Offset kDiagonal[] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

}  // namespace

void BayerMosaic::post_process(const FrameTime&, const CameraLayout&, Image& color) const {
  const std::uint32_t width = color.width, height = color.height;
  std::vector<float>& pixels = color.pixels.edit();
  std::vector<float> raw(std::size_t{width} * height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t i = std::size_t{y} * width + x;
      raw[i] = pixels[i * color.channels + channel_of(x, y)];
    }
  }
  // Sets the mean of the neighbours that have the channel. Returns false if there are none.
  const auto mean = [&](std::uint32_t x, std::uint32_t y, std::uint8_t channel, std::span<const Offset> offsets,
                        double& value) {
    double sum = 0;
    int count = 0;
    for (const Offset& each : offsets) {
      const std::uint32_t nx = x + static_cast<std::uint32_t>(each.x), ny = y + static_cast<std::uint32_t>(each.y);
      if (nx >= width || ny >= height || channel_of(nx, ny) != channel) continue;  // below 0 wraps around
      sum += static_cast<double>(raw[std::size_t{ny} * width + nx]);
      ++count;
    }
    if (count > 0) value = sum / count;
    return count > 0;
  };
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t i = std::size_t{y} * width + x;
      for (std::uint8_t channel = 0; channel < 3; ++channel) {
        double value = static_cast<double>(raw[i]);
        if (demosaics_ && channel_of(x, y) != channel && !mean(x, y, channel, kBeside, value)) {
          mean(x, y, channel, kDiagonal, value);
        }
        pixels[i * color.channels + channel] = static_cast<float>(value);
      }
    }
  }
}

}  // namespace simvis
