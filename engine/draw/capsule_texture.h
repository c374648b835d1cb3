// How a texture extends over a capsule.
#pragma once

namespace simvis {

/// Of this many parts of the texture's height one covers the cylinder; the two half spheres have equal parts of the
/// rest.
inline constexpr int kCapsuleParts = 31;
inline constexpr double kCapsuleSideShare = 1.0 / kCapsuleParts;

}  // namespace simvis
