#include "tests/fault_layer/call_counts.h"

namespace simvis::faults {

CallCounts::Outcome CallCounts::next(std::size_t command) {
  const std::uint64_t call = ++counts_[command];
  Outcome outcome;
  for (const Fault& fault : faults_) {
    const bool meant = call == fault.call || (fault.lasting && call > fault.call);
    if (!meant || fault.function != kCommands[command].name) continue;
    outcome.delay += fault.delay;
    if (fault.result == VK_SUCCESS || outcome.result) continue;
    outcome.result = fault.result;
    ++failed_;
    if (fault.result == VK_ERROR_DEVICE_LOST) lost_ = true;
  }
  const bool may_be_lost = kCommands[command].results.find("VK_ERROR_DEVICE_LOST") != std::string_view::npos;
  if (!outcome.result && lost_ && may_be_lost) outcome.result = VK_ERROR_DEVICE_LOST;
  return outcome;
}

}  // namespace simvis::faults
