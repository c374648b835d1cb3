// Records which files are read, so that a run can say what it depends on.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace simvis {

/// Environment variables with their values; none: the variable is not set.
using EnvironmentLog = std::map<std::string, std::optional<std::string>>;

/// While it lives, it collects the files and environment variables that are reported in the thread that made it. Logs
/// of one thread are nested; each collects what the inner ones collect.
class InputLog {
 public:
  InputLog();
  ~InputLog();
  InputLog(const InputLog&) = delete;
  InputLog& operator=(const InputLog&) = delete;

  /// The names with which the files were opened.
  const std::set<std::filesystem::path>& files() const { return files_; }

  const EnvironmentLog& environment() const { return environment_; }

 private:
  friend void note_input(const std::filesystem::path& file);
  friend const char* noted_variable(const char* name);
  InputLog* outer_;
  std::set<std::filesystem::path> files_;
  EnvironmentLog environment_;
};

/// Reports that the content of a file is read. Without a log it does nothing.
void note_input(const std::filesystem::path& file);

/// Returns the value of an environment variable, or null, and reports that it is read.
const char* noted_variable(const char* name);

}  // namespace simvis
