#include "bench/scan_curves/peer_scans.h"

#include <cmath>

namespace simvis::bench {

PeerScans::PeerScans(Simulation& simulation, const std::vector<std::string>& scanners, const Drive& drive)
    : simulation_(simulation), scanners_(scanners), drive_(drive), scans_(scanners.size()) {
  rest();
  for (const std::string& scanner : scanners_) simulation_.enable(scanner, true);
  go_to(0);
  rest();
  for (std::size_t i = 0; i < scanners_.size(); ++i) {
    const Scan& scan = simulation_.scan(scanners_[i]);
    scans_[i].azimuth_rad = scan.azimuth_rad;
    for (const double e : scan.elevation_rad) {
      for (const double a : scan.azimuth_rad) {
        scans_[i].directions.push_back(beam_direction(a, e));
      }
    }
  }
}

void PeerScans::rest() {
  for (const SensorInfo& sensor : simulation_.sensors()) simulation_.enable(sensor.name, false);
}

void PeerScans::go_to(int frame) {
  drive_(simulation_, frame);
  simulation_.step();
  for (std::size_t i = 0; i < scanners_.size(); ++i) {
    simulation_.sensor_pose(scanners_[i], scans_[i].world_from_sensor);
  }
}

}  // namespace simvis::bench
