// The smaller levels of a texture. The host computes them, so that they are the same on every device.
#pragma once

#include <cstdint>
#include <vector>

#include <simvis/mesh.h>
#include "engine/base/thread_pool.h"

namespace simvis {

/// The meaning of a texture's texels. The mean of several texels depends on it.
enum class TexelKind : std::uint8_t {
  data,           ///< four independent numbers
  color,          ///< an sRGB-encoded colour; alpha is independent of it
  covering_color  ///< an sRGB-encoded colour that covers the share alpha of the texel
};

struct MipLevel {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< rows from the top, as Texture::rgba
};

/// The levels after the first one, down to a single texel; none if the sampler does not use them. Each has half as many
/// columns and rows as the one before it, rounded down but at least one.
///
/// A texel is the mean of the area that it covers, so an odd number of columns or rows loses none of them. Colours are
/// averaged in linear light, covering colours with alpha as their weight; transparent texels get the colour of what is
/// near, because samplers mix them with their neighbours. Means are computed from means that have not been rounded to
/// bytes: each byte is rounded once.
std::vector<MipLevel> smaller_levels(const Texture& texture, TexelKind kind, ThreadPool& threads);

}  // namespace simvis
