// The names of a sensor's ROS messages: those that its plug-ins give them in Gazebo, or its own elements.
//
//   <plugin filename="libgazebo_ros_*.so">, ROS 1: robotNamespace; topicName; of cameras cameraName, imageTopicName,
//           cameraInfoTopicName, depthImageTopicName, depthImageCameraInfoTopicName, pointCloudTopicName; frameName
//   the same, ROS 2: <ros> with <namespace> and <remapping> NAME:=TOPIC; camera_name; output_type; frame_name
//   gz-sim: <topic>, <gz_frame_id>, <ignition_frame_id> of the sensor
//
// They become the attributes `topics` and `frame`. A topic that the sensor has by its name is not written, nor is one
// of a message that it does not send. A topic that another sensor of the file has already, a name that ROS 2 does not
// take, and a frame that is a link other than the sensor's own are reported, and so is any other plug-in.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "import/sdf/sdf_command.h"
#include "import/sdf/sdf_element.h"

namespace simvis {

class SdfMessages {
 public:
  /// `links` are the names of the file's links, which have frames of their own.
  explicit SdfMessages(std::set<std::string> links = {}) : links_(std::move(links)) {}

  /// The sensor of the command stands at `place` with an offset or without one.
  void add(const SdfElement& sensor, const SdfPlace& place, bool has_offset, SdfCommand& command, ImportReport& report);
  /// Of a plug-in that is a sensor by itself.
  void add_plugin(const SdfElement& plugin, const SdfPlace& place, SdfCommand& command, ImportReport& report);

 private:
  struct Names {
    std::vector<std::pair<std::string, std::string>> topics;  // by kind of message
    std::string frame;
    SdfElement where;
  };
  void write(const Names& names, const SdfPlace& place, bool has_offset, SdfCommand& command, ImportReport& report);
  static void read_plugin(const SdfElement& plugin, const SdfCommand& command, const std::string& sensor, Names& names,
                          ImportReport& report);

  std::set<std::string> links_, topics_, frames_;
};

}  // namespace simvis
