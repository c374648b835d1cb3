// One client of Foxglove's protocol.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "program/live/foxglove.h"
#include "program/live/text_queue.h"

namespace simvis::live {

class FoxglovePeer : public Peer, public FoxgloveClient {
 public:
  FoxglovePeer(FoxgloveHub& hub, ClientId id);
  ~FoxglovePeer() override;

  void receive(std::string_view message, bool binary) override;
  std::optional<WireMessage> next() override;

  void advertise(std::span<const std::size_t> channels) override;
  void publish(std::size_t channel, std::int64_t time_ns, const std::shared_ptr<const std::string>& bytes) override;
  void set_time(std::int64_t time_ns) override { time_ns_ = time_ns; }
  void note_changes(const std::set<std::size_t>& parameters) override;
  void forget_parameters() override;
  void carry_out_held() override;
  void send_values(const std::set<std::size_t>& parameters, const std::string& request) override;
  void send_status(Level level, const std::string& message) override;
  void answer_call(const ServiceCall& call, const std::string& refusal) override;
  void send_playback(const PlaybackState& state) override;
  void note_graph() override { graph_changed_ = watches_graph_; }
  void add_wanted(std::set<std::string>& topics) const override;

 private:
  using Json = nlohmann::json;
  struct Waiting {
    std::uint64_t order;
    std::int64_t time_ns;
    std::shared_ptr<const std::string> bytes;
  };
  struct Subscription {
    std::uint32_t id;
    std::deque<Waiting> waiting;
    std::size_t bytes = 0;
  };
  struct ClientChannel {
    std::string topic, encoding;
    std::optional<CommandInput> input{};  // of a topic of commands
  };

  void receive_text(std::string_view text);
  /// Keeps a request about parameters until the hub has them.
  void hold(std::string_view text);
  void receive_data(std::string_view message);
  void receive_call(std::string_view message);
  void receive_playback(std::string_view message);
  void fetch_asset(const Json& message);
  void send_graph();
  /// Does work, and sends the client a status that says what is wrong, if anything.
  void tell_errors(const std::function<void()>& work);
  void subscribe(const Json& message);
  void add_subscription(const Json& json);
  void unsubscribe(const Json& message);
  void advertise_of_client(const Json& message);
  CommandInput find_command_input(const std::string& topic, const std::string& schema) const;
  void unadvertise_of_client(const Json& message);
  void get_parameters(const Json& message);
  void set_parameters(const Json& message);
  void subscribe_parameters(const Json& message, bool on);
  void add(Subscription& to, std::int64_t time_ns, const std::shared_ptr<const std::string>& bytes);
  std::set<std::size_t> parameters_of(const Json& message);
  std::optional<WireMessage> next_data();

  FoxgloveHub& hub_;
  ClientId id_;
  TextQueue texts_;
  std::map<std::size_t, Subscription> subscriptions_;  // by channel
  std::map<std::uint32_t, ClientChannel> client_channels_;
  std::set<std::size_t> watched_, changed_;  // parameters
  bool watches_all_ = false, watches_graph_ = false, graph_changed_ = false;
  std::vector<std::string> held_;        // requests about parameters, until the hub has them
  std::deque<std::string> answers_;      // to calls of services and to requests of playback control
  std::deque<AssetRequest> fetched_;     // their files are read when the client takes them
  std::optional<std::int64_t> time_ns_;  // to be sent
  std::uint64_t next_order_ = 0;
};

}  // namespace simvis::live
