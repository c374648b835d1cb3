#include "program/live/foxglove_peer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/binary_numbers.h"
#include "exchange/messages/description.h"
#include "program/live/foxglove_playback.h"
#include "program/live/foxglove_services.h"

namespace simvis::live {
namespace {

// Waiting for one subscription: more would only be older.
constexpr std::size_t kMaxWaitingMessages = 64, kMaxWaitingBytes = std::size_t{32} << 20;
constexpr std::size_t kMaxClientChannels = 64, kMaxAnswers = 4096, kMaxHeld = 8;
constexpr std::string_view kParameterOps[] = {"getParameters", "setParameters", "subscribeParameterUpdates",
                                              "unsubscribeParameterUpdates"};
constexpr char kMessageData = 1, kTime = 2;
constexpr char kServiceCall = 2;               // of a client
constexpr const char* kPublisher = "/simvis";  // the name of the simulation in the connection graph

std::string foxglove_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The text of a std_msgs/msg/String in little-endian CDR.
std::optional<std::string_view> string_of_cdr(std::string_view bytes) {
  constexpr std::size_t kHead = ros::kEncapsulation.size() + sizeof(std::uint32_t);
  if (bytes.size() < kHead || !bytes.starts_with(ros::kEncapsulation)) return std::nullopt;
  const auto size = binary_at<std::uint32_t>(bytes, ros::kEncapsulation.size());
  if (size == 0 || size > bytes.size() - kHead || bytes[kHead + size - 1] != '\0') return std::nullopt;
  return bytes.substr(kHead, size - 1);
}

std::optional<std::string> string_of_json(std::string_view bytes) {
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  if (!json.is_object() || !json.contains("data") || !json["data"].is_string()) return std::nullopt;
  return json["data"].get<std::string>();
}

std::uint32_t foxglove_id(const nlohmann::json& json) {
  const std::int64_t id = json.is_number_integer() ? json.get<std::int64_t>() : -1;
  if (id < 0 || id > std::numeric_limits<std::uint32_t>::max()) throw InputError("an id is no number of 32 bits");
  return static_cast<std::uint32_t>(id);
}

std::string foxglove_request(const nlohmann::json& message) {
  constexpr std::size_t kMaxSize = 256;
  if (!message.contains("id")) return "";
  auto id = message["id"].get<std::string>();
  if (id.size() > kMaxSize) throw InputError("the id of the request is too long");
  return id;
}

}  // namespace

FoxglovePeer::FoxglovePeer(FoxgloveHub& hub, ClientId id) : hub_(hub), id_(id) {
  hub_.peers_.emplace(id, this);
  hub_.has_clients_ = true;
  Json info = {
      {"op", "serverInfo"},
      {"name", "SimVis"},
      {"capabilities",
       {"clientPublish", "parameters", "parametersSubscribe", "time", "services", "connectionGraph", "assets"}},
      {"supportedEncodings", {"cdr", "json"}},
      {"metadata", {{"ROS_DISTRO", "jazzy"}}},
      {"sessionId", hub.session_}};
  if (hub.range_) {
    info["capabilities"].push_back("playbackControl");
    info["dataStartTime"] = playback_time(hub.range_->start_ns);
    info["dataEndTime"] = playback_time(hub.range_->end_ns);
  }
  texts_.add(foxglove_text(info));
  std::vector<std::size_t> channels(hub.channels_.size());
  for (std::size_t i = 0; i < channels.size(); ++i) channels[i] = i;
  advertise(channels);
  texts_.add(foxglove_text(advertised_services()));
  if (hub.playback_) send_playback(*hub.playback_);
}

FoxglovePeer::~FoxglovePeer() {
  hub_.peers_.erase(id_);
  hub_.has_clients_ = !hub_.peers_.empty();
  hub_.follow_subscriptions();
}

void FoxglovePeer::advertise(std::span<const std::size_t> channels) {
  Json list = Json::array();
  for (const std::size_t i : channels) {
    const ros::Topic& topic = hub_.channels_[i].topic;
    list.push_back({{"id", i + 1},
                    {"topic", topic.name},
                    {"encoding", "cdr"},
                    {"schemaName", topic.type->name},
                    {"schema", ros::msg_text(*topic.type)},
                    {"schemaEncoding", "ros2msg"}});
  }
  texts_.add(foxglove_text({{"op", "advertise"}, {"channels", std::move(list)}}));
}

void FoxglovePeer::add(Subscription& to, std::int64_t time_ns, const std::shared_ptr<const std::string>& bytes) {
  to.waiting.push_back({next_order_++, time_ns, bytes});
  to.bytes += bytes->size();
  while (to.waiting.size() > 1 && (to.waiting.size() > kMaxWaitingMessages || to.bytes > kMaxWaitingBytes)) {
    to.bytes -= to.waiting.front().bytes->size();
    to.waiting.pop_front();
  }
}

void FoxglovePeer::publish(std::size_t channel, std::int64_t time_ns, const std::shared_ptr<const std::string>& bytes) {
  const auto found = subscriptions_.find(channel);
  if (found != subscriptions_.end()) add(found->second, time_ns, bytes);
}

void FoxglovePeer::note_changes(const std::set<std::size_t>& parameters) {
  for (const std::size_t parameter : parameters) {
    if (watches_all_ || watched_.contains(parameter)) changed_.insert(parameter);
  }
}

void FoxglovePeer::forget_parameters() {
  watched_.clear();
  changed_.clear();
}

void FoxglovePeer::send_values(const std::set<std::size_t>& parameters, const std::string& request) {
  Json list = Json::array();
  for (const std::size_t i : parameters) {
    const FoxgloveHub::Parameter& parameter = hub_.parameters_[i];
    Json entry = {{"name", parameter.name}};
    if (!parameter.removed) {
      entry["value"] = parameter.value;
      entry["type"] = "float64";
    }
    list.push_back(std::move(entry));
  }
  Json message = {{"op", "parameterValues"}, {"parameters", std::move(list)}};
  if (!request.empty()) message["id"] = request;
  texts_.add(foxglove_text(message));
}

void FoxglovePeer::send_status(Level level, const std::string& message) {
  texts_.add(foxglove_text({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}}));
}

