// Whether a run makes its next frame, and how fast its frames come. The program asks before each frame; the page,
// Foxglove and the services of ROS 2 change it.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

namespace simvis {

/// A run plays at first. While it is paused, it makes only the frames that steps or a seek still need.
///
/// Threads  one thread at a time: that of the simulation.
class RunControl {
 public:
  /// `speed`: simulated seconds for each second of the wall clock; 0: as fast as possible.
  explicit RunControl(double speed) : speed_(speed) {}

  bool is_playing() const { return playing_; }
  bool makes_frame() const { return playing_ || steps_ > 0 || seek_ns_; }
  std::uint64_t steps() const { return steps_; }  ///< still to be made while it is paused
  /// The run makes its frames as fast as possible up to this time; empty: it does not seek.
  std::optional<std::int64_t> seek_ns() const { return seek_ns_; }
  double speed() const { return speed_; }                ///< without a seek
  double pace() const { return seek_ns_ ? 0 : speed_; }  ///< of the next frame
  std::uint64_t restarts() const { return restarts_; }   ///< a new number: the wall clock of the frames begins anew
  bool is_changed() const { return changed_; }           ///< see note_change()

  /// Ends steps and a seek, as pause() does.
  void play() {
    if (!playing_) ++restarts_;
    end_seek();
    playing_ = true;
    steps_ = 0;
  }
  void pause() {
    end_seek();
    playing_ = false;
    steps_ = 0;
  }
  /// A paused run makes so many frames more.
  void step(std::uint64_t count) {
    if (!makes_frame()) ++restarts_;
    steps_ = count > std::numeric_limits<std::uint64_t>::max() - steps_ ? std::numeric_limits<std::uint64_t>::max()
                                                                        : steps_ + count;
  }
  void seek(std::int64_t time_ns) {
    seek_ns_ = time_ns;
    ++restarts_;
  }
  void end_seek() {
    if (!seek_ns_) return;
    seek_ns_.reset();
    ++restarts_;
  }
  void set_speed(double speed) {
    speed_ = speed;
    restart_clock();
  }
  void restart_clock() { ++restarts_; }

  /// Counts a frame that is to be made.
  void begin_frame() {
    if (!playing_ && !seek_ns_ && steps_ > 0) --steps_;
  }
  /// A client has changed the scene, so that an error of a step may be its own.
  void note_change() { changed_ = true; }

 private:
  bool playing_ = true, changed_ = false;
  std::uint64_t steps_ = 0, restarts_ = 0;
  std::optional<std::int64_t> seek_ns_;
  double speed_;
};

}  // namespace simvis
