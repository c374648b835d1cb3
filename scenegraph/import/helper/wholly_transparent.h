// Which materials of mesh files are wholly transparent. Old exporters write opaque surfaces so.
#pragma once

namespace simvis {

/// Below half a step of an 8-bit alpha channel no program shows a surface.
inline constexpr double kWhollyTransparent = 0.5 / 255;

}  // namespace simvis
