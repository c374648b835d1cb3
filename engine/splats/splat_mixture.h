// The splats along one ray, from the nearest on.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include <simvis/frame_results.h>
#include "engine/splats/seen_splats.h"

namespace simvis {

/// A splat on a ray.
struct SplatHit {
  double range_m = 0, alpha = 0;
  const SeenSplat* splat = nullptr;
};

/// What one ray sees.
struct SplatSight {
  glm::dvec3 color{0};                                      ///< linear light that splats add
  double transmittance = 1;                                 ///< share that is seen of what lies behind
  double half_m = std::numeric_limits<double>::infinity();  ///< range at which the transmittance becomes at most a half
  std::uint32_t half_item = kNoItem;                        ///< of the splat at that range; kNoItem: there is none
};

/// The order along a ray: by range. Hits that no member of the comparison tells apart add the same light.
bool comes_before(const SplatHit& a, const SplatHit& b);

/// What lies behind a smaller transmittance is not looked at.
inline constexpr double kMinTransmittance = 1e-4;

class SplatMixture {
 public:
  /// Adds the next splat.
  void add(const SplatHit& hit);
  /// Whether more splats change nothing that counts.
  bool complete() const { return sight_.transmittance < kMinTransmittance; }
  SplatSight sight() const;

 private:
  struct Mixed {
    glm::dvec3 color{0};
    double weight = 0;
  };
  SplatSight sight_;
  std::array<Mixed, 2> mixed_;  // by encoding
};

}  // namespace simvis
