// The smaller levels of textures, against means over texels in double precision.
#include "engine/draw/mip_levels.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "engine/base/srgb.h"
#include "tests/support/random_numbers.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
using namespace simvis::test;

namespace {

// A mean is stored as float32 at each of at most 12 levels, and converted once: 13 roundings of 2^-24, relative.
constexpr double kMeanRounding = 13 * 0x1p-24;

using Texel = std::array<std::uint8_t, 4>;

template <typename At>
std::shared_ptr<Texture> painted(std::uint32_t width, std::uint32_t height, const At& at) {
  auto texture = std::make_shared<Texture>();
  texture->name = "painted";
  texture->width = width;
  texture->height = height;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const Texel texel = at(x, y);
      texture->rgba.insert(texture->rgba.end(), texel.begin(), texel.end());
    }
  }
  return texture;
}

std::shared_ptr<Texture> random_texels(std::uint32_t width, std::uint32_t height) {
  Random random(11);
  const auto byte = [&] { return static_cast<std::uint8_t>(random.below(256)); };
  return painted(width, height, [&](std::uint32_t, std::uint32_t) { return Texel{byte(), byte(), byte(), byte()}; });
}

ThreadPool& one_thread() {
  static ThreadPool pool(1);
  return pool;
}

// Whether the byte is the code of the value, up to the rounding of the value.
bool is_code(std::uint8_t byte, double value) { return std::abs(byte - 255 * value) <= 0.5 + 255 * kMeanRounding; }

bool is_srgb_code(std::uint8_t byte, double linear) {
  return srgb_code(static_cast<float>(linear * (1 - kMeanRounding))) <= byte &&
         byte <= srgb_code(static_cast<float>(linear * (1 + kMeanRounding)));
}

// A leaf texture: opaque green dots on transparent magenta.
constexpr Texel kLeaf{40, 160, 30, 255}, kGap{255, 0, 255, 0};
bool has_leaf(std::uint32_t x, std::uint32_t y) { return (x * 7 + y * 13) % 16 < 5; }
std::shared_ptr<Texture> leaves() {
  return painted(64, 64, [](std::uint32_t x, std::uint32_t y) { return has_leaf(x, y) ? kLeaf : kGap; });
}

}  // namespace

TEST_CASE("each level has half the columns and rows, down to one texel, unless the sampler uses one level") {
  const auto texture = random_texels(37, 6);
  const auto levels = smaller_levels(*texture, TexelKind::color, one_thread());
  REQUIRE(levels.size() == 5);
  constexpr std::uint32_t kWidths[] = {18, 9, 4, 2, 1}, kHeights[] = {3, 1, 1, 1, 1};
  for (std::size_t i = 0; i < levels.size(); ++i) {
    CHECK(levels[i].width == kWidths[i]);
    CHECK(levels[i].height == kHeights[i]);
    CHECK(levels[i].rgba.size() == std::size_t{4} * kWidths[i] * kHeights[i]);
  }
  texture->sampler.mipmapped = false;
  CHECK(smaller_levels(*texture, TexelKind::color, one_thread()).empty());
  CHECK(smaller_levels(*random_texels(1, 1), TexelKind::color, one_thread()).empty());
}

TEST_CASE("the last level is the mean of all texels, for sizes that are odd too") {
  for (const auto& [width, height] : {std::pair{64u, 32u}, {63u, 37u}, {5u, 1u}, {1u, 7u}, {3u, 3u}}) {
    CAPTURE(width);
    CAPTURE(height);
    const auto texture = random_texels(width, height);
    std::array<double, 4> plain{}, linear{}, covering{};
    for (std::size_t i = 0; i < texture->rgba.size(); ++i) {
      const double value = texture->rgba[i] / 255.0, alpha = texture->rgba[i / 4 * 4 + 3] / 255.0;
      const double count = width * height;
      plain[i % 4] += value / count;
      linear[i % 4] += decode_srgb(value) / count;
      covering[i % 4] += alpha * decode_srgb(value) / count;
    }
    const Texel data = [&] {
      Texel texel;
      std::ranges::copy(smaller_levels(*texture, TexelKind::data, one_thread()).back().rgba, texel.begin());
      return texel;
    }();
    const auto color = smaller_levels(*texture, TexelKind::color, one_thread()).back().rgba;
    const auto covered = smaller_levels(*texture, TexelKind::covering_color, one_thread()).back().rgba;
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(is_code(data[c], plain[c]));
      CHECK(is_srgb_code(color[c], linear[c]));
      CHECK(is_srgb_code(covered[c], covering[c] / plain[3]));
    }
    for (const std::uint8_t alpha : {data[3], color[3], covered[3]}) CHECK(is_code(alpha, plain[3]));
  }
}

