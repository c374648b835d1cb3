// The sensors that a URDF file declares for Gazebo.
//
//   <gazebo reference="LINK"><sensor type="..." name="...">  the element of SDF, see import/sdf/sdf_commands.h
//   <gazebo><plugin filename="libhector_gazebo_ros_gps.so" or "libgazebo_ros_imu.so">  a sensor of <bodyName>
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <simvis/part_importer.h>
#include "import/model/import_report.h"
#include "import/urdf/urdf_dynamics.h"

namespace simvis {

/// Their commands, at the insertion points of their links, under the names of the file. A sensor that is wrong, or
/// whose link is not there, is left out with a warning; what has no counterpart is reported.
std::vector<std::string> urdf_sensor_commands(const std::shared_ptr<const UrdfSource>& source,
                                              const ImportRequest& request, ImportReport& report);

}  // namespace simvis
