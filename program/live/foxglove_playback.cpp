#include "program/live/foxglove_playback.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"

namespace simvis::live {
namespace {

constexpr char kPlaybackState = 5;  // kind of the server's binary message
constexpr std::int64_t kSecondInNs = 1'000'000'000;

}  // namespace

nlohmann::json playback_time(std::int64_t time_ns) {
  return {{"sec", time_ns / kSecondInNs}, {"nsec", time_ns % kSecondInNs}};
}

// The kind, u8 command, f32 speed, u8 whether there is a time, u64 time in ns, u32 size of the id, the id.
PlaybackRequest read_playback_request(std::string_view message) {
  constexpr std::size_t kSpeed = 2, kHasTime = 6, kTime = 7, kIdSize = 15, kId = 19;
  constexpr std::size_t kMaxIdSize = 256;
  constexpr std::uint64_t kMaxTime = std::numeric_limits<std::int64_t>::max();
  if (message.size() < kId) throw InputError("this is no request of playback control");
  const auto size = binary_at<std::uint32_t>(message, kIdSize);
  if (size > message.size() - kId) throw InputError("this is no request of playback control");
  if (size > kMaxIdSize) throw InputError("the id of the request is too long");
  const auto command = binary_at<std::uint8_t>(message, 1);
  if (command > 1) {
    throw InputError("playback command " + std::to_string(command) + " is not known, expected 0 (play) or 1 (pause)");
  }
  const auto speed = binary_at<float>(message, kSpeed);
  if (!std::isfinite(speed) || speed <= 0) {
    throw InputError("the speed of playback is " + std::to_string(speed) + ", expected a number above 0");
  }
  PlaybackRequest request{.play = command == 0, .speed = speed, .id = std::string(message.substr(kId, size))};
  if (message[kHasTime] == 0) return request;
  const auto time = binary_at<std::uint64_t>(message, kTime);
  if (time > kMaxTime) throw InputError("the time of playback lies beyond the clock's 292 years");
  request.seek_ns = static_cast<std::int64_t>(time);
  return request;
}

std::string playback_message(const PlaybackState& state) {
  std::string bytes{kPlaybackState};
  append_binary(bytes, static_cast<std::uint8_t>(state.status));
  append_binary(bytes, static_cast<std::uint64_t>(state.time_ns));
  append_binary(bytes, static_cast<float>(state.speed));
  append_binary(bytes, static_cast<std::uint8_t>(state.did_seek));
  append_binary(bytes, static_cast<std::uint32_t>(state.request.size()));
  return bytes + state.request;
}

}  // namespace simvis::live
