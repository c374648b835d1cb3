// The ravon scene itself: its generator, its size, and whether robot and scanner stand on the ground that ground.csv
// describes.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>

TEST_SUITE_BEGIN("scenes");

namespace {

using namespace simvis;

const std::filesystem::path kRavonFolder = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/ravon";

using Rows = std::vector<std::vector<double>>;

/// The numbers of a CSV file, without its header.
Rows read_table(const std::filesystem::path& path, const std::string& expected_header) {
  std::ifstream file(path);
  std::string line;
  REQUIRE(std::getline(file, line));
  CHECK(line == expected_header);
  Rows rows;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream text(line);
    std::vector<double> row;
    for (double value; text >> value;) row.push_back(value);
    rows.push_back(row);
  }
  return rows;
}

/// The height function of scenes/ravon/ground.py, for places nearer to the origin than its hills.
class Ground {
 public:
  Ground() : waves_(read_table(kRavonFolder / "ground.csv", "amplitude_m,kx_rad_per_m,ky_rad_per_m,phase_rad")) {
    REQUIRE(waves_.size() > kFineWaves);
  }

  double height_m(double x, double y) const {
    constexpr double kHollowWidth = 1.7, kHollowDepth = 0.13, kRutOffset = 0.62, kRutWidth = 0.22, kRutDepth = 0.06;
    const double path_y = 2.6 * std::sin(0.1366 * x + 0.4) + 0.9 * std::sin(0.2732 * x + 1.2);
    const double slope = 2.6 * 0.1366 * std::cos(0.1366 * x + 0.4) + 0.9 * 0.2732 * std::cos(0.2732 * x + 1.2);
    const double d = (y - path_y) / std::sqrt(1 + slope * slope);
    const double worn = bell(d / kHollowWidth);
    const double ruts = bell((d - kRutOffset) / kRutWidth) + bell((d + kRutOffset) / kRutWidth);
    const double bank = 1.3 * (1 - bell(y / 14)) + 0.9 * std::tanh(y / 25);
    const std::size_t coarse = waves_.size() - kFineWaves;
    return waves(x, y, 0, coarse) + waves(x, y, coarse, waves_.size()) * (1 - 0.6 * worn) + bank - kHollowDepth * worn -
           kRutDepth * ruts;
  }

  /// The mesh of the ground near the path: cells of kCell_m, each cut from its lower left to its upper right corner,
  /// the height function at their corners. Sets `slope` to that of the facet.
  double facet_height_m(double x, double y, double& slope) const {
    const double i = std::floor(x / kCell_m.x), j = std::floor(y / kCell_m.y);
    const double u = x / kCell_m.x - i, v = y / kCell_m.y - j;
    const auto corner = [&](double di, double dj) { return height_m((i + di) * kCell_m.x, (j + dj) * kCell_m.y); };
    const double a = corner(0, 0), c = corner(1, 1), other = u >= v ? corner(1, 0) : corner(0, 1);
    const double along_u = u >= v ? other - a : c - other, along_v = u >= v ? c - other : other - a;
    slope = std::hypot(along_u / kCell_m.x, along_v / kCell_m.y);
    return a + along_u * u + along_v * v;
  }

  /// Whether the mesh is as fine as facet_height_m() says.
  static bool is_fine(double x, double y) { return std::abs(x) < 28 && std::abs(y) < 7; }

 private:
  static constexpr std::size_t kFineWaves = 6;
  static constexpr glm::dvec2 kCell_m{0.4, 0.2};

  static double bell(double u) { return std::exp(-u * u); }

  double waves(double x, double y, std::size_t from, std::size_t to) const {
    double sum = 0;
    for (std::size_t i = from; i < to; ++i) {
      const std::vector<double>& w = waves_[i];
      sum += w[0] * std::sin(w[1] * x + w[2] * y + w[3]);
    }
    return sum;
  }

  Rows waves_;
};

const std::string kDriveHeader =
    "time_s,R_POSE.x,R_POSE.y,R_POSE.z,R_POSE.roll,R_POSE.pitch,R_POSE.yaw,PAN.value,TILT.value";

std::string attribute(const std::vector<Command>& commands, std::string_view name, std::string_view attribute) {
  for (const Command& command : commands) {
    const CommandAttribute* own_name = command.find("name");
    if (!own_name || own_name->value != name) continue;
    const CommandAttribute* found = command.find(attribute);
    REQUIRE_MESSAGE(found, name, " has no ", attribute);
    return found->value;
  }
  FAIL("ravon.xml has no ", name);
  std::abort();
}

/// Checks that the four wheels of a robot at `pose` (x, y, z, roll, pitch, yaw) share out the ground's twist evenly.
void check_wheels(const Ground& ground, const std::array<double, 6>& pose) {
  constexpr double kWheelX_m = 0.68, kWheelY_m = 0.62;
  // Poses are written to 0.1 mm and 0.001 degrees: at a wheel, 0.92 m from the middle, half of each is 0.05 mm and
  // 0.008 mm per angle. Slopes below one half turn the rounding of x and y into 0.05 mm more.
  constexpr double kRounding_m = 0.0002;
  // What tyres of 0.39 m take up.
  constexpr double kTyreGive_m = 0.03;
  const glm::dmat4 world_from_robot = matrix_from_degrees({pose[0], pose[1], pose[2]}, pose[3], pose[4], pose[5]);
  const auto gap = [&](double x, double y) {
    const glm::dvec4 wheel = world_from_robot * glm::dvec4(x, y, 0, 1);
    return wheel.z - ground.height_m(wheel.x, wheel.y);
  };
  const double front_left = gap(kWheelX_m, kWheelY_m), front_right = gap(kWheelX_m, -kWheelY_m);
  const double rear_left = gap(-kWheelX_m, kWheelY_m), rear_right = gap(-kWheelX_m, -kWheelY_m);
  CHECK(std::abs(front_left) < kTyreGive_m);
  CHECK(std::abs(front_left + front_right) < kRounding_m);
  CHECK(std::abs(front_left + rear_left) < kRounding_m);
  CHECK(std::abs(front_left - rear_right) < kRounding_m);
}

