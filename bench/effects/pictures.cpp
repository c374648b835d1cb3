#include "bench/effects/pictures.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "bench/effects/yard.h"
#include "simvis/output/png_file.h"

namespace simvis::bench {

namespace {

constexpr std::uint32_t kWidth_px = 320, kHeight_px = 180, kGap_px = 4;
constexpr double kPixelsPerMetre = 26;
constexpr float kPaper = 0.97f, kInk = 0.02f;

Image paper(std::uint32_t width_px) {
  Image image{.width = width_px, .height = kHeight_px, .channels = 4, .pixels = {}};
  image.pixels.assign(std::size_t{4} * width_px * kHeight_px, kPaper);
  return image;
}

void dot(Image& image, double x, double y) {
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const double column = std::floor(x) + dx, row = std::floor(y) + dy;
      if (column < 0 || row < 0 || column >= image.width || row >= image.height) continue;
      const auto first = static_cast<std::size_t>(row * image.width + column) * 4;
      std::fill_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(first), 3, kInk);
    }
  }
}

Image from_above(const Scan& scan) {
  Image image = paper(kWidth_px);
  for (std::uint32_t beam = 0; beam < scan.columns; ++beam) {
    const double range_m = scan.range_m[beam], azimuth = scan.azimuth_rad[beam];
    if (!std::isfinite(range_m) || range_m == 0) continue;
    dot(image, range_m * std::cos(azimuth) * kPixelsPerMetre,
        kHeight_px / 2.0 - range_m * std::sin(azimuth) * kPixelsPerMetre);
  }
  return image;
}

// After some frames: what has a past has one then.
Image seen(const Watcher& watcher, const Setting& setting) {
  constexpr int kFrames = 2;
  Simulation simulation = yard(watcher, setting);
  for (int frame = 0; frame < kFrames; ++frame) simulation.step();
  return watcher.shows == kShownInColor ? simulation.color("WATCH") : from_above(simulation.scan("WATCH"));
}

void copy(const Image& from, std::uint32_t column, Image& to) {
  for (std::uint32_t row = 0; row < from.height; ++row) {
    std::copy_n(from.pixels.begin() + std::ptrdiff_t{row} * from.width * 4, std::size_t{from.width} * 4,
                to.pixels.begin() + (std::ptrdiff_t{row} * to.width + column) * 4);
  }
}

}  // namespace

void write_effect_pictures(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const EffectType* effect : effect_types()) {
    for (const Watcher* watcher : {&kYardCamera, &kYardScanner}) {
      if (!can_show(*effect, *watcher)) continue;
      Image strip = paper(2 * kWidth_px + kGap_px);
      copy(seen(*watcher, without_effect(*effect)), 0, strip);
      copy(seen(*watcher, with_effect(*effect, *watcher)), kWidth_px + kGap_px, strip);
      const std::string suffix = watcher->shows == kShownInColor ? "" : "_scan";
      const std::filesystem::path path = folder / (std::string(effect->name) + suffix + ".png");
      std::ofstream file(path, std::ios::binary);
      file << encode_png(strip);
      if (!file.flush()) throw MachineError("cannot write " + path.string());
    }
  }
}

}  // namespace simvis::bench
