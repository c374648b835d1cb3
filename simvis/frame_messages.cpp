#include "simvis/frame_messages.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include <simvis/error.h>
#include "elements/described_robot.h"
#include "exchange/messages/types/system_types.h"
#include "simvis/ros/object_markers.h"
#include "simvis/ros/sensor_topics.h"

namespace simvis {
namespace {

const std::string kObjectsTopic = "/simvis/objects";

ros::Parameter parameter_message(const Parameters& parameters, std::size_t index) {
  constexpr std::uint8_t kDouble = 3;
  ros::Parameter message;
  message.name = parameters.name(index);
  message.value.type = kDouble;
  message.value.double_value = parameters.values()[index];
  return message;
}

}  // namespace

std::vector<std::string> unmatched_warnings(std::string_view outlet, const ros::TopicFilter& topics) {
  std::vector<std::string> warnings;
  for (const std::string& pattern : topics.unmatched()) {
    warnings.push_back(std::string(outlet) + ": no topic has matched " + in_quotes(pattern));
  }
  return warnings;
}

void check_messages(const BuiltScene& scene, std::string_view node) {
  FrameTree().follow(scene);
  check_topics(scene, node);
}

FrameMessages::FrameMessages(ros::MessageOutlet& outlet, const BuiltScene& scene, std::string_view node)
    : outlet_(outlet), node_(node) {
  check_names(scene);
}

void FrameMessages::check_names(const BuiltScene& scene) {
  frames_.follow(scene);
  const std::size_t changes = count_changes(scene);
  if (checked_ == changes) return;
  checked_ = changes;
  std::set<std::size_t> ids;
  for (const BuiltSensor& sensor : scene.sensors) ids.insert(sensor.id);
  std::erase_if(sent_layouts_, [&](const auto& each) { return !ids.contains(each.first.first); });
  std::erase_if(sensors_before_, [&](const auto& each) { return !ids.contains(each.first); });
  std::erase_if(event_packets_, [&](const auto& each) { return !ids.contains(each.first); });
  check_topics(scene, node_);
}

void FrameMessages::add_frame(const Frame& frame) {
  const BuiltScene& scene = frame.scene;
  const std::span<const PlacedSensor> sensors = frame.sensors;
  check_names(scene);
  time_ = frame.time;
  class_names_ = [&frame] {
    ros::ClassNames names;
    for (const SceneObject& each : frame.objects()) {
      if (each.semantic != 0) names.emplace(each.semantic, each.label);
    }
    return names;
  };
  jobs_.clear();
  transforms_.begin(time_.time_ns);
  add("/clock", ros::Clock{ros::to_time(time_.time_ns)});
  add_parameters(scene.parameters);
  add_descriptions(scene);
  add_warnings(scene.scene.warnings());
  frames_.update(scene, sensors);
  for (const FrameTransform& each : frames_.transforms()) {
    transforms_.set(each.parent, each.child, each.parent_from_child, each.moves);
  }
  add_objects(frame);
  add_bodies(sensors);
  add_poses(sensors);
  add_measurements(sensors);
  if (const std::optional<ros::TFMessage> fixed = transforms_.new_fixed()) {
    add("/tf_static", *fixed, ros::Durability::latched);
  }
  if (!transforms_.moving().transforms.empty()) add("/tf", transforms_.moving());
  for (Pending& each : jobs_) {
    if (outlet_.add(std::move(each.job)) && each.layout != nullptr) *each.layout = std::move(each.numbers);
  }
}

void FrameMessages::add_objects(const Frame& frame) {
  if (!outlet_.wants<ros::MarkerArray>(kObjectsTopic, ros::TopicForm::other)) return;
  ros::MarkerArray markers = object_markers(frame.objects(), frame.list, frames_.world(), time_.time_ns);
  outlet_.add({.run = [time_ns = time_.time_ns, markers = std::move(markers)](ros::MessageSink& sink) {
    sink.write(kObjectsTopic, time_ns, markers);
  }});
}

void FrameMessages::add_bodies(std::span<const PlacedSensor> sensors) {
  std::set<std::string> points;  // that carry sensors
  for (const PlacedSensor& placed : sensors) points.insert(insertion_point(placed.sensor));
  for (const auto& [point, world_from_point] : frames_.world_from_point()) {
    if (!points.contains(point)) continue;
    Body& body = bodies_[point];
    const ros::PoseAt now{time_.time_ns, world_from_point};
    if (body.before) {
      add(ros::topic_name(point, "odom"), ros::odometry(*body.before, now, frames_.world(), frames_.of_point(point)));
    }
    if (outlet_.wants<ros::Path>(ros::topic_name(point, "path"), ros::TopicForm::at_end)) body.path.add(now);
    body.before = now;
  }
}

void FrameMessages::add_poses(std::span<const PlacedSensor> sensors) {
  for (const auto& [sensor, world_from_sensor, measurement] : sensors) {
    if (measurement == nullptr) continue;
    const SensorTopics topics(sensor);
    const ros::PoseAt now{time_.time_ns, world_from_sensor};
    add(topics.of("pose"), ros::pose_stamped(now, frames_.world()));
    const auto [before, is_first] = sensors_before_.try_emplace(sensor.id, now);
    if (is_first) continue;
    add(topics.of("twist"), ros::TwistStamped{ros::header_of(time_.time_ns, frames_.of_sensor(sensor)),
                                              ros::mean_twist(before->second, now)});
    before->second = now;
  }
}

void FrameMessages::add_measurements(std::span<const PlacedSensor> sensors) {
  for (const PlacedSensor& placed : sensors) {
    if (placed.measurement != nullptr) add_measurement(placed);
  }
}

// The first event after frames without a listener has all parameters, as new ones. Listeners that come later get all
// values from the services of the node.
void FrameMessages::add_parameters(const Parameters& parameters) {
  if (!outlet_.wants<ros::ParameterEvent>("/parameter_events")) return values_.clear();
  ros::ParameterEvent event;
  event.stamp = ros::to_time(time_.time_ns);
  event.node = node_;
  const std::span<const double> values = parameters.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::optional<double> now = parameters.is_removed(i) ? std::nullopt : std::optional(values[i]);
    const std::optional<double> before = i < values_.size() ? values_[i] : std::nullopt;
    if (now == before) continue;
    (!before ? event.new_parameters
     : now   ? event.changed_parameters
             : event.deleted_parameters)
        .push_back(parameter_message(parameters, i));
    values_.resize(std::max(values_.size(), i + 1));
    values_[i] = now;
  }
  const bool changes =
      !event.new_parameters.empty() || !event.changed_parameters.empty() || !event.deleted_parameters.empty();
  if (changes) add("/parameter_events", event);
}

