// A temporary folder for generated scenes.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace simvis::bench {

/// An empty folder that is deleted with this object.
class SceneFolder {
 public:
  SceneFolder() : path_(std::filesystem::temp_directory_path() / ("simvis_bench_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~SceneFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace simvis::bench
