#include "tests/fault_layer/history.h"

#include <cstdlib>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>

namespace simvis::faults {
namespace {

std::mutex mutex;  // protects all of these
History all;
std::string instance_faults;
std::unique_ptr<CallCounts> instance_calls;

void add_calls(const CallCounts& calls, std::ostream& report) {
  for (std::size_t i = 0; i < kCommandCount; ++i) {
    if (calls.count(i) == 0) continue;
    all.calls[i] += calls.count(i);
    report << "calls " << kCommands[i].name << ' ' << calls.count(i) << '\n';
  }
  if (calls.failed() > 0) report << "failed " << calls.failed() << '\n';
  all.failed += calls.failed();
}

std::ofstream report_of(const Settings& settings) {
  std::ofstream report;
  if (!settings.report.empty()) report.open(settings.report, std::ios::app);
  return report;
}

}  // namespace

void record_end(const Scope& scope) {
  const std::lock_guard lock(mutex);
  std::ofstream report = report_of(scope.settings);
  add_calls(scope.calls, report);
}

void record_end(const DeviceScope& scope) {
  const std::lock_guard lock(mutex);
  std::ofstream report = report_of(scope.settings);
  add_calls(scope.calls, report);
  for (const auto& [type, count] : scope.objects.left()) {
    all.left += count;
    report << "left " << type << ' ' << count << '\n';
  }
  for (const auto& [type, count] : scope.objects.unknown()) {
    all.unknown += count;
    report << "unknown " << type << ' ' << count << '\n';
  }
}

CallCounts::Outcome next_instance_call(const Settings& settings) {
  const char* const text = std::getenv("SIMVIS_FAULT");
  const std::string faults = text == nullptr ? "" : text;
  const std::lock_guard lock(mutex);
  if (instance_calls == nullptr || faults != instance_faults) {
    instance_faults = faults;
    instance_calls = std::make_unique<CallCounts>(settings.faults);
  }
  const std::uint64_t before = instance_calls->failed();
  const CallCounts::Outcome outcome = instance_calls->next(index_of("vkCreateInstance"));
  ++all.calls[index_of("vkCreateInstance")];
  all.failed += instance_calls->failed() - before;
  return outcome;
}

History history() {
  const std::lock_guard lock(mutex);
  return all;
}

void forget_history() {
  const std::lock_guard lock(mutex);
  all = {};
}

}  // namespace simvis::faults
