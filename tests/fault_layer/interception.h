// The functions of commands.inc and objects.inc as the program calls them: each counts its call, fails or waits if it
// is asked to, and else calls the next layer or the driver.
#pragma once

#include <vulkan/vulkan.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <thread>
#include <tuple>
#include <type_traits>

#include "tests/fault_layer/scopes.h"

namespace simvis::faults {

/// The type of the objects that a command makes; empty: none.
constexpr std::string_view made_by(std::string_view command) {
#define SIMVIS_OBJECT(type, maker, destroyer) \
  if (command == #maker) return #type;
#include "tests/fault_layer/objects.inc"
#undef SIMVIS_OBJECT
  return {};
}

template <typename T>
struct IsCount : std::bool_constant<std::is_same_v<T, std::uint32_t*> || std::is_same_v<T, std::size_t*>> {};

/// The last of some arguments.
template <typename... Arguments>
auto last_of(Arguments... arguments) {
  return std::get<sizeof...(Arguments) - 1>(std::tuple(arguments...));
}

/// Asks for less than there is, if the call asks for a list; the driver then returns VK_INCOMPLETE. Returns false if
/// the function has no list.
template <typename... Arguments>
bool ask_for_less(Arguments... arguments) {
  if constexpr (sizeof...(Arguments) >= 2) {
    using All = std::tuple<Arguments...>;
    if constexpr (IsCount<std::tuple_element_t<sizeof...(Arguments) - 2, All>>::value) {
      const All all(arguments...);
      const auto count = std::get<sizeof...(Arguments) - 2>(all);
      if (last_of(arguments...) != nullptr && *count > 0) --*count;
      return true;
    }
  }
  return false;
}

/// The number of objects that a call makes: pipelines come several at a time, as the second argument after the device
/// says.
template <typename... Arguments>
std::uint32_t made_count(Arguments... arguments) {
  if constexpr (sizeof...(Arguments) >= 2) {
    using Second = std::tuple_element_t<1, std::tuple<Arguments...>>;
    if constexpr (std::is_same_v<Second, std::uint32_t>) return std::get<1>(std::tuple(arguments...));
  }
  return 1;
}

template <std::size_t kIndex, typename Function>
struct Interception;

/// There is no scope yet: fault_layer.cpp has this function.
template <std::size_t kIndex>
struct Interception<kIndex, PFN_vkCreateInstance> {
  static constexpr PFN_vkCreateInstance call = nullptr;
};

template <std::size_t kIndex, typename First, typename... Arguments>
struct Interception<kIndex, VkResult(VKAPI_PTR*)(First, Arguments...)> {
  static VKAPI_ATTR VkResult VKAPI_CALL call(First first, Arguments... arguments) {
    const auto scope = scope_of(first);
    const CallCounts::Outcome outcome = scope->calls.next(kIndex);
    if (outcome.delay.count() > 0) std::this_thread::sleep_for(outcome.delay);
    const auto next = as<VkResult(VKAPI_PTR*)(First, Arguments...)>(scope->next[kIndex]);
    constexpr std::string_view kName = kCommands[kIndex].name;
    if (!outcome.result) return finished(*scope, next(first, arguments...), arguments...);
    if (*outcome.result == VK_INCOMPLETE && ask_for_less(arguments...)) return next(first, arguments...);
    // A driver that reports a loss before the device stops still waits for the work that it was given.
    if constexpr (kName == "vkDeviceWaitIdle" || kName == "vkQueueWaitIdle") next(first, arguments...);
    if constexpr (made_by(kName) == "VkPipeline") {
      std::fill_n(last_of(arguments...), made_count(arguments...), VkPipeline(VK_NULL_HANDLE));
    }
    return *outcome.result;
  }

 private:
  template <typename AnyScope>
  static VkResult finished(AnyScope& scope, VkResult result, Arguments... arguments) {
    constexpr std::string_view kMade = made_by(kCommands[kIndex].name);
    if constexpr (!kMade.empty()) {
      if (result != VK_SUCCESS) return result;
      const auto made = last_of(arguments...);
      for (std::uint32_t i = 0; i < made_count(arguments...); ++i) {
        scope.objects.add(kMade, reinterpret_cast<std::uint64_t>(made[i]));
      }
    }
    return result;
  }
};

}  // namespace simvis::faults
