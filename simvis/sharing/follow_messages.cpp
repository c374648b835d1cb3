#include "simvis/sharing/follow_messages.h"

#include <algorithm>
#include <chrono>
#include <glm/gtc/type_ptr.hpp>
#include <utility>

#include "exchange/messages/topics.h"
#include "exchange/messages/types/follow_types.h"
#include "simvis/sharing/output_message.h"

namespace simvis {
namespace {

// A message of the log has at least one command, and no further ones beyond this.
constexpr std::size_t kLogMessageBytes = std::size_t{1} << 20;

/// Later hosts have larger numbers, also when they run on another machine.
std::uint64_t host_number() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count());
}

}  // namespace

std::string follow_topic(std::string_view name, std::string_view what) {
  return "/simvis" + ros::topic_name(name, what);
}

FollowMessages::FollowMessages(ros::MessageOutlet& outlet, std::string name)
    : outlet_(outlet), name_(std::move(name)), host_(host_number()) {}

void FollowMessages::add_frame(const BuiltScene& scene, const FrameTime& time, std::span<const PlacedSensor> sensors) {
  add_changes(scene.parameters.changes(), time);
  for (const PlacedSensor& placed : sensors) {
    if (placed.measurement != nullptr) add_measurement(placed, time);
  }
  const std::string topic = follow_topic(name_, kFollowFrame);
  if (!outlet_.wants<ros::HostFrame>(topic, ros::TopicForm::own, ros::Durability::latched)) return;
  const std::span<const double> values = scene.parameters.values();
  ros::HostFrame message{host_, name_, time.index, time.time_ns, sent_changes_, {values.begin(), values.end()}};
  outlet_.add({.run = [topic, time_ns = time.time_ns, message = std::move(message)](ros::MessageSink& sink) {
    sink.write(topic, time_ns, message, ros::Durability::latched);
  }});
}

void FollowMessages::add_changes(const std::vector<std::string>& changes, const FrameTime& time) {
  const std::string topic = follow_topic(name_, kFollowLog);
  if (!outlet_.wants<ros::ChangeLog>(topic, ros::TopicForm::own, ros::Durability::log)) return;
  while (sent_changes_ < changes.size()) {
    ros::ChangeLog message{host_, sent_changes_, time.index, {}};
    for (std::size_t bytes = 0; sent_changes_ < changes.size() && bytes < kLogMessageBytes; ++sent_changes_) {
      message.commands.push_back(changes[sent_changes_]);
      bytes += changes[sent_changes_].size();
    }
    outlet_.add({.run = [topic, time_ns = time.time_ns, message = std::move(message)](ros::MessageSink& sink) {
      sink.write(topic, time_ns, message, ros::Durability::log);
    }});
  }
}

void FollowMessages::add_measurement(const PlacedSensor& placed, const FrameTime& time) {
  const std::string topic = follow_topic(name_ + "/" + placed.sensor.name, kFollowMeasurement);
  if (!outlet_.wants<ros::HostMeasurement>(topic)) return;
  std::size_t held_bytes = 0;
  for (const MeasuredArray& each : placed.measurement->arrays) held_bytes += each.bytes();
  outlet_.add(
      {.kind = ros::MessageJob::Kind::measurement,
       .held_bytes = held_bytes,
       .run = [=, arrays = placed.measurement->arrays, host = host_, pose = placed.measurement->world_from_sensor,
               stamp_ns = placed.measurement->time_ns, time_ns = time.time_ns](ros::MessageSink& sink) {
         if (!sink.is_read<ros::HostMeasurement>(topic)) return;
         ros::HostMeasurement message;
         message.host = host;
         message.time_ns = stamp_ns;
         std::ranges::copy(std::span(glm::value_ptr(pose), 16), message.world_from_sensor.begin());
         for (const MeasuredArray& each : arrays) message.outputs.push_back(to_message(each));
         sink.write(topic, time_ns, message);
       }});
}

}  // namespace simvis
