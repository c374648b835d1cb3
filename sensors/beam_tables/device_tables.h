// The beam tables of devices that one can buy, from public sources.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// A table that SimVis has.
struct DeviceTable {
  std::string_view name;             ///< "velodyne_vlp16"
  std::string_view device;           ///< "Velodyne VLP-16"
  std::string_view source;           ///< where its numbers are from
  BeamTable (*make)(std::size_t i);  ///< makes the table; `i` is its place among those of its maker
  std::size_t index = 0;             ///< the argument of `make`
};

/// All tables, by maker.
const std::vector<DeviceTable>& device_tables();

/// The table of this name, or null. It is valid for the rest of the program.
const DeviceTable* find_device_table(std::string_view name);

/// Those of each maker.
std::vector<DeviceTable> velodyne_device_tables();
std::vector<DeviceTable> ouster_device_tables();
std::vector<DeviceTable> hesai_device_tables();

}  // namespace simvis
