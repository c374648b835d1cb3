#include "program/datasets/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/srgb.h"
#include "program/datasets/seen_view.h"
#include "scenegraph/pictures/png_bytes.h"

namespace simvis {
namespace {

using Rgb = std::array<std::uint8_t, 3>;
constexpr Rgb kBlack{0, 0, 0}, kDark{70, 70, 70};
constexpr std::uint32_t kTiles = 4;
constexpr std::uint32_t kMaxTileHeight_px = 4 * kSheetTile_px;  // taller pictures are squeezed
constexpr std::size_t kRowBytes = std::size_t{3} * kTiles * kSheetTile_px;

/// Red, green and blue of a hue from 0 to 1, strong and light.
Rgb rgb_of_hue(double hue) {
  Rgb color{};
  for (int channel = 0; channel < 3; ++channel) {
    const double at = std::fmod(6 * hue + 4 - 2 * channel, 6);  // distance around the circle of hues
    const double share = std::clamp(std::abs(at - 3) - 1, 0.0, 1.0);
    color[static_cast<std::size_t>(channel)] = static_cast<std::uint8_t>(std::lround(60 + 195 * share));
  }
  return color;
}

/// Colours of instances: neighbours in the order of ids are far apart on the circle of hues. What has no class is dark.
std::map<std::uint32_t, Rgb> instance_colors(std::span<const SceneItem> items) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  std::map<std::uint32_t, Rgb> colors;
  for (const SceneItem& item : items) colors[item.instance] = item.semantic == 0 ? kDark : kBlack;
  int number = 0;
  for (auto& [id, color] : colors) {
    if (color == kBlack) color = rgb_of_hue(std::fmod(kGoldenRatio * number++, 1));
  }
  return colors;
}

/// The finite depths of a picture, from the nearest to the farthest.
struct DepthSpan {
  double nearest_m = std::numeric_limits<double>::infinity(), farthest_m = 0;

  explicit DepthSpan(const std::optional<Image>& depth) {
    if (!depth) return;
    for (const float each : depth->pixels) {
      const auto depth_m = static_cast<double>(each);
      if (!std::isfinite(depth_m) || depth_m <= 0) continue;
      nearest_m = std::min(nearest_m, depth_m);
      farthest_m = std::max(farthest_m, depth_m);
    }
  }

  Rgb gray(double depth_m) const {
    if (!std::isfinite(depth_m) || depth_m <= 0) return kBlack;
    const double share = farthest_m > nearest_m ? std::log(depth_m / nearest_m) / std::log(farthest_m / nearest_m) : 0;
    const auto code = static_cast<std::uint8_t>(std::lround(255 - 225 * std::clamp(share, 0.0, 1.0)));
    return {code, code, code};
  }
};

/// One view, scaled to the width of a tile by taking the nearest pixel.
class SheetView {
 public:
  SheetView(const SeenView& view, const std::map<std::uint32_t, Rgb>& colors)
      : view_(view),
        colors_(colors),
        depths_(view.depth),
        codes_(std::size_t{3} * view.camera.width_px * view.camera.height_px),
        height_(std::clamp(kSheetTile_px * view.camera.height_px / view.camera.width_px, 1U, kMaxTileHeight_px)),
        rows_(kRowBytes * height_, '\0') {
    srgb_codes(view.color->pixels, codes_);
  }

  std::string rows() {
    for (std::uint32_t y = 0; y < height_; ++y) {
      for (std::uint32_t x = 0; x < kSheetTile_px; ++x) fill(x, y);
    }
    for (const ObjectInView& object : view_.objects) draw_box(object);
    return std::move(rows_);
  }

 private:
  void put(std::uint32_t tile, std::uint32_t x, std::uint32_t y, const Rgb& color) {
    const std::size_t at = y * kRowBytes + std::size_t{3} * (tile * kSheetTile_px + x);
    for (std::size_t c = 0; c < 3; ++c) rows_[at + c] = static_cast<char>(color[c]);
  }

  Rgb color_of(std::uint32_t instance) const {
    const auto found = colors_.find(instance);
    return found == colors_.end() ? kBlack : found->second;
  }

  void fill(std::uint32_t x, std::uint32_t y) {
    const std::uint32_t column = x * view_.camera.width_px / kSheetTile_px, row = y * view_.camera.height_px / height_;
    const std::size_t pixel = std::size_t{row} * view_.camera.width_px + column;
    const Rgb color{codes_[3 * pixel], codes_[3 * pixel + 1], codes_[3 * pixel + 2]};
    put(0, x, y, color);
    put(3, x, y, color);
    if (view_.depth) put(1, x, y, depths_.gray(static_cast<double>(view_.depth->pixels[pixel])));
    if (view_.instance != nullptr) put(2, x, y, color_of(static_cast<std::uint32_t>(view_.instance->number(pixel))));
  }

  void draw_box(const ObjectInView& object) {
    const bool is_visible = object.visible_pixels > 0;
    const BoxPx& box = is_visible ? object.visible : object.full;
    const double sx = static_cast<double>(kSheetTile_px) / view_.camera.width_px,
                 sy = static_cast<double>(height_) / view_.camera.height_px;
    const auto left = static_cast<int>(std::floor(box.x_min * sx)), top = static_cast<int>(std::floor(box.y_min * sy)),
               right = static_cast<int>(std::ceil(box.x_max * sx)) - 1,
               bottom = static_cast<int>(std::ceil(box.y_max * sy)) - 1;
    for (int x = left; x <= right; ++x) {
      for (const int y : {top, bottom}) dot(x, y, x, is_visible, object.instance);
    }
    for (int y = top; y <= bottom; ++y) {
      for (const int x : {left, right}) dot(x, y, y, is_visible, object.instance);
    }
  }

  void dot(int x, int y, int along, bool is_solid, std::uint32_t instance) {
    constexpr int kDot_px = 3;
    if (x < 0 || y < 0 || x >= static_cast<int>(kSheetTile_px) || y >= static_cast<int>(height_)) return;
    if (!is_solid && (along / kDot_px) % 2 != 0) return;
    put(3, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), color_of(instance));
  }

  const SeenView& view_;
  const std::map<std::uint32_t, Rgb>& colors_;
  DepthSpan depths_;
  std::vector<std::uint8_t> codes_;
  std::uint32_t height_;
  std::string rows_;
};

}  // namespace

bool is_on_sheet(std::uint64_t frame, std::uint64_t frames) {
  const std::uint64_t every = (frames + kSheetFrames - 1) / kSheetFrames;
  return frame % every == 0;
}

std::string sheet_rows(const DatasetFrame& frame) {
  std::string rows;
  const std::map<std::uint32_t, Rgb> colors = instance_colors(frame.items);
  for (const SeenView& view : views_of(frame.sensors)) {
    if (view.color) rows += SheetView(view, colors).rows();
  }
  return rows;
}

bool is_sheet(const std::string& rows) { return rows.size() % kRowBytes == 0; }

std::string sheet_png(const std::string& rows) {
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(rows.data()), rows.size());
  return png_bytes({.width = kTiles * kSheetTile_px, .height = static_cast<std::uint32_t>(rows.size() / kRowBytes)},
                   bytes);
}

}  // namespace simvis
