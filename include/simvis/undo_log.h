// A log of undo steps, which reverts the changes of a command to the scene if a later step of the command fails.
#pragma once

#include <functional>
#include <vector>

namespace simvis {

/// The undo steps of a command. An undo step must not throw.
class UndoLog {
 public:
  /// Adds the step that reverts a change just made. What it captures must live until roll_back() or commit().
  void add(std::function<void()> undo) { steps_.push_back(std::move(undo)); }

  /// Runs all undo steps, the last one first, and clears the log.
  void roll_back() {
    while (!steps_.empty()) {
      const std::function<void()> undo = std::move(steps_.back());
      steps_.pop_back();
      undo();
    }
  }

  /// Clears the log: the command succeeded, and its changes stay.
  void commit() { steps_.clear(); }

 private:
  std::vector<std::function<void()>> steps_;
};

}  // namespace simvis