void FoxglovePeer::answer_call(const ServiceCall& call, const std::string& refusal) {
  const FoxgloveService& service = kFoxgloveServices[call.service - 1];
  answers_.push_back(service_answer(call, refusal.empty(), refusal.empty() ? std::string(service.done) : refusal));
}

// A client that reads nothing loses states, and gets later ones.
void FoxglovePeer::send_playback(const PlaybackState& state) {
  if (answers_.size() < kMaxAnswers) answers_.push_back(playback_message(state));
}

// The whole graph; it replaces what the client knows.
void FoxglovePeer::send_graph() {
  const auto entry = [](std::string_view name, const char* ids) {
    return Json{{"name", std::string(name)}, {ids, Json::array({kPublisher})}};
  };
  Json published = Json::array(), subscribed = Json::array(), services = Json::array();
  for (const FoxgloveHub::Channel& channel : hub_.channels_) {
    published.push_back(entry(channel.topic.name, "publisherIds"));
  }
  subscribed.push_back(entry(kExecuteTopic, "subscriberIds"));
  for (const CommandInput& input : hub_.command_inputs_) subscribed.push_back(entry(input.topic, "subscriberIds"));
  for (const FoxgloveService& service : kFoxgloveServices) services.push_back(entry(service.name, "providerIds"));
  texts_.add(foxglove_text({{"op", "connectionGraphUpdate"},
                            {"publishedTopics", std::move(published)},
                            {"subscribedTopics", std::move(subscribed)},
                            {"advertisedServices", std::move(services)},
                            {"removedTopics", Json::array()},
                            {"removedServices", Json::array()}}));
}

void FoxglovePeer::add_wanted(std::set<std::string>& topics) const {
  for (const auto& [channel, subscription] : subscriptions_) topics.insert(hub_.channels_[channel].topic.name);
}

