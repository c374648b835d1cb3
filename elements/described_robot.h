// An element that gives ROS the description of a robot.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <simvis/location.h>

namespace simvis {

class DescribedRobot {
 public:
  virtual ~DescribedRobot() = default;
  virtual const std::string& topic() const = 0;
  virtual const Location& where() const = 0;    ///< of the topic's attribute, or of the element
  virtual const std::string& urdf() const = 0;  ///< xacro is expanded
  /// The mesh files that urdf() names and that were read, by these names.
  virtual const std::map<std::string, std::filesystem::path>& files() const = 0;
  virtual const std::vector<std::string>& points() const = 0;  ///< the insertion points of its links, and of its part
};

}  // namespace simvis
