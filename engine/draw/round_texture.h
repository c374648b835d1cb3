// How textures extend over round shapes. Set 0 of the texture coordinates has the picture upright on each side, seen
// from outside, and one picture for a whole capsule. Set 1 is that of MuJoCo: both discs of a cylinder have the picture
// along x and y, so that the upper one shows it mirrored, and a capsule has three pictures one below the other, on its
// upper half sphere, its cylinder, and its lower half sphere. Both sets are the same on all other shapes and sides.
#pragma once

namespace simvis {

/// A capsule divides the height of its texture into this many parts: its cylinder has one of them, and its two half
/// spheres share the others equally.
inline constexpr int kCapsuleParts = 31;
inline constexpr double kCapsuleSideShare = 1.0 / kCapsuleParts;

/// In set 1, v of a half sphere of a capsule: `latitude` from 0 at its rim to 1 at its pole. On the cylinder v goes
/// from 0 at the upper end to 1.
constexpr double capsule_end_v(double latitude, bool is_upper) { return is_upper ? -latitude : 1 + latitude; }

/// In set 1, v of a point of a disc, `y` from -1 to 1 within it.
constexpr double disc_v(double y) { return 0.5 + 0.5 * y; }

}  // namespace simvis
