#include "simvis/ros/sensor_topics.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "elements/command_source.h"
#include "elements/described_robot.h"
#include "engine/base/words.h"
#include "exchange/messages/from_reading.h"
#include "scenegraph/language/attribute_place.h"
#include "scenegraph/language/frame_name.h"
#include "scenegraph/language/topic_name.h"
#include "simvis/ros/node_name.h"
#include "simvis/ros/topic_kinds.h"

namespace simvis {
namespace {

constexpr std::string_view kTopics = "topics", kIs = ":=", kRest = "*";
// Topics of the whole simulation.
constexpr std::string_view kTakenTopics[] = {"/clock",       "/tf",    "/tf_static", "/parameter_events",
                                             "/diagnostics", "/rosout"};
// What the topics of two views begin with.
constexpr std::string_view kViews[] = {"", "left/", "right/"};
constexpr std::string_view kDescription = "/robot_description", kSimulation = "the simulation";

std::vector<std::pair<std::string, std::string>> read_topics(const CommandAttribute& attribute) {
  std::vector<std::pair<std::string, std::string>> topics;
  for (const std::string_view word : words_of(attribute.value)) {
    const std::size_t is = word.find(kIs);
    const std::string what(word.substr(0, is)), topic(is == word.npos ? "" : word.substr(is + kIs.size()));
    if (what.empty() || !is_topic_name(topic)) {
      fail_at(attribute.where, "attribute \"topics\": " + in_quotes(word) +
                                   " is not allowed, expected WHAT:=/TOPIC, such as scan:=/scan or *:=/front");
    }
    if (std::ranges::count(topics, what, &std::pair<std::string, std::string>::first) > 0) {
      fail_at(attribute.where, "attribute \"topics\": " + in_quotes(what) + " comes twice, expected it once");
    }
    topics.emplace_back(what, topic);
  }
  return topics;
}

bool is_below(std::string_view topic, std::string_view folder) {
  return topic.starts_with(folder) && topic.substr(folder.size()).starts_with('/');
}

// Topics of followers stand below the default node, whatever the node of the simulation is.
bool is_own(std::string_view topic, std::string_view node) {
  return is_below(topic, node) || is_below(topic, kDefaultNode);
}

std::map<std::string, std::string> sensors_by_folder(const BuiltScene& scene) {
  std::map<std::string, std::string> sensor_of_folder;
  for (const BuiltSensor& sensor : scene.sensors) {
    const std::string folder = SensorTopics(sensor).folder();
    const auto [known, is_new] = sensor_of_folder.emplace(folder, sensor.name);
    if (is_new) continue;
    fail_at(place_of(sensor.command, kTopics), "sensors " + in_quotes(known->second) + " and " +
                                                   in_quotes(sensor.name) + " would have the same topics, such as " +
                                                   folder + "/pose, expected names that differ in letters or digits");
  }
  return sensor_of_folder;
}

/// The senders of the topics of the simulation, of robots and of parts, by topic.
std::map<std::string, std::string> users_of_topics(const BuiltScene& scene) {
  std::map<std::string, std::string> user_of_topic;
  for (const std::string_view topic : kTakenTopics) user_of_topic.emplace(topic, kSimulation);
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const auto* const robot = dynamic_cast<const DescribedRobot*>(scene.elements[i].get());
    if (robot == nullptr) continue;
    const std::string user = "the element " + in_quotes(scene.parameters.elements()[i].name);
    const auto [known, is_new] = user_of_topic.emplace(robot->topic(), user);
    if (is_new) continue;
    fail_at(robot->where(),
            user + ": the topic " + robot->topic() + " belongs to " + known->second + ", expected another one");
  }
  user_of_topic.emplace(kDescription, "the description of a robot");
  for (const BuiltSensor& sensor : scene.sensors) {
    const CommandAttribute* const point = sensor.command.find("insert_at");
    if (point == nullptr) continue;
    for (const char* const what : {"odom", "path"}) {
      user_of_topic.emplace(topic_name(point->value, what), "the part " + in_quotes(point->value));
    }
  }
  return user_of_topic;
}

/// The sensor, other than this one, that sends below this topic's folder; null if none does.
const std::string* find_sender(const std::map<std::string, std::string>& sensor_of_folder, std::string_view topic,
                               std::string_view except = {}) {
  const auto below = std::ranges::find_if(
      sensor_of_folder, [&](const auto& each) { return each.second != except && is_below(topic, each.first); });
  return below == sensor_of_folder.end() ? nullptr : &below->second;
}

// A default topic is below the folder of a sensor if both have one name. No sensor sends it.
void check_command_topics(const BuiltScene& scene, std::string_view node,
                          const std::map<std::string, std::string>& user_of_topic,
                          const std::map<std::string, std::string>& sensor_of_folder) {
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const auto* const source = dynamic_cast<const CommandSource*>(scene.elements[i].get());
    if (source == nullptr) continue;
    for (const CommandTopic& each : source->command_topics()) {
      const auto user = user_of_topic.find(each.topic);
      const std::string* const sender = each.is_default ? nullptr : find_sender(sensor_of_folder, each.topic);
      if (user == user_of_topic.end() && sender == nullptr && !is_own(each.topic, node)) continue;
      const std::string owner = user != user_of_topic.end() ? user->second
                                : sender != nullptr         ? "the sensor " + in_quotes(*sender)
                                                            : std::string(kSimulation);
      fail_at(each.where, "element " + in_quotes(scene.parameters.elements()[i].name) + ": the topic " + each.topic +
                              " of commands belongs to " + owner + ", expected one that the scene does not send");
    }
  }
}

