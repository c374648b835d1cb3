// Tells somebody who waits at a terminal how far the opening of a scene is.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <ostream>
#include <thread>

#include <simvis/progress.h>

namespace simvis {

/// Shows itself once the work has taken longer than `patience`, a few times a second, however seldom the work reports:
/// a thread of its own paints it. Clears its line when it ends. Off, it writes nothing at all.
class LoadingBar {
 public:
  LoadingBar(std::ostream& out, bool on, std::chrono::milliseconds patience = std::chrono::seconds(1));
  ~LoadingBar();
  LoadingBar(const LoadingBar&) = delete;
  LoadingBar& operator=(const LoadingBar&) = delete;

  void update(const Progress& progress);

  /// Before anybody else writes a line to the terminal.
  void clear_line();

 private:
  void paint();
  void wait_and_paint(std::chrono::milliseconds patience);
  void clear_shown();

  std::ostream& out_;
  std::mutex mutex_;  // of all below, and of out_
  std::condition_variable ended_;
  Progress progress_;
  bool has_ended_ = false, shown_ = false;
  std::thread painter_;
};

}  // namespace simvis
