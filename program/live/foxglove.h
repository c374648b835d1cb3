// Foxglove's WebSocket protocol: channels with the messages of a recording, parameters, change requests, services,
// time, and the connection graph: who publishes and subscribes to which topic.
//
// https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md; its names `foxglove.websocket.v1` and
// `foxglove.sdk.v1` mean the same here. Requests to change the scene are messages to the topic kExecuteTopic: of type
// std_msgs/msg/String in CDR, or JSON {"data": "XML"}. Commands of robots are messages in CDR to the topics of the
// elements that take them. Services pause the simulation and let it go on, see foxglove_services.h. Assets are the
// files of robots, see foxglove_assets.h. Of a run that has an end, playback control does so too, see
// foxglove_playback.h.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "exchange/messages/message_outlet.h"
#include "program/live/control.h"
#include "program/live/foxglove_assets.h"
#include "program/live/foxglove_playback.h"
#include "program/live/server.h"

namespace simvis::live {

inline constexpr std::string_view kFoxgloveProtocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
inline constexpr std::string_view kExecuteTopic = "/simvis/execute";

/// The topics that somebody listens to, for the simulation's thread.
class WantedTopics {
 public:
  void set(std::set<std::string> topics);
  bool contains(const std::string& topic) const;

 private:
  mutable std::mutex mutex_;
  std::set<std::string> topics_;
};

/// What the hub asks of each client; FoxglovePeer is one.
class FoxgloveClient {
 public:
  virtual ~FoxgloveClient() = default;

  virtual void advertise(std::span<const std::size_t> channels) = 0;
  virtual void publish(std::size_t channel, std::int64_t time_ns, const std::shared_ptr<const std::string>& bytes) = 0;
  virtual void set_time(std::int64_t time_ns) = 0;
  /// These parameters have other values now.
  virtual void note_changes(const std::set<std::size_t>& parameters) = 0;
  /// The parameters are those of another scene now.
  virtual void forget_parameters() = 0;
  /// The hub has the parameters of the simulation: what the client has asked of them is carried out.
  virtual void carry_out_held() = 0;
  /// The values of these parameters, as the answer to `request`.
  virtual void send_values(const std::set<std::size_t>& parameters, const std::string& request) = 0;
  enum class Level : std::uint8_t { info = 0, warning = 1, error = 2 };
  virtual void send_status(Level level, const std::string& message) = 0;
  virtual void answer_call(const ServiceCall& call, const std::string& refusal) = 0;
  virtual void send_playback(const PlaybackState& state) = 0;
  /// The topics or services of the simulation have changed.
  virtual void note_graph() = 0;
  virtual void add_wanted(std::set<std::string>& topics) const = 0;
};

/// What all clients of this protocol share. Used by the server's thread only, except `wanted`, has_clients() and
/// offers_playback().
class FoxgloveHub {
 public:
  /// Clients control the playback of a run with a `range`; without one, the run has no end.
  FoxgloveHub(ControlQueue& controls, std::string session, std::optional<PlaybackRange> range = {});

  /// Any thread.
  bool has_clients() const { return has_clients_; }
  bool offers_playback() const { return range_.has_value(); }
  /// A client connects: unless there are others, requests about parameters wait for the next set_parameters().
  void await_parameters() { knows_parameters_ &= has_clients(); }

  void advertise(const ros::Topic& topic);
  /// A message for those who listen. That of a latched topic is also kept for those who come later.
  void publish(const ros::Topic& topic, std::int64_t time_ns, std::string_view bytes);
  void set_time(std::int64_t time_ns);

  struct Parameter {
    std::string name;  ///< "ELEMENT.PARAM"
    double value = 0;
    bool removed = false;
  };
  /// All parameters, by index. What differs goes to those who have subscribed to it.
  void set_parameters(std::vector<Parameter> parameters);
  /// The answer to a request to set values: what was refused, and the values as they are now.
  void answer_set(const Control& request, std::span<const std::string> refusals);
  void answer_execute(ClientId client, const std::string& refusal);
  void refuse(ClientId client, const std::string& refusal);
  /// The state of a run with a range, for all clients and for those that come later.
  void set_playback(const PlaybackState& state);
  /// The answer to a call of a service; `refusal` is empty if it was carried out.
  void answer_call(ClientId client, const ServiceCall& call, const std::string& refusal);
  /// The topics and types of commands that clients may send from now on.
  void set_command_inputs(std::vector<CommandInput> inputs);
  /// The files that clients may fetch from now on.
  void set_assets(AssetFiles files) { assets_ = std::move(files); }

  WantedTopics wanted;

 private:
  friend class FoxglovePeer;
  struct Channel {
    ros::Topic topic;
    std::shared_ptr<const std::string> kept;  // of a latched topic
    std::int64_t kept_ns = 0;
  };
  void follow_subscriptions();
  std::optional<std::size_t> find_parameter(std::string_view name) const;

  ControlQueue& controls_;
  std::string session_;
  std::optional<PlaybackRange> range_;
  std::optional<PlaybackState> playback_;  // as clients get it that come later
  std::vector<CommandInput> command_inputs_;
  AssetFiles assets_;
  std::vector<Channel> channels_;  // the id is the index + 1
  std::map<std::string, std::size_t, std::less<>> channel_of_topic_;
  std::vector<Parameter> parameters_;
  bool knows_parameters_ = true;
  std::atomic<bool> has_clients_ = false;
  std::map<std::string, std::size_t, std::less<>> parameter_of_name_;
  std::map<ClientId, FoxgloveClient*> peers_;
};

}  // namespace simvis::live
