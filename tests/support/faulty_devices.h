// Devices whose calls fail: tests/fault_layer between this process and the driver.
#pragma once

#include <dlfcn.h>
#include <stdlib.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/support/tested_build.h"

namespace simvis {

inline const std::string kFaultLayers = tested_build() + "/fault_layer";
inline constexpr const char* kFaultLayer = "VK_LAYER_SIMVIS_faults";

/// What may fail: the rows of tests/fault_layer/commands.inc.
struct FaultyCommand {
  std::string name, results;  ///< results: separated by ", "
};
inline std::vector<FaultyCommand> faulty_commands() {
  return {
#define SIMVIS_COMMAND(name, ...) {#name, #__VA_ARGS__},
#include "tests/fault_layer/commands.inc"
#undef SIMVIS_COMMAND
  };
}

/// The environment of devices that fail. Those that were opened before keep theirs.
class FaultyDevices {
 public:
  FaultyDevices() {
    ::setenv("VK_ADD_LAYER_PATH", kFaultLayers.c_str(), 1);
    ::setenv("VK_INSTANCE_LAYERS", kFaultLayer, 1);
  }
  ~FaultyDevices() {
    none();
    for (const char* name : {"VK_ADD_LAYER_PATH", "VK_INSTANCE_LAYERS"}) ::unsetenv(name);
  }
  FaultyDevices(const FaultyDevices&) = delete;
  FaultyDevices& operator=(const FaultyDevices&) = delete;

  /// Devices that are opened from now on have this fault, and simulations this limit.
  void fault(const std::string& text, const char* limit_s) const {
    ::setenv("SIMVIS_FAULT", text.c_str(), 1);
    ::setenv("SIMVIS_MAX_WAIT_S", limit_s, 1);
  }
  /// Devices that are opened from now on have this setting of the fault layer.
  void set(const char* variable, const std::string& value) const { ::setenv(variable, value.c_str(), 1); }
  /// Devices that are opened from now on work.
  void none() const {
    for (const char* name : {"SIMVIS_FAULT", "SIMVIS_FAULT_LIMITS", "SIMVIS_FAULT_MEMORY_TYPES", "SIMVIS_FAULT_HEAPS",
                             "SIMVIS_MAX_WAIT_S"}) {
      ::unsetenv(name);
    }
  }

  /// The number of devices that are open.
  std::size_t open() const { return layer<std::size_t>("simvis_faults_devices"); }

  // What has happened to the instances and devices that have ended since forget().
  void forget() const { layer<void>("simvis_faults_forget"); }
  /// Calls of a command of faulty_commands(), by index.
  std::uint64_t calls(std::size_t command) const { return layer<std::uint64_t>("simvis_faults_calls", command); }
  std::uint64_t failed() const { return layer<std::uint64_t>("simvis_faults_failed"); }
  /// Objects that existed when their device ended.
  std::uint64_t left() const { return layer<std::uint64_t>("simvis_faults_left"); }
  /// Objects that were destroyed and did not exist.
  std::uint64_t unknown() const { return layer<std::uint64_t>("simvis_faults_unknown"); }

 private:
  /// Calls a function of the layer; returns 0 if the layer is not loaded.
  template <typename Result, typename... Arguments>
  static Result layer(const char* function, Arguments... arguments) {
    void* const library = ::dlopen((kFaultLayers + "/libsimvis_fault_layer.so").c_str(), RTLD_NOW | RTLD_NOLOAD);
    if (library == nullptr) return Result();
    const auto call = reinterpret_cast<Result (*)(Arguments...)>(::dlsym(library, function));
    if constexpr (std::is_void_v<Result>) {
      call(arguments...);
      ::dlclose(library);
    } else {
      const Result result = call(arguments...);
      ::dlclose(library);
      return result;
    }
  }
};

}  // namespace simvis
