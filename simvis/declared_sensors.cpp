#include "simvis/declared_sensors.h"

#include <algorithm>
#include <set>
#include <span>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/output_spec.h>
#include <simvis/sensor.h>
#include "engine/base/words.h"
#include "exchange/messages/from_pose.h"
#include "scenegraph/language/topic_name.h"
#include "simvis/ros/frame_tree.h"
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

// Whether images of the sensor have an optical frame.
bool has_optical_frame(std::span<const OutputSpec> outputs) {
  return has_content(outputs, ImageContent::color) || has_content(outputs, ImageContent::depth) ||
         has_content(outputs, ImageContent::counts);
}
bool has_optical_frame(const Command& sensor) {
  return has_optical_frame(outputs_of(*find_sensor_type(sensor.require("type").value), sensor));
}

class Adapter {
 public:
  Adapter(std::vector<Command>& commands, const PartContent& content, const SceneNames& names,
          const std::function<void(const std::string&)>& warn)
      : commands_(commands), content_(content), names_(names), warn_(warn) {}

  void run() {
    std::erase_if(commands_, [&](const Command& each) { return is_declared(each, content_) && leaves_out(each); });
    if (std::ranges::none_of(commands_, [&](const Command& each) { return is_declared(each, content_); })) return;
    note_names();
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

  // Those of all sensors, but for the topics and frames of declared ones, which are noted one after the other.
  void note_names() {
    frames_.emplace(ros::kWorldFrame);
    for (const std::string& each : names_.written_sensors) note_name(each);
    for (const BuiltSensor& each : names_.sensors) {
      note_name(each.name);
      note_topics(SensorTopics(each));
      const CommandAttribute* const frame = each.command.find("frame");
      note_frame(frame == nullptr ? each.name : frame->value, has_optical_frame(each.outputs));
    }
    for (const Command& each : commands_) {
      if (each.kind != CommandKind::sensor) continue;
      note_name(name_of(each));
      if (each.find("frame") == nullptr) note_frame(name_of(each), has_optical_frame(each));
    }
  }

  void note_name(const std::string& name) {
    frames_.insert(name);
    folders_.insert(folder_of(name));
  }
  void note_topics(const SensorTopics& topics) {
    folders_.insert(topics.folder());
    for (const auto& [what, topic] : topics.named()) topics_.insert(topic);
  }
  void note_frame(const std::string& frame, bool has_views) {
    frames_.insert(frame);
    if (!has_views) return;
    for (const char* const view : {"", "left", "right"}) frames_.insert(optical_frame(frame, view));
  }

  static std::string folder_of(const std::string& name) {
    std::string folder = topic_name(name, "");
    folder.pop_back();
    return folder;
  }

  // Whether a topic lies below the name of another sensor.
  bool is_sent_by_other(std::string_view topic, const std::string& own_folder) const {
    for (std::size_t at = topic.find('/', 1); at != topic.npos; at = topic.find('/', at + 1)) {
      const std::string folder(topic.substr(0, at));
      if (folder != own_folder && folders_.contains(folder)) return true;
    }
    return false;
  }

  void drop_topics(Command& sensor) {
    const std::string own_folder = folder_of(name_of(sensor));
    for (CommandAttribute& attribute : sensor.attributes) {
      if (attribute.name != "topics") continue;
      std::string kept;
      for (const std::string_view word : words_of(attribute.value)) {
        const std::string_view topic = word.substr(word.find('=') + 1);
        if (is_simulation_topic(topic)) {
          warn_drop(sensor, "topic", topic, "the simulation");
        } else if (is_sent_by_other(topic, own_folder) || !topics_.emplace(topic).second) {
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
    const CommandAttribute* const written = sensor.find("frame");
    if (written == nullptr) return;
    const std::string frame = written->value, name = name_of(sensor);
    const bool has_views = has_optical_frame(sensor), is_of_point = frame == sensor.require("insert_at").value;
    const auto is_taken = [&](const std::string& each) {
      return (each != name && frames_.contains(each)) || (!is_of_point && names_.is_point(each));
    };
    if ((is_of_point || !is_taken(frame)) && !(has_views && is_taken(optical_frame(frame, "")))) {
      return note_frame(frame, has_views);
    }
    warn_drop(sensor, "frame", frame);
    std::erase_if(sensor.attributes, [](const CommandAttribute& each) { return each.name == "frame"; });
    note_frame(name, has_views);
  }

  void warn_drop(const Command& sensor, const std::string& what, std::string_view name,
                 const std::string& owner = "another part or sensor") const {
    warn_(content_.file.string() + ": the " + what + " " + in_quotes(name) + " of the sensor " +
          in_quotes(name_of(sensor)) + " belongs to " + owner + "; it is left out");
  }

  std::vector<Command>& commands_;
  const PartContent& content_;
  const SceneNames& names_;
  const std::function<void(const std::string&)>& warn_;
  std::set<std::string> folders_, topics_, frames_;  // of sensors; names of sensors are frames, too
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
