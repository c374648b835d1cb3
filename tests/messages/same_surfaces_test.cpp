// Clouds of a depth image and of a scanner, made of ROS messages alone as depth_image_proc and laser_geometry make
// them, lie on the same surfaces.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include <simvis/simulation.h>
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "tests/messages/mcap_file.h"
#include "tests/messages/tf_listener.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

// The wall is the plane x = 4 m. A point of a depth image is a float32 in metres, which rounds by 2.4e-7 m at 4 m, of
// a depth that the renderer rounds by some 1e-6 m; the issue calls for 1e-5 m.
constexpr double kWallAt_m = 4, kSameSurface_m = 1e-5;

void check_on_wall(const glm::dmat4& map_from_points, const std::vector<glm::dvec3>& points) {
  REQUIRE(points.size() > 10);
  double furthest_m = 0;
  for (const glm::dvec3& point : points) {
    const glm::dvec4 in_map = map_from_points * glm::dvec4(point, 1);
    furthest_m = std::max(furthest_m, std::abs(in_map.x - kWallAt_m));
  }
  CHECK(furthest_m <= kSameSurface_m);
}

TEST_CASE("depth images, scans and clouds are on the same wall") {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), R"(
      <part name="ROBOT" insert_at="ROOT" pose_offset="0.3 -0.2 0.4 0 0 12"/>
      <sensor type="camera" name="CAM" insert_at="ROBOT" width="64" height="48" outputs="depth"
              pose_offset="0.1 0.05 0.2 0 7 -20"/>
      <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="41" min_angle="-30" max_angle="30"
              pose_offset="0.2 0 0.1 3 -5 4"/>)"));
  simulation.record({.file = folder / "run.mcap"});
  simulation.step();
  simulation.finish_recording();
  const ros::test::McapFile file = ros::test::McapReader::read(read_text(folder / "run.mcap"));
  const ros::test::TfListener listener(file);  // nothing moves
  const auto map_from = [&](const std::string& frame) { return listener.find("map", frame).value(); };

  const auto image = file.all<ros::Image>("/CAM/depth/image_raw").at(0);
  const auto info = file.all<ros::CameraInfo>("/CAM/depth/camera_info").at(0);
  CHECK(image.header.frame_id == info.header.frame_id);
  std::vector<glm::dvec3> of_image;
  for (std::uint32_t v = 0; v < image.height; ++v) {
    for (std::uint32_t u = 0; u < image.width; ++u) {
      float depth_m = 0;
      std::memcpy(&depth_m, image.data.data() + v * image.step + u * sizeof depth_m, sizeof depth_m);
      if (!std::isfinite(depth_m)) continue;
      of_image.emplace_back((u - info.p[2]) * depth_m / info.p[0], (v - info.p[6]) * depth_m / info.p[5], depth_m);
    }
  }
  check_on_wall(map_from(image.header.frame_id), of_image);

  const auto scan = file.all<ros::LaserScan>("/SCAN/scan").at(0);
  std::vector<glm::dvec3> of_scan;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    if (std::isfinite(scan.ranges[i])) {
      of_scan.emplace_back(scan.ranges[i] * std::cos(angle), scan.ranges[i] * std::sin(angle), 0);
    }
  }
  check_on_wall(map_from(scan.header.frame_id), of_scan);

  const auto cloud = file.all<ros::PointCloud2>("/SCAN/points").at(0);
  std::vector<glm::dvec3> of_cloud;
  for (std::size_t i = 0; i < std::size_t{cloud.width} * cloud.height; ++i) {
    float point[3];
    std::memcpy(point, cloud.data.data() + i * cloud.point_step, sizeof point);
    if (std::isfinite(point[0])) of_cloud.emplace_back(point[0], point[1], point[2]);
  }
  check_on_wall(map_from(cloud.header.frame_id), of_cloud);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
