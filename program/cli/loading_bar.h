// A progress bar on the terminal for loading a scene.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <ostream>
#include <thread>

#include <simvis/progress.h>

namespace simvis {

/// The bar appears after `patience` and is painted a few times per second by its own thread, independent of how often
/// progress is reported. It clears its line at the end. If `on` is false, it writes nothing.
class LoadingBar {
 public:
  LoadingBar(std::ostream& out, bool on, std::chrono::milliseconds patience = std::chrono::seconds(1));
  ~LoadingBar();
  LoadingBar(const LoadingBar&) = delete;
  LoadingBar& operator=(const LoadingBar&) = delete;

  void update(const Progress& progress);

  /// Call it before other code writes a line to the terminal.
  void clear_line();

 private:
  void paint();
  void wait_and_paint(std::chrono::milliseconds patience);
  void clear_shown();

  std::ostream& out_;
  std::mutex mutex_;  // protects out_ and all members below
  std::condition_variable ended_;
  Progress progress_;
  bool has_ended_ = false, shown_ = false;
  std::thread painter_;
};

}  // namespace simvis
