#include "engine/base/input_log.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <string_view>

#include "engine/base/assert.h"
#include "engine/base/recorded_variables.h"

namespace simvis {

namespace {

constexpr const char* kRecordedVariables[] = {
    "ROS_PACKAGE_PATH",     "AMENT_PREFIX_PATH",        "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH",
    "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH"};

thread_local InputLog* innermost_log = nullptr;

}  // namespace

InputLog::InputLog() : outer_(innermost_log) { innermost_log = this; }

InputLog::~InputLog() { innermost_log = outer_; }

void note_input(const std::filesystem::path& file) {
  for (InputLog* log = innermost_log; log != nullptr; log = log->outer_) log->files_.insert(file);
}

std::span<const char* const> recorded_variables() { return kRecordedVariables; }

const char* noted_variable(const char* name) {
  SIMVIS_ASSERT(std::ranges::find(kRecordedVariables, std::string_view(name)) != std::end(kRecordedVariables));
  const char* const value = std::getenv(name);
  for (InputLog* log = innermost_log; log != nullptr; log = log->outer_) {
    log->environment_[name] = value == nullptr ? std::nullopt : std::optional<std::string>(value);
  }
  return value;
}

}  // namespace simvis
