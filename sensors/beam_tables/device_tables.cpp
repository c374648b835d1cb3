#include "sensors/beam_tables/device_tables.h"

#include <algorithm>

namespace simvis {

const std::vector<DeviceTable>& device_tables() {
  static const std::vector<DeviceTable> tables = [] {
    std::vector<DeviceTable> all = velodyne_device_tables();
    std::ranges::copy(ouster_device_tables(), std::back_inserter(all));
    std::ranges::copy(hesai_device_tables(), std::back_inserter(all));
    return all;
  }();
  return tables;
}

const DeviceTable* find_device_table(std::string_view name) {
  const auto found = std::ranges::find(device_tables(), name, &DeviceTable::name);
  return found == device_tables().end() ? nullptr : &*found;
}

}  // namespace simvis