// Once for each robot, when it is new.
void FrameMessages::add_descriptions(const BuiltScene& scene) {
  const std::size_t changes = scene.parameters.changes().size();
  if (std::exchange(described_changes_, changes) == changes) return;
  for (const std::unique_ptr<Element>& element : scene.elements) {
    const auto* const robot = dynamic_cast<const DescribedRobot*>(element.get());
    if (robot == nullptr || std::exchange(descriptions_[robot->topic()], robot->urdf()) == robot->urdf()) continue;
    add(robot->topic(), ros::String{robot->urdf()}, ros::Durability::latched);
  }
}

// Whether the topic is wanted is asked in each frame, so that patterns match it before the first warning.
void FrameMessages::add_warnings(const std::vector<std::string>& warnings) {
  constexpr std::byte kWarn{1};
  const std::string topic = "/diagnostics";
  if (!outlet_.wants<ros::DiagnosticArray>(topic)) warnings_ = warnings.size();
  if (warnings_ >= warnings.size()) return;
  ros::DiagnosticArray message;
  message.header = ros::header_of(time_.time_ns, "");
  for (; warnings_ < warnings.size(); ++warnings_) {
    message.status.push_back({kWarn, "simvis", warnings[warnings_], "", {}});
  }
  add(topic, message);
}

void FrameMessages::add_paths() {
  for (auto& [point, body] : bodies_) {
    ros::Path path{ros::header_of(time_.time_ns, frames_.world()), {}};
    for (const ros::PoseAt& pose : body.path.poses()) path.poses.push_back(ros::pose_stamped(pose, frames_.world()));
    if (!path.poses.empty()) add(ros::topic_name(point, "path"), std::move(path));
  }
  bodies_.clear();
}

}  // namespace simvis
