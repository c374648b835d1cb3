#include "engine/base/input_log.h"

#include <cstdlib>

namespace simvis {

namespace {

thread_local InputLog* innermost_log = nullptr;

}  // namespace

InputLog::InputLog() : outer_(innermost_log) { innermost_log = this; }

InputLog::~InputLog() { innermost_log = outer_; }

void note_input(const std::filesystem::path& file) {
  for (InputLog* log = innermost_log; log != nullptr; log = log->outer_) log->files_.insert(file);
}

const char* noted_variable(const char* name) {
  const char* const value = std::getenv(name);
  for (InputLog* log = innermost_log; log != nullptr; log = log->outer_) {
    log->environment_[name] = value == nullptr ? std::nullopt : std::optional<std::string>(value);
  }
  return value;
}

}  // namespace simvis
