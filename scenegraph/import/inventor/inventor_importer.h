// Inventor 2.x and VRML parts, .iv and .wrl, read with Coin.
#pragma once

#include <chrono>

#include <simvis/part_importer.h>

namespace simvis {

inline constexpr std::chrono::milliseconds kInventorTimeLimit{10'000};

/// Reads Inventor 2.x (ASCII, binary), VRML 1.0 and VRML97. Coin does it in a program of its own.
///
/// Shapes   triangles, lines, points, normals and texture coordinates as Coin makes them; each shape in its own frame
///          under a Transform, and shapes of equal content share one mesh. Engines and interpolators stand at time 0.
/// Colours  of materials, vertices and lights are taken as sRGB, which is what they were chosen on.
/// Lights   a directional light of intensity I gives pi * I lux: a white surface that faces it reflects I. A point or
///          spot light gives at 1 m what Coin gives it everywhere, and falls off with the square of the distance. Each
///          lights the whole scene.
/// Commands the strings of Info nodes and the `info` of WorldInfo nodes that begin with '<', white space aside.
/// Frame    as it is, metres; with up="y" (x, y, z) becomes (x, -z, y).
/// Throws   InputError naming the file: Coin cannot read it, crashes on it or takes longer than `limit`; a number that
///          is not finite; an included file that is missing. A texture that is missing or cannot be read is a warning.
///          A build without Coin always throws. MachineError when the program simvis-import-inventor is missing.
PartContent import_inventor(const ImportRequest& request, ContentPool& pool,
                            std::chrono::milliseconds limit = kInventorTimeLimit);

}  // namespace simvis