std::optional<WireMessage> FoxglovePeer::next() {
  if (!changed_.empty()) send_values(std::exchange(changed_, {}), "");
  if (std::exchange(graph_changed_, false)) send_graph();
  if (std::optional<WireMessage> text = texts_.next()) return text;
  if (!answers_.empty()) {
    WireMessage message{.binary = true, .head = std::move(answers_.front()), .body = nullptr};
    answers_.pop_front();
    return message;
  }
  if (!fetched_.empty()) {
    WireMessage message{.binary = true, .head = asset_answer(hub_.assets_, fetched_.front()), .body = nullptr};
    fetched_.pop_front();
    return message;
  }
  if (time_ns_) {
    WireMessage message{.binary = true, .head = {kTime}, .body = nullptr};
    append_binary(message.head, static_cast<std::uint64_t>(*std::exchange(time_ns_, std::nullopt)));
    return message;
  }
  return next_data();
}

std::optional<WireMessage> FoxglovePeer::next_data() {
  Subscription* first = nullptr;
  for (auto& [channel, each] : subscriptions_) {
    if (each.waiting.empty()) continue;
    if (first == nullptr || each.waiting.front().order < first->waiting.front().order) first = &each;
  }
  if (first == nullptr) return std::nullopt;
  Waiting waiting = std::move(first->waiting.front());
  first->waiting.pop_front();
  first->bytes -= waiting.bytes->size();
  WireMessage message{.binary = true, .head = {kMessageData}, .body = std::move(waiting.bytes)};
  append_binary(message.head, first->id);
  append_binary(message.head, static_cast<std::uint64_t>(waiting.time_ns));
  return message;
}

void FoxglovePeer::receive(std::string_view message, bool binary) {
  tell_errors([&] { binary ? receive_data(message) : receive_text(message); });
}

void FoxglovePeer::tell_errors(const std::function<void()>& work) {
  try {
    work();
  } catch (const Json::exception&) {
    send_status(Level::error, "the message is not as the protocol says");
  } catch (const InputError& error) {
    send_status(Level::error, error.what());
  }
}

void FoxglovePeer::receive_text(std::string_view text) {
  const Json message = Json::parse(text);
  const auto op = message.at("op").get<std::string>();
  if (op == "subscribe") return subscribe(message);
  if (op == "unsubscribe") return unsubscribe(message);
  if (op == "advertise") return advertise_of_client(message);
  if (op == "unadvertise") return unadvertise_of_client(message);
  if (std::ranges::count(kParameterOps, op) > 0) {
    if (!hub_.knows_parameters_) return hold(text);
    if (op == "getParameters") return get_parameters(message);
    if (op == "setParameters") return set_parameters(message);
    return subscribe_parameters(message, op == "subscribeParameterUpdates");
  }
  if (op == "subscribeConnectionGraph") {
    watches_graph_ = graph_changed_ = true;
    return;
  }
  if (op == "fetchAsset") return fetch_asset(message);
  if (op == "unsubscribeConnectionGraph") {
    watches_graph_ = graph_changed_ = false;
    return;
  }
  throw InputError("there is no operation " + in_quotes(op) + " here");
}

void FoxglovePeer::fetch_asset(const Json& message) {
  AssetRequest request{message.at("uri").get<std::string>(), foxglove_id(message.at("requestId"))};
  if (fetched_.size() >= kMaxAnswers) throw InputError("too many answers wait");
  fetched_.push_back(std::move(request));
}

void FoxglovePeer::hold(std::string_view text) {
  if (held_.size() >= kMaxHeld) throw InputError("too many requests wait");
  held_.emplace_back(text);
}

void FoxglovePeer::carry_out_held() {
  for (const std::string& text : std::exchange(held_, {})) receive(text, false);
}

// A wrong entry leaves the others of the message valid.
void FoxglovePeer::subscribe(const Json& message) {
  for (const Json& each : message.at("subscriptions")) tell_errors([&] { add_subscription(each); });
  hub_.follow_subscriptions();
}

