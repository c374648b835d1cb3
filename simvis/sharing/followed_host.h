// The host that a follower shows, wherever it runs: where its log, its values and its measurements come from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/measurement.h>

namespace simvis {

/// Threads  one at a time.
/// Errors   MachineError: the host cannot be reached.
class FollowedHost {
 public:
  virtual ~FollowedHost() = default;

  /// Looks for the host, a new one after the last one has ended, for so long. Returns whether it is found.
  virtual bool connect(int timeout_ms) = 0;
  /// What is said when it is not found at once.
  virtual std::string missing() const = 0;

  enum class Waited : std::uint8_t { frame, time_over, host_ended };
  /// Waits until the host has finished more than `frames` frames, for so long.
  virtual Waited wait(std::uint64_t frames, int timeout_ms) = 0;

  struct Frame {
    std::uint64_t frames = 0;      ///< how many were finished; 0: none, or the host was killed while it wrote
    std::uint64_t next_frame = 0;  ///< the index behind that of the last
    std::int64_t time_ns = 0;      ///< simulated
  };
  /// The last finished frame, and the values of all parameters.
  virtual Frame read(std::vector<double>& values) = 0;

  struct Change {
    std::uint64_t frame = 0;  ///< the first that is made with it
    std::string_view xml;     ///< valid until the next call
  };
  /// The next command of the log from `position` on, which begins at 0; empty: there is none yet.
  virtual std::optional<Change> next_change(std::uint64_t& position) = 0;

  /// Asks for a value. `name` is that of the parameter.
  virtual void set(std::size_t parameter, const std::string& name, double value) = 0;
  /// Asks for the execution of commands. Throws InputError if none are taken now.
  virtual void request(const std::string& xml) = 0;

  struct HostMeasurement {
    std::uint64_t number = 0;  ///< another one for each measurement, and never 0
    Measurement measurement;   ///< without what only the sensor's type says: see Follower
  };
  /// The last measurement of a sensor, unless its number is `known`; empty: there is none, or the host has begun to
  /// write over it.
  virtual std::optional<HostMeasurement> measurement(const std::string& sensor, std::uint64_t known) = 0;
};

}  // namespace simvis