/// Whether the sensor sends messages of another kind than `what` at a topic below its own folder.
bool is_taken_by_itself(const BuiltSensor& sensor, const SensorTopics& topics, const std::string& what,
                        std::string_view topic) {
  if (!is_below(topic, topics.folder())) return false;
  const std::string_view own = topic.substr(topics.folder().size() + 1);
  if (own == what) return false;
  const auto is_sent = [&](const std::string& kind) {
    return (own == kind || is_below(own, kind)) && !topics.named().contains(kind);
  };
  return std::ranges::any_of(kViews, [&](std::string_view view) {
    const std::string folder(view);
    const auto is_sent_as = [&](std::string_view kind) { return is_sent(folder + std::string(kind)); };
    return std::ranges::any_of(kTopicKinds, is_sent_as) ||
           std::ranges::any_of(sensor.outputs, [&](const OutputSpec& each) {
             const std::optional<ros::ReadingTopic> reading = ros::reading_topic(each.message);
             return is_sent_as(each.name) || (reading && is_sent_as(reading->topic));
           });
  });
}

}  // namespace

bool is_simulation_topic(std::string_view topic) {
  return std::ranges::count(kTakenTopics, topic) > 0 || topic == kDescription || is_below(topic, kDefaultNode);
}

void check_message_names(const Command& sensor) {
  if (const CommandAttribute* const topics = sensor.find(kTopics)) read_topics(*topics);
  if (const CommandAttribute* const frame = sensor.find("frame")) check_frame_name(*frame);
}

SensorTopics::SensorTopics(const BuiltSensor& sensor) {
  folder_ = topic_name(sensor.name, "");
  folder_.pop_back();
  const CommandAttribute* const topics = sensor.command.find(kTopics);
  if (topics == nullptr) return;
  for (auto& [what, topic] : read_topics(*topics)) {
    if (what == kRest) {
      folder_ = topic;
    } else {
      named_.emplace(what, topic);
    }
  }
}

std::string SensorTopics::of(const std::string& what) const {
  const auto found = named_.find(what);
  return found == named_.end() ? folder_ + "/" + what : found->second;
}

void check_topics(const BuiltScene& scene, std::string_view node) {
  const std::map<std::string, std::string> sensor_of_folder = sensors_by_folder(scene);
  std::map<std::string, std::string> user_of_topic = users_of_topics(scene);
  for (const BuiltSensor& sensor : scene.sensors) {
    const SensorTopics topics(sensor);
    for (const auto& [what, topic] : topics.named()) {
      const auto [known, is_new] = user_of_topic.emplace(topic, "the sensor " + in_quotes(sensor.name));
      const bool is_twice = is_taken_by_itself(sensor, topics, what, topic);
      const std::string* const sender = is_twice ? &sensor.name : find_sender(sensor_of_folder, topic, sensor.name);
      if (is_new && sender == nullptr && !is_own(topic, node)) continue;
      const std::string other = !is_new             ? known->second
                                : sender == nullptr ? std::string(kSimulation)
                                                    : "the sensor " + in_quotes(*sender);
      fail_at(place_of(sensor.command, kTopics), "sensor " + in_quotes(sensor.name) + ": the topic " + topic + " of " +
                                                     in_quotes(what) + " belongs to " + other +
                                                     ", expected another one");
    }
  }
  check_command_topics(scene, node, user_of_topic, sensor_of_folder);
}

}  // namespace simvis
