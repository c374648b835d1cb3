#include "import/sdf/sdf_messages.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "engine/base/words.h"
#include "import/sdf/sdf_camera_types.h"
#include "scenegraph/language/frame_name.h"
#include "scenegraph/language/topic_name.h"

namespace simvis {
namespace {

struct NamedTag {
  const char* tag;
  const char* what;  // the kind of message
};
constexpr NamedTag kCameraTags[] = {{"imageTopicName", "image_raw"},
                                    {"cameraInfoTopicName", "camera_info"},
                                    {"depthImageTopicName", "depth/image_raw"},
                                    {"depthImageInfoTopicName", "depth/camera_info"},
                                    {"depthImageCameraInfoTopicName", "depth/camera_info"},
                                    {"pointCloudTopicName", "points"}};
// What a camera of ROS 2 sends without being asked. Its depth clouds are large, and come by a <remapping>.
constexpr std::string_view kUnasked[] = {"image_raw", "camera_info", "depth/image_raw", "depth/camera_info"};
// The messages at <topic> of a camera of gz-sim, by the outputs of its type, and what follows the topic in their names.
struct OwnTopic {
  std::string_view outputs;
  const char* what;
  const char* ending;
};
constexpr OwnTopic kOwnTopics[] = {{"color", "image_raw", ""},
                                   {"depth", "depth/image_raw", ""},
                                   {"color depth", "image_raw", "/image"},
                                   {"color depth", "depth/image_raw", "/depth_image"},
                                   {"color depth", "points", "/points"}};
// The message of a sensor that sends one, by its type.
constexpr NamedTag kMessages[] = {{"imu", "imu"},
                                  {"gnss", "fix"},
                                  {"magnetometer", "magnetic_field"},
                                  {"barometer", "pressure"},
                                  {"thermal_camera", "thermal/image_raw"},
                                  {"force_torque", "wrench"}};
constexpr const char* kTopicTags[] = {"topicName", "topic_name", "topic"};
constexpr const char* kFrameTags[] = {"frameName", "frame_name", "frameId", "frame_id"};
constexpr const char* kOwnFrameTags[] = {"gz_frame_id", "ignition_frame_id", "frame_id"};
// Parts of the file names of plug-ins that publish a sensor.
constexpr std::string_view kPublishers[] = {"gazebo_ros_", "hector_gazebo", "velodyne_laser"};

constexpr const char* kRemapping = "a <remapping> of a message that the sensor does not send";

std::string first_text(const SdfElement& parent, std::span<const char* const> tags) {
  for (const char* const tag : tags) {
    if (const SdfElement found = parent.child(tag); found && !found.text().empty()) return found.text();
  }
  return "";
}

/// A topic in a namespace, as ROS resolves it.
std::string resolved(const std::string& space, const std::string& topic) {
  if (topic.starts_with('/')) return topic;
  std::string all;
  for (const std::string& part : {space, topic}) {
    const std::size_t first = part.find_first_not_of('/');
    if (first != part.npos) all += "/" + part.substr(first, part.find_last_not_of('/') + 1 - first);
  }
  return all;
}

bool is_publisher(const SdfElement& plugin) {
  const std::string file = plugin.attribute("filename");
  return std::ranges::any_of(kPublishers, [&](std::string_view part) { return file.find(part) != file.npos; });
}

std::string message_of(std::string_view type, const SdfElement& plugin) {
  if (type == "laser_scanner") {
    const std::string file = plugin.attribute("filename"), form = plugin.child("output_type").text();
    const bool is_cloud = form.find("PointCloud") != form.npos || file.find("velodyne") != file.npos ||
                          file.find("block_laser") != file.npos;
    return is_cloud ? "points" : "scan";
  }
  const auto* const found =
      std::ranges::find_if(kMessages, [&](const NamedTag& each) { return type == std::string_view(each.tag); });
  return found == std::end(kMessages) ? "" : found->what;
}

/// Whether a camera sends this kind of message, as its outputs are.
bool is_sent(std::string_view what, const SdfCommand& camera) {
  const bool is_of_depth = what.starts_with("depth/") || what == "points";
  const std::vector<std::string_view> outputs = words_of(camera.find("outputs"));
  return std::ranges::count(outputs, std::string_view(is_of_depth ? "depth" : "color")) > 0;
}

/// <remapping>OWN:=TOPIC</remapping> of a plug-in of ROS 2, by OWN without ~ and / in front.
std::vector<std::pair<std::string, std::string>> remappings(const SdfElement& ros) {
  constexpr std::string_view kIs = ":=";
  std::vector<std::pair<std::string, std::string>> all;
  for (const SdfElement& child : ros.children()) {
    if (child.tag() != "remapping" && child.tag() != "argument") continue;
    const std::string text = child.text();
    const std::size_t is = text.find(kIs);
    if (is == text.npos) continue;
    std::string own = text.substr(0, is);
    own.erase(0, std::min(own.find_first_not_of("~/"), own.size()));
    all.emplace_back(std::move(own), text.substr(is + kIs.size()));
  }
  return all;
}

}  // namespace

void SdfMessages::read_plugin(const SdfElement& plugin, const SdfCommand& command, const std::string& sensor,
                              Names& names, ImportReport& report) {
  const std::string& type = command.type();
  const SdfElement ros = plugin.child("ros");
  const std::string space = ros ? ros.child("namespace").text() : plugin.child("robotNamespace").text();
  const auto add = [&](std::string what, const std::string& topic) {
    if (!what.empty() && !topic.empty()) names.topics.emplace_back(std::move(what), resolved(space, topic));
  };
  if (type == "camera") {
    const std::string base = (ros ? plugin.child("camera_name") : plugin.child("cameraName")).text();
    const std::string camera = ros && base.empty() ? sensor : base;
    for (const NamedTag& each : kCameraTags) {
      if (!is_sent(each.what, command) || (ros && std::ranges::count(kUnasked, each.what) == 0)) continue;
      const std::string own = ros ? each.what : plugin.child(each.tag).text();
      if (own.empty() || camera.empty()) continue;
      add(each.what, own.starts_with('/') ? own : camera + "/" + own);
    }
    for (const auto& [own, topic] : remappings(ros)) {
      const std::string kind = own.starts_with(camera + "/") ? own.substr(camera.size() + 1) : own;
      if (std::ranges::count(kCameraTags, kind, &NamedTag::what) == 0 || !is_sent(kind, command)) {
        report.leave_out(kRemapping, plugin.at());
        continue;
      }
      std::erase_if(names.topics, [&](const auto& each) { return each.first == kind; });
      add(kind, topic);
    }
  } else {
    const std::string what = message_of(type, plugin);
    add(what, first_text(plugin, kTopicTags));
    for (const auto& [own, topic] : remappings(ros)) {
      if (own == "out") {
        add(what, topic);
      } else {
        report.leave_out(kRemapping, plugin.at());
      }
    }
  }
  if (std::string frame = first_text(plugin, kFrameTags); !frame.empty()) names.frame = std::move(frame);
  names.where = plugin;
}

void SdfMessages::add(const SdfElement& sensor, const SdfPlace& place, bool has_offset, SdfCommand& command,
                      ImportReport& report) {
  Names names{.topics = {}, .frame = first_text(sensor, kOwnFrameTags), .where = sensor};
  if (const std::string topic = sensor.child("topic").text(); !topic.empty()) {
    const SdfCameraType* const camera = find_sdf_camera_type(sensor.attribute("type"));
    for (const OwnTopic& each : kOwnTopics) {
      if (camera == nullptr || camera->outputs != each.outputs) continue;
      names.topics.emplace_back(each.what, resolved("", topic + each.ending));
    }
    const std::string what = message_of(command.type(), sensor);
    if (!what.empty()) names.topics.emplace_back(what, resolved("", topic));
    if (what == "scan") names.topics.emplace_back("points", resolved(topic, "points"));
  }
  for (const SdfElement& child : sensor.children()) {
    if (child.tag() != "plugin") continue;
    if (is_publisher(child)) {
      read_plugin(child, command, place.name, names, report);
    } else {
      report.leave_out("element <plugin>", child.at());
    }
  }
  write(names, place, has_offset, command, report);
}

void SdfMessages::add_plugin(const SdfElement& plugin, const SdfPlace& place, SdfCommand& command,
                             ImportReport& report) {
  Names names;
  read_plugin(plugin, command, place.name, names, report);
  write(names, place, false, command, report);
}

void SdfMessages::write(const Names& names, const SdfPlace& place, bool has_offset, SdfCommand& command,
                        ImportReport& report) {
  std::string topics;
  std::set<std::string> kinds;
  for (const auto& [what, topic] : names.topics) {
    if (!kinds.insert(what).second) continue;
    if (!is_topic_name(topic) || !topics_.insert(topic).second) {
      report.leave_out("a topic that ROS 2 does not take or that another sensor of the file has", names.where.at());
      continue;
    }
    if (topic == topic_name(place.name, what) && what != "points") continue;  // the topic that it has anyway
    topics += (topics.empty() ? "" : " ") + what + ":=" + topic;
  }
  if (!topics.empty()) command.add("topics", topics);
  std::string frame = names.frame.substr(std::min(names.frame.find_first_not_of('/'), names.frame.size()));
  if (frame.empty()) return;
  const bool is_camera = command.type() == "camera";
  const bool is_own_link = frame == place.insert_at && !has_offset;
  // The images of a camera have the frame of the sensor with this ending.
  constexpr std::string_view kOptical = "_optical";
  if (is_camera && frame.ends_with("_optical_frame") && !links_.contains(frame)) {
    return report.leave_out("an optical frame of a camera whose name does not end in _optical", names.where.at());
  }
  if (is_camera && frame.ends_with(kOptical) && !links_.contains(frame)) {
    frame.erase(frame.size() - kOptical.size());
  }
  const bool is_new = is_own_link || (!links_.contains(frame) && frames_.insert(frame).second);
  if (is_new && is_frame_name(frame)) return command.add("frame", frame);
  report.leave_out("a frame of a sensor that is another link, or another sensor's", names.where.at());
}

}  // namespace simvis
