// The element `robot_description`: sends the URDF of its part, and the frames of all its links.
//
//   <element type="robot_description" name="DESCRIPTION" insert_at="ARM"/>
//
// Parameters  none. It moves and draws nothing.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <simvis/element.h>
#include "elements/described_robot.h"

namespace simvis {

class RobotDescriptionElement : public Element, public DescribedRobot {
 public:
  /// Throws InputError: the insertion point is no part from a URDF file; the topic is no topic of ROS.
  explicit RobotDescriptionElement(const ElementContext& context);
  void update(ParameterView /*values*/) override {}

  const std::string& topic() const override { return topic_; }
  const Location& where() const override { return where_; }
  const std::string& urdf() const override { return urdf_; }
  const std::map<std::string, std::filesystem::path>& files() const override { return files_; }
  const std::vector<std::string>& points() const override { return points_; }

 private:
  Location where_;
  std::string topic_, urdf_;
  std::map<std::string, std::filesystem::path> files_;
  std::vector<std::string> points_;
};

}  // namespace simvis
