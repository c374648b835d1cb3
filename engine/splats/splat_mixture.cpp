#include "engine/splats/splat_mixture.h"

#include <tuple>

#include "engine/base/srgb.h"

namespace simvis {

bool comes_before(const SplatHit& a, const SplatHit& b) {
  if (a.range_m != b.range_m) return a.range_m < b.range_m;
  const auto row_of = [](const SplatHit& hit) {
    const glm::vec3& color = hit.splat->color;
    return std::tuple(hit.alpha, color.x, color.y, color.z, hit.splat->encoding, hit.splat->item);
  };
  return row_of(a) < row_of(b);
}

void SplatMixture::add(const SplatHit& hit) {
  const double weight = sight_.transmittance * hit.alpha;
  Mixed& mixed = mixed_[static_cast<std::size_t>(hit.splat->encoding)];
  mixed.color += weight * glm::dvec3(hit.splat->color);
  mixed.weight += weight;
  sight_.transmittance *= 1 - hit.alpha;
  constexpr double kHalf = 0.5;
  if (sight_.half_item != kNoItem || sight_.transmittance > kHalf) return;
  sight_.half_m = hit.range_m;
  sight_.half_item = hit.splat->item;
}

SplatSight SplatMixture::sight() const {
  SplatSight sight = sight_;
  const Mixed &srgb = mixed_[static_cast<std::size_t>(SplatEncoding::srgb)],
              &linear = mixed_[static_cast<std::size_t>(SplatEncoding::linear)];
  sight.color = linear.color;
  for (int i = 0; srgb.weight > 0 && i < 3; ++i) {
    sight.color[i] += srgb.weight * decode_srgb(srgb.color[i] / srgb.weight);
  }
  return sight;
}

}  // namespace simvis
