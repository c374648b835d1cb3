// What is known of a Vulkan device before it is opened, and how one is selected.
#pragma once

#include <string>

#include <simvis/progress.h>

namespace simvis {

/// A Vulkan device of this machine, as known before one is selected.
struct DeviceInfo {
  std::string name;         ///< the driver's name for the device
  std::string type;         ///< "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other"
  std::string driver;       ///< driver name and version text; ends in ", bundled" for that of SimVis
  std::string api_version;  ///< "1.3.230"
  std::string unusable;     ///< empty, or why SimVis cannot run on it
};

/// How a device is selected and used.
struct DeviceDesc {
  /// Part of a name (any case) or an index of list_devices(); empty: the best device (discrete before integrated before
  /// virtual before CPU, drivers of the system before that of SimVis); "bundled": the driver that SimVis was built with
  /// (-DSIMVIS_DRIVER, as for a wheel).
  std::string select;
  bool validation = false;  ///< enables the Khronos validation layer and counts its errors and warnings
  std::string cache_dir;    ///< folder of caches; empty: $XDG_CACHE_HOME/simvis or ~/.cache/simvis
  /// Measures times and counts on the device, see FrameCosts. No result depends on it. Without it no query is recorded.
  bool instrumented = false;
  ProgressCallback progress{};  ///< called while meshes are prepared for drawing
};

}  // namespace simvis
