#include "simvis/ros/sensor_topics.h"

#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "elements/described_robot.h"
#include "scenegraph/language/frame_name.h"
#include "scenegraph/language/topic_name.h"

namespace simvis {
namespace {

constexpr std::string_view kTopics = "topics", kIs = ":=", kRest = "*";
// Topics of the whole simulation.
constexpr std::string_view kTakenTopics[] = {"/clock",       "/tf",     "/tf_static",        "/parameter_events",
                                             "/diagnostics", "/rosout", "/robot_description"};

std::vector<std::pair<std::string, std::string>> read_topics(const CommandAttribute& attribute) {
  std::vector<std::pair<std::string, std::string>> topics;
  std::istringstream in(attribute.value);
  for (std::string word; in >> word;) {
    const std::size_t is = word.find(kIs);
    const std::string what = word.substr(0, is), topic = is == word.npos ? "" : word.substr(is + kIs.size());
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

}  // namespace

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

void check_topics(const BuiltScene& scene) {
  std::map<std::string, std::string> sensor_of_folder, user_of_topic;
  for (const std::string_view topic : kTakenTopics) user_of_topic.emplace(topic, "the simulation");
  for (const std::unique_ptr<Element>& element : scene.elements) {
    const auto* const robot = dynamic_cast<const DescribedRobot*>(element.get());
    if (robot != nullptr) user_of_topic.emplace(robot->topic(), "the element robot_description");
  }
  for (const BuiltSensor& sensor : scene.sensors) {
    const std::string folder = SensorTopics(sensor).folder();
    const auto [known, is_new] = sensor_of_folder.emplace(folder, sensor.name);
    if (!is_new) {
      throw InputError("sensors " + in_quotes(known->second) + " and " + in_quotes(sensor.name) +
                       " would have the same topics, such as " + folder +
                       "/pose, expected names that differ in letters or digits");
    }
    const CommandAttribute* const point = sensor.command.find("insert_at");
    if (point == nullptr) continue;
    for (const char* const what : {"odom", "path"}) {
      user_of_topic.emplace(topic_name(point->value, what), "the part " + in_quotes(point->value));
    }
  }
  for (const BuiltSensor& sensor : scene.sensors) {
    const SensorTopics topics(sensor);
    for (const auto& [what, topic] : topics.named()) {
      const auto [known, is_new] = user_of_topic.emplace(topic, "the sensor " + in_quotes(sensor.name));
      const auto below = std::ranges::find_if(sensor_of_folder, [&, topic = std::string_view(topic)](const auto& each) {
        return is_below(topic, each.first);
      });
      if (is_new && below == sensor_of_folder.end() && !topic.starts_with("/simvis/")) continue;
      const std::string other = !is_new                           ? known->second
                                : below == sensor_of_folder.end() ? "the simulation"
                                                                  : "the sensor " + in_quotes(below->second);
      throw InputError("sensor " + in_quotes(sensor.name) + ": the topic " + topic + " of " + in_quotes(what) +
                       " belongs to " + other + ", expected another one");
    }
  }
}

}  // namespace simvis
