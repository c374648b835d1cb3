#include "simvis/sharing/network_host.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include <simvis/error.h>
#include "exchange/clients/host.h"
#include "exchange/messages/cdr.h"
#include "exchange/messages/dds/dds_node.h"
#include "exchange/messages/types/follow_types.h"
#include "exchange/messages/types/std_types.h"
#include "exchange/messages/types/system_types.h"
#include "simvis/sharing/follow_messages.h"
#include "simvis/sharing/output_message.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxLogBytes = std::size_t{256} << 20;
constexpr std::size_t kLogBytes = 128;  // about what an empty log takes

/// Empty if the sample has another type: any participant can write to a topic.
template <ros::Message M>
std::optional<M> read_as(const std::string& bytes) {
  try {
    return ros::decode<M>(bytes);
  } catch (const InputError&) {
    return {};
  }
}

class NetworkHost : public FollowedHost {
 public:
  NetworkHost(std::string name, std::optional<std::uint32_t> domain) : name_(std::move(name)), domain_(domain) {
    check_served_name(name_);
    join();
  }

  bool connect(int timeout_ms) override;
  std::string missing() const override {
    return "no process in this domain of DDS serves " + in_quotes(name_) + ", expected simvis-run --serve " + name_ +
           " --dds";
  }
  Waited wait(std::uint64_t frames, int timeout_ms) override;
  Frame read(std::vector<double>& values) override;
  std::optional<Change> next_change(std::uint64_t& position) override;
  void set(std::size_t parameter, const std::string& name, double value) override;
  void request(const std::string& xml) override;
  std::optional<HostMeasurement> measurement(const std::string& sensor, std::uint64_t known) override;

 private:
  /// The log of a host, as far as it has come.
  struct Log {
    std::vector<std::pair<std::uint64_t, std::string>> changes;  // frame and command
    bool has_gap = false;                                        // something was too long
  };

  void join();
  void receive();
  void receive_log();
  void take_log_space(std::size_t bytes);
  void add(ros::ChangeLog message);
  void receive_frames();
  void receive_measurements();
  bool has_ended() const;
  std::string topic(std::string_view what) const { return follow_topic(name_, what); }

  std::string name_;
  std::optional<std::uint32_t> domain_;
  std::optional<ros::DdsNode> node_;
  std::unique_ptr<ros::RecorderSink> sink_;
  std::map<std::uint64_t, Log> logs_;  // by host
  std::size_t log_bytes_ = 0;
  std::optional<ros::HostFrame> newest_, finished_;  // the last one, and the last one whose changes have come
  std::uint64_t newest_writer_ = 0, frames_ = 0;
  bool is_lost_ = false;                                 // another host has taken its place
  std::map<std::string, HostMeasurement> measurements_;  // by sensor, of those that were asked for
};

// A new participant finds those that are there, and gets their logs from the start.
void NetworkHost::join() {
  sink_.reset();
  node_.emplace(domain_);
  sink_ = node_->sink(ros::SensorQos::reliable);
  node_->subscribe(topic(kFollowLog), ros::describe<ros::ChangeLog>(), kMaxMessageBytes, ros::Durability::log);
  node_->subscribe(topic(kFollowFrame), ros::describe<ros::HostFrame>(), kMaxMessageBytes, ros::Durability::latched);
  logs_.clear();
  log_bytes_ = 0;
  newest_.reset();
  finished_.reset();
  newest_writer_ = frames_ = 0;
  is_lost_ = false;
  measurements_.clear();
}

bool NetworkHost::connect(int timeout_ms) {
  if (newest_ && has_ended()) join();
  return wait(0, timeout_ms) == Waited::frame;
}

FollowedHost::Waited NetworkHost::wait(std::uint64_t frames, int timeout_ms) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  for (;;) {
    receive();
    if (newest_ && has_ended()) return Waited::host_ended;
    if (frames_ > frames) return Waited::frame;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) return Waited::time_over;
    node_->wait(static_cast<int>(left.count()));
  }
}

bool NetworkHost::has_ended() const { return is_lost_ || !node_->has_writer(topic(kFollowFrame), newest_writer_); }

