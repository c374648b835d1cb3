// What the environment says about the faults, limits and memory of the fault layer. README.md lists the variables.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace simvis::faults {

/// One entry of SIMVIS_FAULT.
struct Fault {
  std::string function;
  std::uint64_t call = 0;  ///< from 1
  bool lasting = false;    ///< later calls too
  VkResult result = VK_SUCCESS;
  std::chrono::milliseconds delay{};  ///< of a slow call, whose result is the driver's
};

struct Limit {
  std::string name;  ///< a member of VkPhysicalDeviceLimits
  double value = 0;
};

/// A memory type that the program sees in place of the driver's.
struct MemoryType {
  VkMemoryPropertyFlags flags = 0;
  std::uint32_t heap = 0;
};

struct Settings {
  std::vector<Fault> faults;            ///< SIMVIS_FAULT
  std::vector<Limit> limits;            ///< SIMVIS_FAULT_LIMITS
  std::vector<MemoryType> types;        ///< SIMVIS_FAULT_MEMORY_TYPES; empty: those of the driver
  std::vector<VkDeviceSize> heap_size;  ///< SIMVIS_FAULT_HEAPS, in bytes; empty: those of the driver
  std::string report;                   ///< SIMVIS_FAULT_REPORT, a file; empty: none
};

/// Reads the environment. A value that cannot be understood ends the program with a message: a test that made no call
/// fail would test nothing.
Settings read_settings();

/// The name of a result in the tables; "VkResult" for others.
const char* name_of(VkResult result);

}  // namespace simvis::faults
