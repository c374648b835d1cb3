// Where the scanners stand and what their beams are, for peers that know no robot.
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

/// Of some scanners of a simulation, which must outlive it.
class PeerScans {
 public:
  using Drive = std::function<void(Simulation&, int frame)>;

  /// They are where `drive` has them in frame 0, and measure once.
  PeerScans(Simulation& simulation, const std::vector<std::string>& scanners, const Drive& drive);

  /// Switches all sensors of the simulation off, so that go_to() measures nothing.
  void rest();
  /// Takes the robot, and so the scanners, to where they are in a frame.
  void go_to(int frame);

  const std::vector<PeerScan>& scans() const { return scans_; }

 private:
  Simulation& simulation_;
  std::vector<std::string> scanners_;
  Drive drive_;
  std::vector<PeerScan> scans_;
};

}  // namespace simvis::bench
