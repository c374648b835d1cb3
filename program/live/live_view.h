// The live view of a running simulation: its server, the page's protocol and Foxglove's.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/simulation.h>
#include "program/live/control.h"
#include "program/live/foxglove.h"
#include "program/live/message_outlet.h"
#include "program/live/server.h"
#include "program/live/view_hub.h"

namespace simvis::live {

/// The last measurements of sensors that another process has measured with, by the name of the sensor.
using OtherMeasurements =
    std::function<std::optional<Measurement>(const std::string& sensor, std::span<const OutputSpec> outputs)>;

/// Threads  all functions are of the thread that steps the simulation; it never waits for the server.
class LiveView : private Service {
 public:
  /// `range` is that of a run that has an end, which Foxglove's clients then control. Throws as Server.
  explicit LiveView(const ServerDesc& desc, std::optional<PlaybackRange> range = {});
  ~LiveView() override;

  std::uint16_t port() const { return server_->port(); }

  /// From now on, the messages of this simulation go to Foxglove's clients, and its frames to pages. Throws InputError:
  /// two of its sensors would have the same topics.
  void attach(Simulation& simulation);
  /// Shows the frame of the last step. Returns false if the server is too busy for it, or no client has room for it:
  /// what was measured in it is then shown with a later frame, if nothing newer was.
  bool publish(Simulation& simulation, const FrameTime& time, double step_ms, const ViewTime& view_time,
               const OtherMeasurements& others = {});
  /// Shows that the simulation goes on or not.
  void publish(const ViewTime& view_time);
  /// Shows Foxglove's clients the values as they are.
  void publish(const Parameters& parameters);
  /// The state for Foxglove's clients, if they control the run.
  void publish(const PlaybackState& state);

  std::optional<Control> next_control(std::optional<std::chrono::steady_clock::time_point> until = {}) {
    return controls_.next(until);
  }
  void answer_set(const Control& request, std::vector<std::string> refusals, const Parameters& parameters);
  /// `refusal` is empty if the request was carried out.
  void answer(const Control& request, const std::string& refusal);
  void answer_saved(const Control& request, const std::string& xml);
  /// Lets a page pull at a body of physics, and answers why not.
  void pull(const Control& request, Simulation& simulation);
  /// Tells all clients of the page's protocol.
  void report(const std::string& about, const std::string& message);

 private:
  std::optional<Answer> get(std::string_view path, std::string_view query) override;
  std::span<const std::string_view> protocols() const override;
  std::unique_ptr<Peer> connect(std::string_view protocol) override;
  void want(ViewWants wants);
  ViewWants take_wants();

  const std::string nonce_ = random_token();  // of the page's inline scripts
  ControlQueue controls_;
  // Of the server's thread.
  FoxgloveHub foxglove_;
  ViewHub view_;
  ClientId next_client_ = 1;
  // Used by the simulation's thread only.
  LiveOutlet outlet_;
  ViewCopier copier_;
  std::vector<FoxgloveHub::Parameter> parameters_;  // as clients know them
  std::size_t changes_ = 0, inputs_changes_ = 0;    // of the scene, that `parameters_` and its commands' topics follow
  std::uint64_t known_arrivals_ = 0;                // of clients, which have `parameters_`
  std::int64_t plan_ns_ = 0;                        // when the last plan was copied
  // Of both.
  std::mutex mutex_;
  ViewWants wants_;
  std::atomic<int> frames_under_way_ = 0;
  std::atomic<std::uint64_t> arrivals_ = 0;  // of Foxglove's clients
  std::unique_ptr<Server> server_;           // the last member: its thread uses the others
};

}  // namespace simvis::live
