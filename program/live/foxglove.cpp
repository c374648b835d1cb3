#include "program/live/foxglove.h"

#include <algorithm>
#include <span>
#include <utility>

namespace simvis::live {

void WantedTopics::set(std::set<std::string> topics) {
  const std::lock_guard lock(mutex_);
  topics_ = std::move(topics);
}

bool WantedTopics::contains(const std::string& topic) const {
  const std::lock_guard lock(mutex_);
  return topics_.contains(topic);
}

FoxgloveHub::FoxgloveHub(ControlQueue& controls, std::string session, std::optional<PlaybackRange> range)
    : controls_(controls), session_(std::move(session)), range_(range) {}

void FoxgloveHub::advertise(const ros::Topic& topic) {
  if (!channel_of_topic_.emplace(topic.name, channels_.size()).second) return;
  channels_.push_back({topic, nullptr, 0});
  const std::size_t added[] = {channels_.size() - 1};
  for (const auto& [id, peer] : peers_) {
    peer->advertise(added);
    peer->note_graph();
  }
}

void FoxgloveHub::set_command_inputs(std::vector<CommandInput> inputs) {
  command_inputs_ = std::move(inputs);
  for (const auto& [id, peer] : peers_) peer->note_graph();
}

void FoxgloveHub::answer_call(ClientId client, const ServiceCall& call, const std::string& refusal) {
  const auto found = peers_.find(client);
  if (found != peers_.end()) found->second->answer_call(call, refusal);
}

void FoxgloveHub::set_playback(const PlaybackState& state) {
  if (!range_) return;
  for (const auto& [id, peer] : peers_) peer->send_playback(state);
  playback_ = state;
  playback_->did_seek = false;
  playback_->request.clear();
}

void FoxgloveHub::publish(const ros::Topic& topic, std::int64_t time_ns, std::string_view bytes) {
  const auto found = channel_of_topic_.find(topic.name);
  if (found == channel_of_topic_.end()) return;
  const auto shared = std::make_shared<const std::string>(bytes);
  Channel& channel = channels_[found->second];
  if (topic.durability == ros::Durability::latched) {
    channel.kept = shared;
    channel.kept_ns = time_ns;
  }
  for (const auto& [id, peer] : peers_) peer->publish(found->second, time_ns, shared);
}

void FoxgloveHub::set_time(std::int64_t time_ns) {
  if (playback_) playback_->time_ns = time_ns;
  for (const auto& [id, peer] : peers_) peer->set_time(time_ns);
}

void FoxgloveHub::follow_subscriptions() {
  std::set<std::string> topics;
  for (const auto& [id, peer] : peers_) peer->add_wanted(topics);
  wanted.set(std::move(topics));
}

std::optional<std::size_t> FoxgloveHub::find_parameter(std::string_view name) const {
  const auto found = parameter_of_name_.find(name);
  if (found == parameter_of_name_.end() || parameters_[found->second].removed) return std::nullopt;
  return found->second;
}

void FoxgloveHub::set_parameters(std::vector<Parameter> parameters) {
  std::set<std::size_t> changed;
  // Of another scene: those of one keep their places and names.
  const bool replaced = parameters.size() < parameters_.size() ||
                        !std::ranges::equal(parameters_, std::span(parameters).first(parameters_.size()), {},
                                            &Parameter::name, &Parameter::name);
  if (replaced) parameter_of_name_.clear();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const bool is_new = replaced || i >= parameters_.size();
    if (is_new || parameters[i].value != parameters_[i].value || parameters[i].removed != parameters_[i].removed) {
      changed.insert(i);
    }
    if (is_new) parameter_of_name_.insert_or_assign(parameters[i].name, i);
  }
  parameters_ = std::move(parameters);
  // Of another scene, an index may mean another parameter, or none.
  for (const auto& [id, peer] : peers_) {
    if (replaced) peer->forget_parameters();
  }
  for (const auto& [id, peer] : peers_) peer->note_changes(changed);
  if (std::exchange(knows_parameters_, true)) return;
  for (const auto& [id, peer] : peers_) peer->carry_out_held();
}

void FoxgloveHub::answer_set(const Control& request, std::span<const std::string> refusals) {
  const auto found = peers_.find(request.client);
  if (found == peers_.end()) return;
  for (const std::string& refusal : refusals) found->second->send_status(FoxgloveClient::Level::error, refusal);
  std::set<std::size_t> parameters;
  for (const auto& [parameter, value] : request.values) {
    if (parameter < parameters_.size()) parameters.insert(parameter);
  }
  if (!request.request.empty() || !refusals.empty()) found->second->send_values(parameters, request.request);
}

void FoxgloveHub::refuse(ClientId client, const std::string& refusal) {
  const auto found = peers_.find(client);
  if (found != peers_.end()) found->second->send_status(FoxgloveClient::Level::error, refusal);
}

void FoxgloveHub::answer_execute(ClientId client, const std::string& refusal) {
  const auto found = peers_.find(client);
  if (found == peers_.end()) return;
  using Level = FoxgloveClient::Level;
  found->second->send_status(refusal.empty() ? Level::info : Level::error,
                             refusal.empty() ? "the request was executed" : refusal);
}

}  // namespace simvis::live
