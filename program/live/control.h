// What clients ask of the simulation, on its way from the server's thread to the simulation's.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "elements/sensed_physics.h"
#include "simvis/ros/command_inputs.h"

namespace simvis::live {

using ClientId = std::uint64_t;

/// A call of a service by Foxglove's protocol; the answer repeats all three.
struct ServiceCall {
  std::uint32_t service = 0;  ///< its place in kFoxgloveServices, from 1
  std::uint32_t id = 0;       ///< number of the call, chosen by the client
  std::string encoding{};     ///< of request and answer
};

/// What a client of Foxglove's playback control asks for.
struct PlaybackRequest {
  bool play = false;                      ///< otherwise the run pauses
  double speed = 1;                       ///< simulated seconds for each second, above 0
  std::optional<std::int64_t> seek_ns{};  ///< simulated time of the frame that is made first
  std::string id{};                       ///< the state that answers repeats it
};

struct Control {
  enum class Kind : std::uint8_t { look, set, play, pause, step, speed, execute, save, command, pull, playback };
  Kind kind = Kind::look;  ///< look: nothing but that somebody looks at something else now
  ClientId client = 0;
  std::vector<std::pair<std::size_t, double>> values{};  ///< set: parameters by index
  double factor = 0;                                     ///< speed: 0: as fast as possible
  std::string text{};                                    ///< execute: commands; command: a message in CDR
  std::optional<CommandInput> input{};                   ///< command: its topic and type
  std::optional<BodyPull> pull{};                        ///< pull: at a body of physics; empty: the pull ends
  std::string request{};                                 ///< how the client calls it; empty: it wants no answer
  std::optional<ServiceCall> call{};                     ///< the call that asks for it; empty: a message does
  std::optional<PlaybackRequest> playback{};             ///< playback
};

/// Threads  any.
class ControlQueue {
 public:
  /// Most that waits. A slider that is moved takes one place: a request that only sets the values that the last
  /// one sets takes that one's place.
  static constexpr std::size_t kMaxWaiting = 4096, kMaxBytes = std::size_t{16} << 20;

  /// Returns false if there is no room.
  bool add(Control control);
  /// The next request. Waits until `until` if there is none; without `until` it does not wait.
  std::optional<Control> next(std::optional<std::chrono::steady_clock::time_point> until = {});

 private:
  bool replaces_last(const Control& control) const;

  std::mutex mutex_;
  std::condition_variable added_;
  std::deque<Control> waiting_;
  std::size_t bytes_ = 0;
};

}  // namespace simvis::live