void NetworkHost::receive() {
  receive_log();
  receive_frames();
  receive_measurements();
  if (!newest_) return;
  const Log& log = logs_[newest_->host];
  if (log.has_gap) {
    throw MachineError("the log of " + in_quotes(name_) + " came with a gap behind command " +
                       std::to_string(log.changes.size()) + ", expected messages of up to 64 MiB");
  }
  if (newest_->changes > log.changes.size()) return;
  if (finished_ && finished_->frame == newest_->frame && finished_->host == newest_->host) return;
  finished_ = newest_;
  ++frames_;
}

void NetworkHost::receive_log() {
  for (const std::string& bytes : node_->take(topic(kFollowLog))) {
    if (std::optional<ros::ChangeLog> message = read_as<ros::ChangeLog>(bytes)) add(std::move(*message));
  }
}

void NetworkHost::take_log_space(std::size_t bytes) {
  log_bytes_ += bytes;
  if (log_bytes_ > kMaxLogBytes) {
    throw MachineError("the log of " + in_quotes(name_) + " is longer than " + std::to_string(kMaxLogBytes >> 20) +
                       " MiB");
  }
}

void NetworkHost::add(ros::ChangeLog message) {
  if (newest_ && message.host != newest_->host) return;
  if (!logs_.contains(message.host)) take_log_space(kLogBytes);
  auto& [changes, has_gap] = logs_[message.host];
  has_gap |= message.first > changes.size();
  if (has_gap) return;
  for (std::size_t i = changes.size() - message.first; i < message.commands.size(); ++i) {
    take_log_space(sizeof changes.front() + message.commands[i].size());
    changes.emplace_back(message.frame, std::move(message.commands[i]));
  }
}

void NetworkHost::receive_frames() {
  for (const ros::DdsNode::Received& received : node_->take_with_writers(topic(kFollowFrame))) {
    std::optional<ros::HostFrame> frame = read_as<ros::HostFrame>(received.bytes);
    if (!frame || frame->name != name_ || frame->time_ns < 0) continue;
    if (newest_ && frame->host < newest_->host) continue;
    if (finished_ && frame->host > finished_->host) is_lost_ = true;
    if (is_lost_) return;
    newest_ = std::move(frame);
    newest_writer_ = received.writer;
  }
}

void NetworkHost::receive_measurements() {
  for (auto& [sensor, last] : measurements_) {
    for (const std::string& bytes : node_->take(follow_topic(name_ + "/" + sensor, kFollowMeasurement))) {
      std::optional<ros::HostMeasurement> message = read_as<ros::HostMeasurement>(bytes);
      if (!message || !newest_ || message->host != newest_->host) continue;
      std::optional<Measurement> measurement = to_measurement(std::move(*message));
      if (measurement) last = {last.number + 1, *std::move(measurement)};
    }
  }
}

FollowedHost::Frame NetworkHost::read(std::vector<double>& values) {
  if (!finished_) return {};
  values = finished_->values;
  return {.frames = frames_, .next_frame = finished_->frame + 1, .time_ns = finished_->time_ns};
}

std::optional<FollowedHost::Change> NetworkHost::next_change(std::uint64_t& position) {
  if (!finished_) return {};
  const auto& changes = logs_[finished_->host].changes;
  if (position >= changes.size()) return {};
  const auto& [frame, xml] = changes[position++];
  return Change{frame, xml};
}

void NetworkHost::set(std::size_t, const std::string& name, double value) {
  constexpr std::uint8_t kDouble = 3;
  ros::Parameter parameter;
  parameter.name = name;
  parameter.value.type = kDouble;
  parameter.value.double_value = value;
  ros::ParameterEvent event;
  event.changed_parameters.push_back(parameter);
  sink_->write(topic(kFollowSet), 0, event);
}

void NetworkHost::request(const std::string& xml) { sink_->write(topic(kFollowRequest), 0, ros::String{xml}); }

std::optional<FollowedHost::HostMeasurement> NetworkHost::measurement(const std::string& sensor, std::uint64_t known) {
  const auto [found, is_new] = measurements_.try_emplace(sensor);
  if (is_new) {
    node_->subscribe(follow_topic(name_ + "/" + sensor, kFollowMeasurement), ros::describe<ros::HostMeasurement>(),
                     kMaxMessageBytes);
  }
  receive_measurements();
  const HostMeasurement& last = found->second;
  if (last.number == 0 || last.number == known) return {};
  return last;
}

}  // namespace

std::unique_ptr<FollowedHost> host_by_dds(const std::string& name, std::optional<std::uint32_t> domain) {
  return std::make_unique<NetworkHost>(name, domain);
}

}  // namespace simvis