void FoxglovePeer::add_subscription(const Json& json) {
  const std::uint32_t id = foxglove_id(json.at("id"));
  const std::size_t channel = std::size_t{foxglove_id(json.at("channelId"))} - 1;
  if (channel >= hub_.channels_.size()) throw InputError("there is no channel " + std::to_string(channel + 1));
  const bool id_taken = std::ranges::any_of(subscriptions_, [id](const auto& known) { return known.second.id == id; });
  if (id_taken || subscriptions_.contains(channel)) {
    throw InputError("subscription " + std::to_string(id) + ": the id or the channel has one already");
  }
  Subscription& added = subscriptions_.emplace(channel, Subscription{.id = id, .waiting = {}}).first->second;
  const FoxgloveHub::Channel& known = hub_.channels_[channel];
  if (known.kept) add(added, known.kept_ns, known.kept);
}

void FoxglovePeer::unsubscribe(const Json& message) {
  for (const Json& each : message.at("subscriptionIds")) {
    tell_errors([&] {
      const std::uint32_t id = foxglove_id(each);
      if (std::erase_if(subscriptions_, [id](const auto& known) { return known.second.id == id; }) > 0) return;
      throw InputError("there is no subscription " + std::to_string(id));
    });
  }
  hub_.follow_subscriptions();
}

void FoxglovePeer::advertise_of_client(const Json& message) {
  for (const Json& each : message.at("channels")) {
    const std::uint32_t id = foxglove_id(each.at("id"));
    ClientChannel channel{each.at("topic").get<std::string>(), each.at("encoding").get<std::string>()};
    const std::string_view name = kExecuteTopic;
    if (channel.topic != name && channel.topic != name.substr(1)) {
      channel.input = find_command_input(channel.topic, each.value("schemaName", ""));
      if (channel.encoding != "cdr") {
        throw InputError("encoding " + in_quotes(channel.encoding) + " is not known for commands, expected cdr");
      }
    }
    if (channel.encoding != "cdr" && channel.encoding != "json") {
      throw InputError("encoding " + in_quotes(channel.encoding) + " is not known, expected cdr or json");
    }
    if (client_channels_.size() >= kMaxClientChannels) throw InputError("too many channels");
    client_channels_.insert_or_assign(id, std::move(channel));
  }
}

/// The input of this topic and type, which some clients write without "msg/".
CommandInput FoxglovePeer::find_command_input(const std::string& topic, const std::string& schema) const {
  std::string allowed = std::string(kExecuteTopic);
  for (const CommandInput& input : hub_.command_inputs_) {
    const std::string_view type = input.type->name;
    const std::size_t package = type.find('/');
    const std::string short_type = std::string(type.substr(0, package)) + std::string(type.substr(type.rfind('/')));
    const bool is_topic = topic == input.topic || "/" + topic == input.topic;
    if (is_topic && (schema == type || schema == short_type)) return input;
    allowed += ", " + input.topic + " of type " + std::string(type);
  }
  throw InputError("there is no subscriber to " + in_quotes(topic) + (schema.empty() ? "" : " of type " + schema) +
                   ", expected one of: " + allowed);
}

void FoxglovePeer::unadvertise_of_client(const Json& message) {
  for (const Json& each : message.at("channelIds")) client_channels_.erase(foxglove_id(each));
}

// A call that cannot be made is answered as the protocol says; one that the simulation refuses is answered with its
// reason.
void FoxglovePeer::receive_call(std::string_view message) {
  ServiceCall call = read_service_call(message);
  const auto fail = [&](const std::string& why) {
    texts_.add(foxglove_text(
        {{"op", "serviceCallFailure"}, {"serviceId", call.service}, {"callId", call.id}, {"message", why}}));
  };
  if (call.service == 0 || call.service > std::size(kFoxgloveServices)) return fail("there is no such service");
  if (call.encoding != "cdr" && call.encoding != "json") {
    return fail("encoding " + in_quotes(call.encoding) + " is not known, expected cdr or json");
  }
  const FoxgloveService& service = kFoxgloveServices[call.service - 1];
  if (answers_.size() >= kMaxAnswers) return fail("too many answers wait");
  Control control{.kind = service.kind, .client = id_, .request = std::string(service.name), .call = std::move(call)};
  if (!hub_.controls_.add(control)) throw InputError("too many requests wait");
}

