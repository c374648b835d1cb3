// How to take back what a command did to the scene, if a later step of it goes wrong.
#pragma once

#include <functional>
#include <vector>

namespace simvis {

class UndoLog {
 public:
  void add(std::function<void()> undo) { steps_.push_back(std::move(undo)); }

  /// Takes everything back, the last step first.
  void roll_back() {
    while (!steps_.empty()) {
      const std::function<void()> undo = std::move(steps_.back());
      steps_.pop_back();
      undo();
    }
  }

  /// Everything went well: nothing is taken back any more.
  void commit() { steps_.clear(); }

 private:
  std::vector<std::function<void()>> steps_;
};

}  // namespace simvis
