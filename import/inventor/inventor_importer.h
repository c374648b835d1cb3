// Imports Inventor 2.x and VRML parts (.iv, .wrl) with Coin.
#pragma once

#include <chrono>

#include <simvis/part_importer.h>

namespace simvis {

inline constexpr std::chrono::milliseconds kInventorTimeLimit{10'000};

/// Reads Inventor 2.x (ASCII, binary), VRML 1.0 and VRML97. Coin runs in a separate program.
///
/// Shapes   triangles, lines, points, normals and texture coordinates as Coin generates them. Each shape keeps its own
///          frame under a Transform, and shapes of equal content share one mesh. Engines and interpolators stay at time
///          0.
/// Colours  of materials, vertices and lights are read as sRGB, because they were chosen on a display.
/// Lights   a directional light of intensity I gives pi * I lux, so that a white surface that faces it reflects I. A
///          point or spot light gives at 1 m the light that Coin gives at every distance, and falls off with the square
///          of the distance. Each light lights the whole scene.
/// Commands the strings of Info nodes and the `info` of WorldInfo nodes that begin with '<' after white space.
/// Frame    unchanged, in metres; with up="y" (x, y, z) becomes (x, -z, y).
/// Throws   InputError naming the file if Coin cannot read it, crashes on it or takes longer than `limit`, if a number
///          is not finite, or if an included file is missing. A texture that is missing or cannot be read causes a
///          warning. A build without Coin always throws InputError. Throws MachineError if the program
///          simvis-import-inventor is missing.
PartContent import_inventor(const ImportRequest& request, ContentPool& pool,
                            std::chrono::milliseconds limit = kInventorTimeLimit);

}  // namespace simvis
