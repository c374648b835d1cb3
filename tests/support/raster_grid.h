// The grid to which the device that the tests use snaps the corners of triangles; see PassResult.
#pragma once

#include <simvis/device.h>
#include "engine/vulkan/device_impl.h"

namespace simvis {

struct RasterGrid {
  double snap_px = 0;        ///< 2^-subPixelPrecisionBits
  double depth_snap_px = 0;  ///< 0: depth is that of the corners as they were
};

inline const RasterGrid& raster_grid() {
  static const RasterGrid grid = [] {
    Device device{DeviceDesc{}};
    return RasterGrid{.snap_px = device.impl().physical.snap_px, .depth_snap_px = device.impl().physical.depth_snap_px};
  }();
  return grid;
}

}  // namespace simvis