/// What stands against the height function in a scan, counted.
struct ScanCheck {
  int on_earth = 0, on_fringe = 0;
};

void check_scan(const Ground& ground, const Scan& scan, const glm::dmat4& world_from_sensor, ScanCheck& check) {
  // Corners of the mesh are written to 0.01 mm in each coordinate, and rounded to float (4e-6 m up to 32 m from the
  // origin); slopes are below one. What the scanner adds is its own bound.
  constexpr double kCorner_m = 2 * (0.5e-5 + 0.4e-5), kFringeLift_m = 0.012, kSteepest = 1;
  for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
    if (!std::isfinite(scan.range_m[beam]) || !std::isfinite(scan.error_bound_m[beam])) continue;
    const double azimuth = glm::radians(-90 + 0.5 * static_cast<double>(beam));
    const glm::dvec3 hit(
        world_from_sensor *
        glm::dvec4(double{scan.range_m[beam]} * glm::dvec3(std::cos(azimuth), std::sin(azimuth), 0), 1));
    if (!Ground::is_fine(hit.x, hit.y)) continue;
    double slope = 0;
    const double above_m = hit.z - ground.facet_height_m(hit.x, hit.y, slope);
    const double tolerance_m = kCorner_m + double{scan.error_bound_m[beam]} * std::sqrt(1 + slope * slope);
    const bool on_fringe = above_m > 0.5 * kFringeLift_m;
    CAPTURE(beam);
    CAPTURE(hit.x);
    CAPTURE(hit.y);
    CHECK(slope < kSteepest);
    CHECK(std::abs(above_m - (on_fringe ? kFringeLift_m : 0.0)) <= tolerance_m);
    ++(on_fringe ? check.on_fringe : check.on_earth);
  }
}

}  // namespace

TEST_CASE("the generator makes what is committed") {
  const std::string command = "python3 \"" + (kRavonFolder / "generate.py").string() + "\" --check";
  CHECK(std::system(command.c_str()) == 0);
}

TEST_CASE("the overview draws at least 200,000 triangles, with masked leaves of high resolution") {
  Simulation simulation = Simulation::load(kRavonFolder / "ravon.xml");
  CHECK(simulation.warnings().empty());
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == "WORLD_CAM");
  simulation.step();
  MESSAGE(simulation.diagnostics().counters().triangles << " triangles in " << simulation.diagnostics().counters().draws
                                                        << " draws");
  CHECK(simulation.diagnostics().counters().triangles >= 200'000);
  const auto& materials = simulation.diagnostics().draw_list().materials;
  CHECK(std::count_if(materials.begin(), materials.end(), [](const auto& material) {
          return material->alpha_mode == AlphaMode::mask && material->base_color_texture &&
                 material->base_color_texture->width >= 1024;
        }) >= 5);
}

TEST_CASE("the robot's wheels stand on the ground all along the drive, and where the scene puts it") {
  const Ground ground;
  const Rows rows = read_table(kRavonFolder / "drive.csv", kDriveHeader);
  REQUIRE(rows.size() > 300);
  CHECK(rows.back()[0] >= 30);
  for (const std::vector<double>& row : rows) {
    REQUIRE(row.size() == 9);
    CAPTURE(row[0]);
    check_wheels(ground, {row[1], row[2], row[3], row[4], row[5], row[6]});
  }
  const std::vector<Command> commands = read_commands(kRavonFolder / "ravon.xml");
  std::array<double, 6> pose{};
  const std::array<const char*, 6> names{"x", "y", "z", "roll", "pitch", "yaw"};
  for (std::size_t i = 0; i < names.size(); ++i) pose[i] = std::stod(attribute(commands, "R_POSE", names[i]));
  check_wheels(ground, pose);
}

TEST_CASE("the front scanner measures the ground before the robot") {
  const Ground ground;
  const std::string mount = attribute(read_commands(kRavonFolder / "ravon.xml"), "FRONT_SCANNER", "pose_offset");
  Simulation simulation = Simulation::from_string(
      R"(<part file="ground.glb" name="GROUND" insert_at="ROOT"/>
         <part file="robot.glb" name="ROBOT" insert_at="GROUND"/>
         <element type="pose" name="R_POSE" insert_at="ROBOT"/>
         <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" pose_offset=")" +
          mount + R"(" samples="361" min_angle="-90" max_angle="90" method="planar"/>)",
      {}, kRavonFolder);
  const Rows rows = read_table(kRavonFolder / "drive.csv", kDriveHeader);
  ScanCheck check;
  const std::array<const char*, 6> names{"x", "y", "z", "roll", "pitch", "yaw"};
  for (std::size_t row = 0; row < rows.size(); row += 40) {
    CAPTURE(rows[row][0]);
    for (std::size_t i = 0; i < names.size(); ++i) simulation.set("R_POSE", names[i], rows[row][i + 1]);
    simulation.step();
    glm::dmat4 world_from_sensor;
    REQUIRE(simulation.sensor_pose("SCAN", world_from_sensor));
    check_scan(ground, simulation.scan("SCAN"), world_from_sensor, check);
  }
  MESSAGE(check.on_earth << " beams on the ground, " << check.on_fringe << " on the last blades of turf");
  CHECK(check.on_earth > 500);
  CHECK(check.on_fringe > 10);
}

TEST_SUITE_END();