TEST_CASE("each texel of a level is the mean of the area that it covers") {
  // Five columns become two, and each of these covers two columns and half of the one in the middle.
  const auto five = painted(5, 1, [](std::uint32_t x, std::uint32_t) {
    const auto value = static_cast<std::uint8_t>(50 * x);
    return Texel{value, value, value, 255};
  });
  const auto levels = smaller_levels(*five, TexelKind::data, one_thread());
  CHECK(is_code(levels[0].rgba[0], (0 + 50 + 0.5 * 100) / 2.5 / 255));
  CHECK(is_code(levels[0].rgba[4], (0.5 * 100 + 150 + 200) / 2.5 / 255));
  CHECK(is_code(levels[1].rgba[0], 100.0 / 255));
}

TEST_CASE("colours are averaged in linear light, and each level is rounded once") {
  const auto board = painted(64, 64, [](std::uint32_t x, std::uint32_t y) {
    const std::uint8_t value = (x + y) % 2 ? 255 : 0;
    return Texel{value, value, value, 255};
  });
  for (const MipLevel& level : smaller_levels(*board, TexelKind::color, one_thread())) {
    for (std::size_t i = 0; i < level.rgba.size(); ++i) CHECK(level.rgba[i] == (i % 4 < 3 ? srgb_code(0.5f) : 255));
  }
}

TEST_CASE("colours of transparent texels are not mixed with those that cover something") {
  const auto texture = leaves();
  for (const MipLevel& level : smaller_levels(*texture, TexelKind::covering_color, one_thread())) {
    CAPTURE(level.width);
    for (std::size_t i = 0; i < level.rgba.size(); i += 4) {
      for (std::size_t c = 0; c < 3; ++c) CHECK(level.rgba[i + c] == kLeaf[c]);
    }
  }
  // Opaque materials ignore alpha.
  const auto ignored = smaller_levels(*texture, TexelKind::color, one_thread()).back().rgba;
  CHECK(ignored[0] > 200);
}

TEST_CASE("levels are the same bytes on any number of threads") {
  const auto texture = random_texels(301, 257);
  ThreadPool several(4);
  const auto one = smaller_levels(*texture, TexelKind::covering_color, one_thread());
  const auto four = smaller_levels(*texture, TexelKind::covering_color, several);
  REQUIRE(one.size() == four.size());
  for (std::size_t i = 0; i < one.size(); ++i) CHECK(one[i].rgba == four[i].rgba);
}

namespace {

// Two steps of sRGB at the brightest code, 2.3 / 255 each in linear light: the level's rounding and the driver's
// decoding and filtering in 8 bits.
constexpr double kLevelStep = 2 * 2.3 / 255;

std::span<const glm::vec4> drawn_wall(Renderer& renderer, const std::shared_ptr<const Texture>& texture, AlphaMode mode,
                                      std::uint32_t pixels) {
  Material material;
  material.alpha_mode = mode;
  material.base_color_texture = texture;
  material.unlit = true;
  const RendererScene scene = textured_wall(material);
  return renderer.render(scene.list, plan_of(pixels, pixels, pixels / 2.0, true, false))[0].color;
}

}  // namespace

TEST_CASE("a distant pattern of odd size shows its mean in linear light") {
  Renderer renderer(device());
  // Two of three columns are white; level by level, 243, 121, 60, 30, 15, 7, 3 and 1 columns.
  const auto stripes = painted(243, 243, [](std::uint32_t x, std::uint32_t) {
    const std::uint8_t value = x % 3 < 2 ? 255 : 0;
    return Texel{value, value, value, 255};
  });
  double sum = 0;
  constexpr std::uint32_t kPixels = 4;
  for (const glm::vec4& color : drawn_wall(renderer, stripes, AlphaMode::opaque, kPixels)) sum += color.r;
  CHECK(std::abs(sum / (kPixels * kPixels) - 2.0 / 3) <= kLevelStep);
}

TEST_CASE("distant foliage keeps its coverage and the colour of its leaves") {
  Renderer renderer(device());
  double covered = 0;
  for (std::uint32_t i = 0; i < 64 * 64; ++i) covered += has_leaf(i % 64, i / 64) / (64.0 * 64.0);
  constexpr std::uint32_t kPixels = 21;  // three texels a pixel; the pattern repeats after 16, which 3 does not divide
  double drawn = 0;
  for (const glm::vec4& color : drawn_wall(renderer, leaves(), AlphaMode::mask, kPixels)) {
    if (color == glm::vec4(kBackground, kBackground, kBackground, 1)) continue;
    drawn += 1.0 / (kPixels * kPixels);
    for (glm::length_t c = 0; c < 3; ++c) {
      CHECK(std::abs(color[c] - decode_srgb(kLeaf[static_cast<std::size_t>(c)] / 255.0)) <= kLevelStep);
    }
  }
  // Pixels are samples of the mask: five standard deviations of as many independent ones.
  CHECK(std::abs(drawn - covered) <= 5 * std::sqrt(covered * (1 - covered)) / kPixels);
}
