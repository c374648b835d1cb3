#include "engine/draw/mip_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <span>

#include "engine/base/srgb.h"

namespace simvis {
namespace {

// A piece of a parallel loop has about as many texels.
constexpr std::size_t kTexelsOfPiece = 1u << 14;

// The one to three columns or rows of a level that one of the next level covers, and the share of each.
struct Taps {
  std::uint32_t first, count;
  std::array<double, 3> share;
};

Taps taps_of(std::uint32_t size, std::uint32_t index) {
  if (size == 1) return {0, 1, {1}};
  if (size % 2 == 0) return {2 * index, 2, {0.5, 0.5}};
  const std::uint32_t half = size / 2;
  const double whole = size;
  return {2 * index, 3, {(half - index) / whole, half / whole, (index + 1) / whole}};
}

// Converts texels from bytes to numbers that can be averaged, and back. The numbers of a covering colour are its
// products with alpha, and alpha.
class TexelCode {
 public:
  explicit TexelCode(TexelKind kind) : kind_(kind) {
    for (std::size_t byte = 0; byte < linear_.size(); ++byte) {
      const double share = static_cast<double>(byte) / 255;
      alpha_[byte] = static_cast<float>(share);
      linear_[byte] = kind == TexelKind::data ? alpha_[byte] : linear_from_srgb(share);
    }
  }

  glm::vec4 decoded(const std::uint8_t* rgba) const {
    const glm::vec3 color(linear_[rgba[0]], linear_[rgba[1]], linear_[rgba[2]]);
    const float alpha = alpha_[rgba[3]];
    return {kind_ == TexelKind::covering_color ? color * alpha : color, alpha};
  }

  void encode(const glm::vec4& mean, std::uint8_t* rgba) const {
    const bool weighted = kind_ == TexelKind::covering_color && mean.a > 0;
    const glm::vec3 color = weighted ? glm::vec3(mean) / mean.a : glm::vec3(mean);
    for (glm::length_t i = 0; i < 3; ++i) rgba[i] = kind_ == TexelKind::data ? code(color[i]) : srgb_code(color[i]);
    rgba[3] = code(mean.a);
  }

 private:
  static std::uint8_t code(float share) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
  }

  TexelKind kind_;
  std::array<float, 256> linear_, alpha_;  // of a byte
};

// A level that has not been rounded to bytes.
struct Means {
  std::uint32_t width, height;
  std::vector<glm::vec4> texels;
};

// `row(y, scratch)` returns the row y of the level before, which has `width` and `height`. It may use `scratch`.
template <typename Row>
Means halved(std::uint32_t width, std::uint32_t height, const Row& row, ThreadPool& threads) {
  Means means{std::max(width / 2, 1u), std::max(height / 2, 1u), {}};
  means.texels.resize(std::size_t{means.width} * means.height);
  std::vector<Taps> columns(means.width);
  for (std::uint32_t x = 0; x < means.width; ++x) columns[x] = taps_of(width, x);
  const std::size_t rows_of_piece = std::max<std::size_t>(kTexelsOfPiece / means.width, 1);
  threads.parallel_for(means.height, rows_of_piece, [&](std::size_t, std::size_t first, std::size_t count) {
    std::vector<glm::vec4> scratch(width);
    std::vector<glm::dvec4> sums(means.width);
    for (std::size_t y = first; y < first + count; ++y) {
      const Taps rows = taps_of(height, static_cast<std::uint32_t>(y));
      std::ranges::fill(sums, glm::dvec4(0));
      for (std::uint32_t r = 0; r < rows.count; ++r) {
        const glm::vec4* const texels = row(rows.first + r, scratch);
        for (std::uint32_t x = 0; x < means.width; ++x) {
          const Taps& taps = columns[x];
          for (std::uint32_t c = 0; c < taps.count; ++c) {
            sums[x] += rows.share[r] * taps.share[c] * glm::dvec4(texels[taps.first + c]);
          }
        }
      }
      std::ranges::copy(sums, means.texels.begin() + static_cast<std::ptrdiff_t>(y * means.width));
    }
  });
  return means;
}

MipLevel rounded(const Means& means, const TexelCode& code, ThreadPool& threads) {
  MipLevel level{means.width, means.height, std::vector<std::uint8_t>(4 * means.texels.size())};
  threads.parallel_for(means.texels.size(), kTexelsOfPiece, [&](std::size_t, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) code.encode(means.texels[i], &level.rgba[4 * i]);
  });
  return level;
}

// Gives transparent texels the colour of the smallest area around them that is not transparent.
void fill_transparent(std::vector<MipLevel>& levels) {
  for (std::size_t i = levels.size() - 1; i > 0; --i) {
    MipLevel& level = levels[i - 1];
    const MipLevel& next = levels[i];
    for (std::uint32_t y = 0; y < level.height; ++y) {
      for (std::uint32_t x = 0; x < level.width; ++x) {
        std::uint8_t* const texel = &level.rgba[4 * (std::size_t{y} * level.width + x)];
        if (texel[3] > 0) continue;
        const std::uint32_t column = std::min(x / 2, next.width - 1), row = std::min(y / 2, next.height - 1);
        std::copy_n(&next.rgba[4 * (std::size_t{row} * next.width + column)], 3, texel);
      }
    }
  }
}

}  // namespace

std::vector<MipLevel> smaller_levels(const Texture& texture, TexelKind kind, ThreadPool& threads) {
  std::vector<MipLevel> levels;
  if (!texture.sampler.mipmapped || std::max(texture.width, texture.height) == 1) return levels;
  const TexelCode code(kind);
  const auto decoded_row = [&](std::uint32_t y, std::span<glm::vec4> scratch) {
    const std::uint8_t* const from = &texture.rgba[std::size_t{4} * y * texture.width];
    for (std::size_t x = 0; x < scratch.size(); ++x) scratch[x] = code.decoded(from + 4 * x);
    return scratch.data();
  };
  Means means = halved(texture.width, texture.height, decoded_row, threads);
  levels.push_back(rounded(means, code, threads));
  while (std::max(means.width, means.height) > 1) {
    const auto kept_row = [&](std::uint32_t y, std::span<glm::vec4>) {
      return &means.texels[std::size_t{y} * means.width];
    };
    means = halved(means.width, means.height, kept_row, threads);
    levels.push_back(rounded(means, code, threads));
  }
  if (kind == TexelKind::covering_color) fill_transparent(levels);
  return levels;
}

}  // namespace simvis
