#include "tests/fault_layer/settings.h"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace simvis::faults {
namespace {

constexpr std::pair<std::string_view, VkResult> kResults[] = {
#define SIMVIS_RESULT(result) {#result, result},
#include "tests/fault_layer/results.inc"
#undef SIMVIS_RESULT
};

[[noreturn]] void refuse(const char* variable, std::string_view entry, const char* expected) {
  std::fprintf(stderr, "VK_LAYER_SIMVIS_faults: %s: \"%.*s\": expected %s\n", variable, static_cast<int>(entry.size()),
               entry.data(), expected);
  std::abort();
}

/// Calls `read` with each entry of the variable; commas separate them.
template <typename Read>
void each_entry(const char* variable, const Read& read) {
  const char* const text = std::getenv(variable);
  if (text == nullptr) return;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    read(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
}

/// Reads a number at the beginning of `text` and removes it. Returns false if there is none.
template <typename Number>
bool take_number(std::string_view& text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool read_outcome(std::string_view text, Fault& fault) {
  for (const auto& [name, result] : kResults) {
    if (text != name) continue;
    fault.result = result;
    return true;
  }
  std::uint32_t milliseconds = 0;
  if (!take_number(text, milliseconds) || text != "ms" || milliseconds == 0) return false;
  fault.delay = std::chrono::milliseconds(milliseconds);
  return true;
}

Fault read_fault(std::string_view entry) {
  const std::size_t first = entry.find(':'), second = entry.find(':', first + 1);
  Fault fault;
  if (second != std::string_view::npos) {
    fault.function = entry.substr(0, first);
    std::string_view call = entry.substr(first + 1, second - first - 1);
    const bool counted = take_number(call, fault.call) && fault.call > 0;
    fault.lasting = call == "+";
    if (counted && (call.empty() || fault.lasting) && read_outcome(entry.substr(second + 1), fault)) return fault;
  }
  refuse("SIMVIS_FAULT", entry, "FUNCTION:CALL:RESULT or FUNCTION:CALL:MILLISECONDSms, with CALL from 1 or CALL+");
}

Limit read_limit(std::string_view entry) {
  const std::size_t equals = entry.find('=');
  if (equals != std::string_view::npos) {
    Limit limit{.name = std::string(entry.substr(0, equals))};
    std::string_view number = entry.substr(equals + 1);
    if (take_number(number, limit.value) && number.empty()) return limit;
  }
  refuse("SIMVIS_FAULT_LIMITS", entry, "NAME=NUMBER");
}

MemoryType read_type(std::string_view entry) {
  MemoryType type;
  std::string_view rest = entry;
  for (; !rest.empty() && rest[0] != '@'; rest.remove_prefix(1)) {
    switch (rest[0]) {
      case 'L':
        type.flags |= VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
        break;
      case 'V':
        type.flags |= VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
        break;
      case 'C':
        type.flags |= VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        break;
      case 'K':
        type.flags |= VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
        break;
      default:
        refuse("SIMVIS_FAULT_MEMORY_TYPES", entry, "letters of LVCK, then @HEAP");
    }
  }
  if (!rest.empty()) rest.remove_prefix(1);
  if (!take_number(rest, type.heap) || !rest.empty() || type.heap >= VK_MAX_MEMORY_HEAPS) {
    refuse("SIMVIS_FAULT_MEMORY_TYPES", entry, "letters of LVCK, then @HEAP");
  }
  return type;
}

VkDeviceSize read_heap(std::string_view entry) {
  std::string_view rest = entry;
  VkDeviceSize mebibytes = 0;
  if (!take_number(rest, mebibytes) || rest != "M" || mebibytes == 0) {
    refuse("SIMVIS_FAULT_HEAPS", entry, "MEBIBYTES and M, such as 64M");
  }
  return mebibytes << 20;
}

}  // namespace

Settings read_settings() {
  Settings settings;
  each_entry("SIMVIS_FAULT", [&](std::string_view entry) { settings.faults.push_back(read_fault(entry)); });
  each_entry("SIMVIS_FAULT_LIMITS", [&](std::string_view entry) { settings.limits.push_back(read_limit(entry)); });
  each_entry("SIMVIS_FAULT_MEMORY_TYPES", [&](std::string_view entry) { settings.types.push_back(read_type(entry)); });
  each_entry("SIMVIS_FAULT_HEAPS", [&](std::string_view entry) { settings.heap_size.push_back(read_heap(entry)); });
  for (const MemoryType& type : settings.types) {
    if (type.heap < settings.heap_size.size()) continue;
    refuse("SIMVIS_FAULT_MEMORY_TYPES", std::to_string(type.heap), "a heap of SIMVIS_FAULT_HEAPS, counted from 0");
  }
  if (const char* const report = std::getenv("SIMVIS_FAULT_REPORT")) settings.report = report;
  return settings;
}

const char* name_of(VkResult result) {
  for (const auto& [name, known] : kResults) {
    if (known == result) return name.data();
  }
  return "VkResult";
}

}  // namespace simvis::faults
