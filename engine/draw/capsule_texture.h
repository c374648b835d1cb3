// How a texture extends over a capsule.
#pragma once

namespace simvis {

/// The share of the texture's height that covers the cylinder; the two half spheres have equal parts of the rest.
inline constexpr double kCapsuleSideShare = 1.0 / 31;

}  // namespace simvis
