// Foxglove's playback control, binary messages of the protocol `foxglove.sdk.v1`: a client asks a run that has an end
// to play, to pause or to go to a later time, and all clients get the state of the run.
//
// Source: https://github.com/foxglove/foxglove-sdk,
// rust/foxglove/src/protocol/common/client/playback_control_request.rs and
// rust/foxglove/src/protocol/common/server/playback_state.rs; the opcodes are those of protocol/v1.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "program/live/control.h"

namespace simvis::live {

inline constexpr char kPlaybackRequest = 3;  ///< kind of a client's binary message

/// The simulated times of the first and the last frame of a run.
struct PlaybackRange {
  std::int64_t start_ns = 0, end_ns = 0;
};

struct PlaybackState {
  enum class Status : std::uint8_t { playing = 0, paused = 1, buffering = 2, ended = 3 };
  Status status = Status::paused;  ///< buffering: frames are made as fast as possible, up to the time of a request
  std::int64_t time_ns = 0;        ///< of the last frame
  double speed = 0;                ///< simulated seconds for each second
  bool did_seek = false;           ///< the frame is that of the time that a client has asked for
  std::string request{};           ///< that it answers; empty: the state has changed for another reason
};

/// A time as serverInfo has it.
nlohmann::json playback_time(std::int64_t time_ns);

/// Throws InputError: the message is too short, the command is unknown, the speed is not a finite number above 0, the
/// time is beyond 292 years, or the id has more than 256 bytes.
PlaybackRequest read_playback_request(std::string_view message);

/// The binary message with the state.
std::string playback_message(const PlaybackState& state);

}  // namespace simvis::live
