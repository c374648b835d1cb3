// A simulation as ROS 2 messages: says which messages a frame gives. docs/messages.md lists them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "exchange/messages/detections.h"
#include "exchange/messages/from_events.h"
#include "exchange/messages/from_pose.h"
#include "exchange/messages/from_scan.h"
#include "exchange/messages/message_outlet.h"
#include "exchange/messages/topics.h"
#include "exchange/messages/transforms.h"
#include "simvis/frame.h"
#include "simvis/ros/body_path.h"
#include "simvis/ros/frame_tree.h"
#include "simvis/ros/node_name.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// A warning of `outlet` for each pattern that no topic has matched so far.
std::vector<std::string> unmatched_warnings(std::string_view outlet, const ros::TopicFilter& topics);

/// Throws InputError if frames of this scene have no messages: two sensors would have the same topics, two frames one
/// name, or a topic is one of the node with this full name.
void check_messages(const BuiltScene& scene, std::string_view node = kDefaultNode);

/// Jobs hold the images and scans that they read; nothing is copied.
class FrameMessages {
 public:
  /// `outlet` must outlive this object. `node` is the full name of the node that sends. Throws InputError as
  /// check_messages().
  FrameMessages(ros::MessageOutlet& outlet, const BuiltScene& scene, std::string_view node = kDefaultNode);
  FrameMessages(const FrameMessages&) = delete;
  FrameMessages& operator=(const FrameMessages&) = delete;

  /// Throws what the outlet throws, and InputError as check_messages() for a scene that has changed.
  void add_frame(const Frame& frame);
  /// Adds the paths that bodies have taken, after the last frame.
  void add_paths();

 private:
  class SensorMessages;
  struct Pending {
    ros::MessageJob job;
    MeasuredNumbers* layout;  // in sent_layouts_; null: the job sends none
    MeasuredNumbers numbers;  // of the layout that it sends
  };
  struct Body {
    std::optional<ros::PoseAt> before;
    BodyPath path;
  };

  void check_names(const BuiltScene& scene);
  template <ros::Message M>
  void add(const std::string& topic, M message, ros::Durability durability = ros::Durability::transient) {
    if (!outlet_.wants<M>(topic, ros::TopicForm::own, durability)) return;
    outlet_.add({.run = [=, time = time_.time_ns, message = std::move(message)](ros::MessageSink& sink) {
      sink.write(topic, time, message, durability);
    }});
  }
  void add_objects(const Frame& frame);
  void add_bodies(std::span<const PlacedSensor> sensors);
  void add_poses(std::span<const PlacedSensor> sensors);
  void add_measurements(std::span<const PlacedSensor> sensors);
  void add_measurement(const PlacedSensor& placed);  // sensor_messages.cpp
  void add_parameters(const Parameters& parameters);
  void add_descriptions(const BuiltScene& scene);
  void add_warnings(const std::vector<std::string>& warnings);

  ros::MessageOutlet& outlet_;
  std::string node_;
  FrameTime time_;                                // of the frame that is being added
  std::function<ros::ClassNames()> class_names_;  // of that frame; valid while it is added
  FrameTree frames_;
  ros::Transforms transforms_;
  std::map<std::string, Body> bodies_;
  std::map<std::size_t, ros::PoseAt> sensors_before_;      // by id
  std::map<std::size_t, ros::PacketPlace> event_packets_;  // the next one's, by id
  std::vector<Pending> jobs_;                              // of this frame's measurements
  // Layouts of scans as they were sent, by id and output. A sensor writes a new one to other memory.
  std::map<std::pair<std::size_t, std::string>, MeasuredNumbers> sent_layouts_;
  std::size_t checked_ = 0, warnings_ = 0, described_changes_ = 0;
  std::map<std::string, std::string> descriptions_;  // URDF that was sent, by topic
  std::vector<std::optional<double>> values_;  // of parameters, as messages said them; empty: of a removed element
};

}  // namespace simvis