void FoxglovePeer::receive_playback(std::string_view message) {
  PlaybackRequest request = read_playback_request(message);
  if (!hub_.range_) throw InputError("the run has no end, so its playback is controlled by services alone");
  if (answers_.size() >= kMaxAnswers) throw InputError("too many answers wait");
  Control control{
      .kind = Control::Kind::playback, .client = id_, .request = "playback", .playback = std::move(request)};
  if (!hub_.controls_.add(std::move(control))) throw InputError("too many requests wait");
}

void FoxglovePeer::receive_data(std::string_view message) {
  if (!message.empty() && message.front() == kServiceCall) return receive_call(message);
  if (!message.empty() && message.front() == kPlaybackRequest) return receive_playback(message);
  constexpr std::size_t kHead = 1 + sizeof(std::uint32_t);
  if (message.size() < kHead || message.front() != kMessageData) throw InputError("this is no message of a channel");
  const auto found = client_channels_.find(binary_at<std::uint32_t>(message, 1));
  if (found == client_channels_.end()) throw InputError("the channel was not advertised");
  const std::string_view payload = message.substr(kHead);
  if (found->second.input) {
    Control control{.kind = Control::Kind::command,
                    .client = id_,
                    .text = std::string(payload),
                    .input = found->second.input,
                    .request = "command"};
    if (!hub_.controls_.add(std::move(control))) throw InputError("too many requests wait");
    return;
  }
  std::optional<std::string> xml;
  if (found->second.encoding == "json") {
    xml = string_of_json(payload);
  } else if (const std::optional<std::string_view> text = string_of_cdr(payload)) {
    xml = *text;
  }
  if (!xml) throw InputError("expected a std_msgs/msg/String");
  Control control{.kind = Control::Kind::execute, .client = id_, .text = std::move(*xml), .request = "execute"};
  if (!hub_.controls_.add(std::move(control))) throw InputError("too many requests wait");
}

std::set<std::size_t> FoxglovePeer::parameters_of(const Json& message) {
  std::set<std::size_t> wanted;
  const Json& names = message.at("parameterNames");
  for (const Json& each : names) {
    const auto name = each.get<std::string>();
    if (const std::optional<std::size_t> found = hub_.find_parameter(name)) {
      wanted.insert(*found);
    } else {
      send_status(Level::warning, "there is no parameter " + in_quotes(name));
    }
  }
  if (!names.empty()) return wanted;
  for (std::size_t i = 0; i < hub_.parameters_.size(); ++i) {
    if (!hub_.parameters_[i].removed) wanted.insert(i);
  }
  return wanted;
}

void FoxglovePeer::get_parameters(const Json& message) {
  send_values(parameters_of(message), foxglove_request(message));
}

void FoxglovePeer::set_parameters(const Json& message) {
  Control control{.kind = Control::Kind::set, .client = id_, .request = foxglove_request(message)};
  for (const Json& each : message.at("parameters")) {
    const auto name = each.at("name").get<std::string>();
    const std::optional<std::size_t> found = hub_.find_parameter(name);
    if (!found) {
      send_status(Level::error, "there is no parameter " + in_quotes(name));
      continue;
    }
    if (!each.contains("value") || !each["value"].is_number()) {
      send_status(Level::error, name + ": expected a number");
      continue;
    }
    control.values.emplace_back(*found, each["value"].get<double>());
  }
  if (!hub_.controls_.add(std::move(control))) throw InputError("too many requests wait");
}

// Without names all parameters are meant, also those that come later.
void FoxglovePeer::subscribe_parameters(const Json& message, bool on) {
  const bool all = message.at("parameterNames").empty();
  const std::set<std::size_t> named = parameters_of(message);
  if (all) watches_all_ = on;
  for (const std::size_t parameter : named) {
    on ? static_cast<void>(watched_.insert(parameter)) : static_cast<void>(watched_.erase(parameter));
  }
}

}  // namespace simvis::live
