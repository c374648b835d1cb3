// The C client for C++: the same calls, with exceptions instead of codes and memory that frees itself.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <simvis_client/client.h>

namespace simvis::client {

/// Why a call failed.
class Error : public std::runtime_error {
 public:
  Error() : std::runtime_error(simvis_client_error()) {}
};

/// An entry of the log.
struct LogEntry {
  simvis_log_kind kind;   ///< what it says
  std::uint32_t client;   ///< slot of the client
  std::uint64_t request,  ///< number of the request; 0: none
      frame;              ///< first frame that is made with it
  std::string_view text;  ///< as its kind says
};

/// A measurement in shared memory. The host writes over it after three more measurements: whole() says whether it did.
class Measurement {
 public:
  /// From simvis_latest().
  explicit Measurement(simvis_view view) : view_(view) {}
  /// For calls of client.h.
  const simvis_view& view() const { return view_; }
  /// Frame, time and pose.
  const simvis_slot& slot() const { return *view_.slot; }
  /// Whether what was read so far was not written over.
  bool whole() const { return simvis_view_is_whole(&view_) == 1; }
  /// The numbers of an output; empty if it has none of this name and type. They lie within the slot, whatever the host
  /// writes.
  template <typename Number>
  std::span<const Number> output(std::string_view name) const {
    constexpr std::uint32_t kType = std::is_same_v<Number, float>           ? SIMVIS_FLOAT32
                                    : std::is_same_v<Number, double>        ? SIMVIS_FLOAT64
                                    : std::is_same_v<Number, std::uint8_t>  ? SIMVIS_UINT8
                                    : std::is_same_v<Number, std::uint32_t> ? SIMVIS_UINT32
                                                                            : SIMVIS_INT32;
    const char* const slot = reinterpret_cast<const char*>(view_.slot);
    for (std::uint32_t i = 0; simvis_output_at(&view_, i) != nullptr; ++i) {
      simvis_output copy{};
      if (simvis_copy_output(&view_, i, &copy) != 0) continue;
      if (std::string_view(slot + copy.name_offset, copy.name_size) != name) continue;
      if (copy.type != kType) return {};
      return {reinterpret_cast<const Number*>(slot + copy.offset),
              std::size_t{copy.rows} * copy.columns * copy.channels};
    }
    return {};
  }

 private:
  simvis_view view_;
};

/// A connection to a running simulation; see client.h for each call.
class Connection {
 public:
  /// Throws Error if there is no such simulation within the time.
  Connection(const std::string& simulation, const std::string& client, int timeout_ms = 0)
      : client_(simvis_connect(simulation.c_str(), client.c_str(), timeout_ms), &simvis_disconnect) {
    if (client_ == nullptr) throw Error();
  }

  /// For calls of client.h.
  simvis_client* get() const { return client_.get(); }
  /// Connects to the host that has the name now, which has other ids; see simvis_reconnect(). Throws Error if there is
  /// none in time, and stays as it was.
  void reconnect(int timeout_ms = -1) { check(simvis_reconnect(get(), timeout_ms)); }
  /// Whether the host lives.
  bool alive() const { return simvis_alive(get()) == 1; }

  /// The id of an element; this and the next two throw Error if there is none.
  std::int64_t element(const std::string& name) const { return found(simvis_find_element(get(), name.c_str())); }
  /// The id of a parameter.
  std::int64_t parameter(const std::string& element, const std::string& name) const {
    return found(simvis_find_parameter(get(), element.c_str(), name.c_str()));
  }
  /// The id of a sensor.
  std::int64_t sensor(const std::string& name) const { return found(simvis_find_sensor(get(), name.c_str())); }

  /// The value of a parameter as it stands.
  double value(std::int64_t parameter) const { return simvis_get(get(), parameter); }
  /// Sets it from the next frame on.
  void set(std::int64_t parameter, double value) { check(simvis_set(get(), parameter, value)); }
  /// Sets all parameters of an element at once.
  void set_element(std::int64_t element, std::span<const double> values) {
    check(simvis_set_element(get(), element, values.data(), values.size()));
  }

  /// Returns the request's number.
  std::uint64_t send(const std::string& xml) {
    const std::uint64_t number = simvis_send(get(), xml.c_str());
    if (number == 0) throw Error();
    return number;
  }
  /// The next entry of the log from `position` on, which begins at 0; empty: there is none yet.
  std::optional<LogEntry> next_log(std::uint64_t& position) const {
    const char* text = nullptr;
    const std::uint64_t start = position;
    const simvis_log_entry* const entry = simvis_next_log(get(), &position, &text);
    if (entry == nullptr) return {};
    const std::uint64_t room = position - start - sizeof *entry;  // the host may write over text_size
    return LogEntry{static_cast<simvis_log_kind>(entry->kind),
                    entry->client,
                    entry->request,
                    entry->frame,
                    {text, std::min<std::uint64_t>(entry->text_size, room)}};
  }

  /// The latest measurement; empty before the first.
  std::optional<Measurement> latest(std::int64_t sensor) const {
    simvis_view view{};
    if (simvis_latest(get(), sensor, &view) != 0) return {};
    return Measurement(view);
  }

  /// The number of frames that the host has finished.
  std::uint64_t frame() const { return simvis_frame(get()); }
  /// Waits until more than `frames` frames are finished. Returns false if the time is over; throws Error if the host is
  /// gone.
  bool wait_frame(std::uint64_t frames, int timeout_ms = -1) const {
    const int result = simvis_wait_frame(get(), frames, timeout_ms);
    check(result);
    return result == 1;
  }
  /// Lock-step: the host may make its next frame.
  void ready() { check(simvis_ready(get())); }

 private:
  static std::int64_t found(std::int64_t id) {
    if (id < 0) throw Error();
    return id;
  }
  static void check(int result) {
    if (result < 0) throw Error();
  }
  std::unique_ptr<simvis_client, decltype(&simvis_disconnect)> client_;
};

}  // namespace simvis::client
