#include "simvis/declared_sensors.h"

#include <algorithm>
#include <map>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/sensor.h>
#include "engine/base/words.h"
#include "scenegraph/language/topic_name.h"
#include "simvis/ros/sensor_topics.h"

namespace simvis {
namespace {

std::string name_of(const Command& command) { return command.require("name").value; }

// Why the type of the sensor does not take its command; empty: it does. References to the scene are not checked.
std::string refusal(const Command& sensor) {
  const SensorType& type = *find_sensor_type(sensor.require("type").value);
  try {
    const std::vector<AttributeSpec> table = all_attributes(type);
    const AttributeValues attributes(sensor, table, kSensorCommonAttributes);
    check_message_names(sensor);
    type.create({.command = sensor, .attributes = attributes, .name = name_of(sensor), .seed = 0});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class Adapter {
 public:
  Adapter(std::vector<Command>& commands, const PartContent& content, const SceneNames& names,
          const std::function<void(const std::string&)>& warn)
      : commands_(commands), content_(content), names_(names), warn_(warn) {}

  void run() {
    std::erase_if(commands_, [&](const Command& each) { return is_declared(each, content_) && leaves_out(each); });
    for (Command& each : commands_) {
      if (!is_declared(each, content_)) continue;
      drop_topics(each);
      drop_frame(each);
    }
  }

 private:
  bool leaves_out(const Command& sensor) const {
    const std::string quoted = in_quotes(name_of(sensor));
    if (names_.written_sensors.contains(name_of(sensor))) {
      warn_(content_.file.string() + ": the scene has a sensor " + quoted + " of its own; the file's is left out");
      return true;
    }
    const std::string why = refusal(sensor);
    if (!why.empty()) warn_(content_.file.string() + ": the sensor " + quoted + " is left out: " + why);
    return !why.empty();
  }

  template <class Test>
  bool any_other_sensor(const Command& sensor, const Test& test) const {
    return std::ranges::any_of(names_.written_sensors, test) ||
           std::ranges::any_of(names_.sensors, test, &BuiltSensor::name) ||
           std::ranges::any_of(commands_, [&](const Command& other) {
             return other.kind == CommandKind::sensor && &other != &sensor && test(name_of(other));
           });
  }

  void drop_topics(Command& sensor) {
    for (CommandAttribute& attribute : sensor.attributes) {
      if (attribute.name != "topics") continue;
      std::string kept;
      for (const std::string_view word : words_of(attribute.value)) {
        const std::string_view topic = word.substr(word.find('=') + 1);
        const auto is_sender = [&](const std::string& other) { return topic.starts_with(topic_name(other, "")); };
        const auto has_it = [&](const BuiltSensor& other) {
          const std::map<std::string, std::string> named = SensorTopics(other).named();
          return std::ranges::any_of(named, [&](const auto& each) { return each.second == topic; });
        };
        if (any_other_sensor(sensor, is_sender) || std::ranges::any_of(names_.sensors, has_it)) {
          warn_drop(sensor, "topic", topic);
        } else {
          kept += (kept.empty() ? "" : " ") + std::string(word);
        }
      }
      attribute.value = kept;
    }
    std::erase_if(sensor.attributes,
                  [](const CommandAttribute& each) { return each.name == "topics" && each.value.empty(); });
  }

  void drop_frame(Command& sensor) {
    const CommandAttribute* const frame = sensor.find("frame");
    if (frame == nullptr || frame->value == sensor.require("insert_at").value) return;
    const bool is_taken = names_.is_point(frame->value) ||
                          any_other_sensor(sensor, [&](const std::string& other) { return other == frame->value; });
    if (!is_taken) return;
    warn_drop(sensor, "frame", frame->value);
    std::erase_if(sensor.attributes, [](const CommandAttribute& each) { return each.name == "frame"; });
  }

  void warn_drop(const Command& sensor, const std::string& what, std::string_view name) const {
    warn_(content_.file.string() + ": the " + what + " " + in_quotes(name) + " of the sensor " +
          in_quotes(name_of(sensor)) + " belongs to another part or sensor; it is left out");
  }

  std::vector<Command>& commands_;
  const PartContent& content_;
  const SceneNames& names_;
  const std::function<void(const std::string&)>& warn_;
};

}  // namespace

// SimVis' readers of models alone give a description of the links.
bool is_declared(const Command& command, const PartContent& content) {
  return command.kind == CommandKind::sensor && content.model != nullptr;
}

void adapt_declared_sensors(std::vector<Command>& commands, const PartContent& content, const SceneNames& names,
                            const std::function<void(const std::string&)>& warn) {
  Adapter(commands, content, names, warn).run();
}

}  // namespace simvis
