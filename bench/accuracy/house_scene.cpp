#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "bench/accuracy/scenes.h"

namespace simvis::bench {

namespace {

/// Returns one <part> per row of: name, file, x y z (m), roll pitch yaw (radians), three scales, which are all 1.
std::string parts_xml(std::istream& csv) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::ostringstream xml;
  xml.precision(17);
  std::string line;
  std::getline(csv, line);
  while (std::getline(csv, line)) {
    std::istringstream cells(line);
    std::string name, file, numbers;
    std::getline(cells, name, ',');
    std::getline(cells, file, ',');
    std::getline(cells, numbers);
    std::ranges::replace(name, '/', '_');  // names must not contain it
    std::ranges::replace(numbers, ',', ' ');
    glm::dvec3 position_m, angles_rad;
    std::istringstream(numbers) >> position_m.x >> position_m.y >> position_m.z >> angles_rad.x >> angles_rad.y >>
        angles_rad.z;
    const glm::dvec3 angles_deg = angles_rad * kDegrees;
    xml << "<part file=\"" << file << "\" name=\"" << name << "\" insert_at=\"ROOT\" pose_offset=\"" << position_m.x
        << ' ' << position_m.y << ' ' << position_m.z << ' ' << angles_deg.x << ' ' << angles_deg.y << ' '
        << angles_deg.z << "\"/>\n";
  }
  return xml.str();
}

}  // namespace

std::optional<Simulation> load_house() {
  const std::filesystem::path folder = std::filesystem::path(SIMVIS_TEST_DATA) / "house";
  std::ifstream csv(folder / "parts.csv");
  if (!csv) return {};
  return Simulation::from_string(parts_xml(csv), {}, folder, "house.xml");
}

}  // namespace simvis::bench
