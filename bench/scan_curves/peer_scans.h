// Poses and beams of the scanners, for peers without a robot.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include <simvis/simulation.h>

namespace simvis::bench {

struct PeerScan {
  glm::dmat4 world_from_sensor{1.0};
  std::vector<double> azimuth_rad;
  std::vector<glm::dvec3> directions;  ///< in the sensor frame, unit; in order of ring and azimuth
};

/// The scans of some scanners of a simulation, which must outlive this object.
class PeerScans {
 public:
  using Drive = std::function<void(Simulation&, int frame)>;

  /// Drives to frame 0 and measures once.
  PeerScans(Simulation& simulation, const std::vector<std::string>& scanners, const Drive& drive);

  /// Switches all sensors of the simulation off, so that go_to() measures nothing.
  void rest();
  /// Moves the robot, and with it the scanners, to its pose in a frame.
  void go_to(int frame);

  const std::vector<PeerScan>& scans() const { return scans_; }

 private:
  Simulation& simulation_;
  std::vector<std::string> scanners_;
  Drive drive_;
  std::vector<PeerScan> scans_;
};

}  // namespace simvis::bench
