// What has happened to all instances and devices that have ended: for tests in the same process, and for the report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "tests/fault_layer/scopes.h"

namespace simvis::faults {

/// An instance or device ends. Adds its numbers, and appends them to the file that SIMVIS_FAULT_REPORT names:
///
///   calls FUNCTION COUNT     each function of commands.inc that was called
///   failed COUNT             calls of which SIMVIS_FAULT decided the result
///   left TYPE COUNT          objects that exist still
///   unknown TYPE COUNT       objects that were destroyed and did not exist
void record_end(const Scope& scope);
void record_end(const DeviceScope& scope);

/// vkCreateInstance is called before there is a scope. Its calls are counted while SIMVIS_FAULT has the same text.
CallCounts::Outcome next_instance_call(const Settings& settings);

struct History {
  std::uint64_t calls[kCommandCount] = {};
  std::uint64_t failed = 0, left = 0, unknown = 0;
};
History history();
void forget_history();

}  // namespace simvis::faults
