// A simulation as ROS 2 messages: says which messages a frame gives. docs/messages.md lists them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation_desc.h>
#include "messages/from_pose.h"
#include "messages/from_scan.h"
#include "messages/image_copies.h"
#include "messages/recorder.h"
#include "messages/topics.h"
#include "messages/transforms.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// Which messages there are, and where they go.
struct RecordingDesc {
  std::vector<std::string> topics{};  ///< as RecordDesc::topics
  bool drop = false;                  ///< as RecordDesc::drop
  /// Called with the first frame.
  std::function<std::unique_ptr<ros::MessageOutlet>()> open_outlet{};
};

/// Of a file. Throws InputError: it exists and is no MCAP file.
RecordingDesc recording_to_file(const RecordDesc& desc);

/// A sensor that is on, and where it stands in a frame.
struct PlacedSensor {
  const BuiltSensor& sensor;
  glm::dmat4 world_from_sensor{1.0};
  bool measured = false;  ///< in this frame
};

class Recording {
 public:
  /// Throws InputError: two sensors would have the same topics.
  Recording(RecordingDesc desc, const BuiltScene& scene);
  /// As finish(); errors are lost.
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Opens the outlet with the first frame. Throws MachineError of the outlet, also of earlier frames.
  void add_frame(const BuiltScene& scene, const FrameTime& time, std::span<const PlacedSensor> sensors);
  /// Writes what waits, and finishes the outlet. Throws MachineError. The report names no file.
  RecordReport finish();

  /// A text of the last frame that no measurement gives.
  void add_text(const std::string& topic, std::string text);

  /// The patterns of RecordingDesc::topics that no topic has matched so far.
  std::vector<std::string> unmatched_patterns() const { return topics_.unmatched(); }

 private:
  class SensorMessages;
  using WhenFull = ros::Recorder::WhenFull;
  struct Job {
    std::size_t held_bytes;
    std::uint64_t messages;
    ros::Recorder::Job run;
  };
  // What the attributes of a sensor say of its ranges.
  struct RangeFacts {
    ros::RangeLimits limits;
    double field_of_view_rad = 0;
  };
  struct Body {
    std::optional<ros::PoseAt> before;
    ros::Path path;
  };

  void check_names(const BuiltScene& scene);
  std::string sensor_frame(const BuiltScene& scene, const std::string& name) const;
  const RangeFacts& range_facts(const BuiltSensor& sensor);
  template <ros::Message M>
  void add(const std::string& topic, M message, ros::Durability durability = ros::Durability::transient);
  void add_bodies(const BuiltScene& scene, std::span<const PlacedSensor> sensors);
  void add_poses(const BuiltScene& scene, std::span<const PlacedSensor> sensors);
  void add_measurements(const BuiltScene& scene, std::span<const PlacedSensor> sensors);
  void add_parameters(const Parameters& parameters);
  void add_warnings(const std::vector<std::string>& warnings);
  void add_paths();

  RecordingDesc desc_;
  ros::TopicFilter topics_;
  std::optional<ros::Recorder> recorder_;
  FrameTime time_;  // of the frame that is being added
  ros::Transforms transforms_;
  std::map<std::string, glm::dmat4> world_from_body_;  // in this frame
  std::map<std::string, Body> bodies_;
  std::map<std::size_t, ros::PoseAt> sensors_before_;  // by id
  std::map<std::size_t, RangeFacts> range_facts_;      // by id of the sensor
  std::vector<Job> jobs_;                              // of this frame's measurements
  ros::ImageCopies copies_;
  std::size_t checked_ids_ = 0, warnings_ = 0;
  std::vector<std::optional<double>> values_;  // of parameters, as they were written; empty: of a removed element
  std::uint64_t dropped_ = 0;
};

}  // namespace simvis
