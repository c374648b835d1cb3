// How a simulation is made: rate, seed, device, and attributes written over those of the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/progress.h>

namespace simvis {

/// An attribute written over those of all sensors of one type, before the scene is built.
struct AttributeOverride {
  std::string sensor_type, attribute;
  std::optional<std::string> value;  ///< nothing: what the scene says is dropped, so that the default counts
  std::string origin;                ///< who asks for it, for messages: "--method"; empty: "SENSOR_TYPE.ATTRIBUTE"
};

struct SimulationDesc {
  double rate_hz = 15;     ///< frames per simulated second, finite and above 0
  std::uint64_t seed = 0;  ///< of all random numbers
  /// How many threads a step works on, the calling thread included: SimVis casts rays, culls views and prepares meshes
  /// on them. 0: as many as the machine has; above 1024: InputError. Simulations of one process that give the same
  /// number share one pool. Results are the same bytes for every number. The Vulkan driver has threads of its own.
  unsigned threads = 0;
  DeviceDesc device;
  std::vector<AttributeOverride> overrides;
  /// Called while parts are read (load, execute) and while the meshes that a step shows for the first time are
  /// prepared.
  ProgressCallback progress{};
};

}  // namespace simvis
