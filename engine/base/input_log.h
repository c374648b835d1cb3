// Records which files are read, so that a run can say what it depends on.
#pragma once

#include <filesystem>
#include <set>

namespace simvis {

/// While it lives, it collects the files that note_input() reports in the thread that made it. Logs of one thread are
/// nested; each collects what the inner ones collect.
class InputLog {
 public:
  InputLog();
  ~InputLog();
  InputLog(const InputLog&) = delete;
  InputLog& operator=(const InputLog&) = delete;

  /// The names with which the files were opened.
  const std::set<std::filesystem::path>& files() const { return files_; }

 private:
  friend void note_input(const std::filesystem::path& file);
  InputLog* outer_;
  std::set<std::filesystem::path> files_;
};

/// Reports that the content of a file is read. Without a log it does nothing.
void note_input(const std::filesystem::path& file);

}  // namespace simvis
