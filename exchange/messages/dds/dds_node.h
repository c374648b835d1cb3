// A participant of a DDS domain: it writes messages as topics of ROS 2, and reads some. Needs Eclipse Cyclone DDS; a
// build without it has dds_absent.cpp, which says so.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/recorder_sink.h"

namespace simvis::ros {

/// What a subscriber of measurements gets when the network is slower than the simulation.
enum class SensorQos : std::uint8_t {
  best_effort,  ///< what arrives: ROS 2's profile for sensor data
  reliable      ///< the last messages, sent again where they were lost
};

/// Who can reach a participant.
struct DdsReach {
  std::uint32_t domain = 0;
  std::vector<std::string> interfaces{};  ///< network interfaces that Cyclone uses
  /// Whether all of these are loopback: the sockets then take nothing from other machines, and send nothing to them.
  bool is_local = false;
};

/// A domain that this process takes part in. Network interfaces, multicast and the like are the user's, through the
/// variables of discovery.h and CYCLONEDDS_URI, whose settings go before those.
///
/// Errors   InputError: this build has no DDS, or a variable has a wrong value. MachineError: the domain or a topic
///          cannot be had.
/// Threads  any.
class DdsNode {
 public:
  /// Empty: the domain of ROS_DOMAIN_ID, or else of CYCLONEDDS_URI, or else 0. Variables that limit discovery need the
  /// number in ROS_DOMAIN_ID or here, or else the domain is 0.
  explicit DdsNode(std::optional<std::uint32_t> domain);
  ~DdsNode();
  DdsNode(const DdsNode&) = delete;
  DdsNode& operator=(const DdsNode&) = delete;

  DdsReach reach() const;

  /// Writes messages of measurements as `qos` says, and all others reliably. A latched topic gives its last message to
  /// subscribers that come late, a log all of them.
  std::unique_ptr<RecorderSink> sink(SensorQos qos);

  /// Receives the messages of others on a topic, reliably, from now on, with those before that its durability keeps. At
  /// most kMaxWaiting of them wait for take(), the later ones, and of a log all; none is longer than `max_bytes`.
  static constexpr std::size_t kMaxWaiting = 1024, kMaxBytes = std::size_t{1} << 17;
  void subscribe(const std::string& topic, const TypeDescription& type, std::size_t max_bytes = kMaxBytes,
                 Durability durability = Durability::transient) {
    subscribe_as(topic, topic, type, max_bytes, durability);
  }
  /// As subscribe(), under a name of its own for take(): a topic may have subscriptions of several types.
  void subscribe_as(const std::string& name, const std::string& topic, const TypeDescription& type,
                    std::size_t max_bytes = kMaxBytes, Durability durability = Durability::transient);
  /// Ends the subscription of this name, which exists.
  void unsubscribe(const std::string& name);
  /// The first `max` of what has come since the last call, encapsulation included: bytes of strangers.
  std::vector<std::string> take(const std::string& topic, std::size_t max = kMaxWaiting);

  /// From now on the participant is the node of ROS 2 with this full name, such as "/simvis" or "/robot/simvis", which
  /// tools list with all that it sends and receives.
  void announce(const std::string& full_name);
  /// The full names of nodes of ROS 2 that other participants have announced since the last call, or before announce().
  std::vector<std::string> take_other_nodes();

  /// Receives requests of a service, such as "/simvis/get_parameters" of type "rcl_interfaces/srv/GetParameters".
  /// Messages have the header in front that rmw_cyclonedds gives them: RequestHeader.
  void serve(const std::string& service, const std::string& type);
  /// The first `max` of the requests that wait: bytes of strangers.
  std::vector<std::string> take_requests(const std::string& service, std::size_t max) {
    return take("rq" + service, max);
  }
  /// Answers a request; the header of `bytes` is that of the request. May wait for a client that does not take its
  /// replies, for 0.1 s; after that, replies of the service are lost without waiting for kReplyPause. Returns false if
  /// the reply is lost. One thread at a time.
  bool reply(const std::string& service, std::string_view bytes);
  static constexpr std::chrono::seconds kReplyPause{5};

  /// A message and its sender.
  struct Received {
    std::string bytes;
    std::uint64_t writer = 0;
  };
  std::vector<Received> take_with_writers(const std::string& topic, std::size_t max = kMaxWaiting);
  /// Whether a writer of a received message still takes part.
  bool has_writer(const std::string& topic, std::uint64_t writer) const;
  /// Waits until a message can be taken, or for so long.
  void wait(int timeout_ms) const;

 private:
  class Sink;
  struct Domain;
  struct Participant;
  std::shared_ptr<Participant> participant_;
};

}  // namespace simvis::ros
