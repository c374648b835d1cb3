// Clouds of scanners and depth cameras: fields, offsets and types of each layout, and their points by closed forms.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <simvis/depth_points.h>
#include <simvis/simulation.h>
#include "engine/base/srgb.h"
#include "exchange/messages/from_image.h"
#include "exchange/messages/from_scan.h"
#include "exchange/packets/driver_clouds.h"
#include "tests/messages/recorded_frame.h"
#include "tests/support/error_of.h"
#include "tests/support/made_up_scan.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using ros::CustomMsg;
using ros::PointCloud2;
using ros::PointField;
using ros::test::McapFile;
using ros::test::McapReader;
using test::recorded_frame;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Two rings of three beams: four returns, one miss, one that is too near. Intensities are those of matte walls of the
/// reflectances 0.2, 0.4, ... at their ranges, so that the calibrated reflectivities are 20, 40, ...
Scan two_rings() {
  Scan scan = test::scan_of_numbers({-0.5, 0, 0.5}, {-0.25, 0.25}, {2, 4, kInfinity, 0, 8, 2});
  scan.time_ns = 3'000'000'000;
  scan.add_channel({.name = "intensity", .format = "%.9g"}, {0.2 / 4, 0.4 / 16, 0, 0, 0.8 / 64, 1.0 / 4});
  scan.add_channel({.name = "time_s", .format = "%.9g"}, {2.5, 2.625, 2.75, 2.5, 2.625, 2.75});
  return scan;
}

template <typename T>
T at(const PointCloud2& cloud, std::size_t point, std::size_t offset) {
  T value;
  std::memcpy(&value, &cloud.data.at(point * cloud.point_step + offset), sizeof value);
  return value;
}

struct ExpectedField {
  std::string name;
  std::uint32_t offset;
  std::uint8_t datatype;
};

void check_fields(const PointCloud2& cloud, const std::vector<ExpectedField>& expected, std::uint32_t step) {
  REQUIRE(cloud.fields.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(cloud.fields[i].name == expected[i].name);
    CHECK(cloud.fields[i].offset == expected[i].offset);
    CHECK(cloud.fields[i].datatype == expected[i].datatype);
    CHECK(cloud.fields[i].count == 1);
  }
  CHECK(cloud.point_step == step);
  CHECK(cloud.row_step == step * cloud.width);
  CHECK(cloud.data.size() == std::size_t{step} * cloud.width * cloud.height);
  CHECK_FALSE(cloud.is_bigendian);
}

/// Whether the point of a cloud is beam `beam` of the scan.
bool is_beam(const PointCloud2& cloud, std::size_t point, const Scan& scan, std::size_t beam) {
  const glm::dvec3 expected = scan.point(beam);
  for (int axis = 0; axis < 3; ++axis) {
    if (at<float>(cloud, point, 4 * static_cast<std::size_t>(axis)) != static_cast<float>(expected[axis])) return false;
  }
  return true;
}

// Numbers of common_interfaces, sensor_msgs/PointField.
constexpr std::uint8_t kUint8Type = 2, kUint16Type = 4, kUint32Type = 6, kFloatType = 7, kDoubleType = 8;
// The beams of two_rings() with a return, and what they give.
constexpr std::size_t kReturned[] = {0, 1, 4, 5};
constexpr double kReflectivities[] = {20, 40, 80, 100}, kAges_s[] = {0, 0.125, 0.125, 0.25};

TEST_CASE("velodyne: the fields of velodyne_pointcloud, and returns alone") {
  const Scan scan = two_rings();
  const PointCloud2 cloud = ros::driver_cloud("velodyne", scan, "LIDAR", false);
  check_fields(cloud,
               {{"x", 0, kFloatType},
                {"y", 4, kFloatType},
                {"z", 8, kFloatType},
                {"intensity", 12, kFloatType},
                {"ring", 16, kUint16Type},
                {"time", 18, kFloatType}},
               22);
  CHECK(cloud.header.frame_id == "LIDAR");
  CHECK(cloud.header.stamp.sec == 2);
  CHECK(cloud.header.stamp.nanosec == 500'000'000);
  CHECK(cloud.height == 1);
  REQUIRE(cloud.width == 4);
  CHECK(cloud.is_dense);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(is_beam(cloud, i, scan, kReturned[i]));
    CHECK(at<float>(cloud, i, 12) == kReflectivities[i]);
    CHECK(at<std::uint16_t>(cloud, i, 16) == kReturned[i] / 3);
    CHECK(at<float>(cloud, i, 18) == kAges_s[i]);
  }
}

TEST_CASE("ouster: the fields of ouster_ros, every beam in its place unless dense") {
  const Scan scan = two_rings();
  const std::vector<ExpectedField> fields = {
      {"x", 0, kFloatType},          {"y", 4, kFloatType},         {"z", 8, kFloatType},
      {"intensity", 16, kFloatType}, {"t", 20, kUint32Type},       {"reflectivity", 24, kUint16Type},
      {"ring", 26, kUint16Type},     {"ambient", 28, kUint16Type}, {"range", 32, kUint32Type}};
  for (const bool dense : {false, true}) {
    CAPTURE(dense);
    const PointCloud2 cloud = ros::driver_cloud("ouster", scan, "OS", dense);
    check_fields(cloud, fields, 48);
    CHECK(cloud.height == (dense ? 1 : 2));
    REQUIRE(cloud.width == (dense ? 4 : 3));
    CHECK(cloud.is_dense == dense);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t point = dense ? i : kReturned[i];
      CHECK(is_beam(cloud, point, scan, kReturned[i]));
      const double range_m = scan.range_m[kReturned[i]];
      // A wall of the reflectivity 20 at 2 m has the intensity 0.05 / m^2, and 10,000 photons for each 1 / m^2.
      CHECK(at<float>(cloud, point, 16) ==
            static_cast<float>(std::round(kReflectivities[i] * 100 / range_m / range_m)));
      CHECK(at<std::uint32_t>(cloud, point, 20) == static_cast<std::uint32_t>(kAges_s[i] * 1e9));
      CHECK(at<std::uint16_t>(cloud, point, 24) == kReflectivities[i]);
      CHECK(at<std::uint16_t>(cloud, point, 26) == kReturned[i] / 3);
      CHECK(at<std::uint16_t>(cloud, point, 28) == 0);
      CHECK(at<std::uint32_t>(cloud, point, 32) == static_cast<std::uint32_t>(1000 * range_m));
    }
    if (dense) continue;
    for (const std::size_t lost : {2, 3}) {
      CHECK(std::isnan(at<float>(cloud, lost, 0)));
      CHECK(at<std::uint32_t>(cloud, lost, 32) == 0);
    }
  }
}

TEST_CASE("livox: the fields of livox_ros_driver2, and its CustomMsg, say the same") {
  const Scan scan = two_rings();
  const PointCloud2 cloud = ros::driver_cloud("livox", scan, "MID", false);
  check_fields(cloud,
               {{"x", 0, kFloatType},
                {"y", 4, kFloatType},
                {"z", 8, kFloatType},
                {"intensity", 12, kFloatType},
                {"tag", 16, kUint8Type},
                {"line", 17, kUint8Type},
                {"timestamp", 18, kDoubleType}},
               26);
  REQUIRE(cloud.width == 4);
  const CustomMsg message = ros::livox_message(scan, "MID");
  CHECK(message.header.frame_id == "MID");
  CHECK(message.header.stamp.nanosec == 500'000'000);
  CHECK(message.timebase == 2'500'000'000);
  REQUIRE(message.point_num == 4);
  REQUIRE(message.points.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(is_beam(cloud, i, scan, kReturned[i]));
    CHECK(at<float>(cloud, i, 12) == kReflectivities[i]);
    CHECK(at<std::uint8_t>(cloud, i, 16) == 0);
    CHECK(at<std::uint8_t>(cloud, i, 17) == kReturned[i] / 3);
    CHECK(at<double>(cloud, i, 18) == 2.5e9 + kAges_s[i] * 1e9);
    const ros::CustomPoint& point = message.points[i];
    CHECK(point.x == at<float>(cloud, i, 0));
    CHECK(point.y == at<float>(cloud, i, 4));
    CHECK(point.z == at<float>(cloud, i, 8));
    CHECK(point.offset_time == static_cast<std::uint32_t>(kAges_s[i] * 1e9));
    CHECK(point.reflectivity == kReflectivities[i]);
    CHECK(point.tag == 0);
    CHECK(point.line == kReturned[i] / 3);
  }
}

TEST_CASE("drivers' reflectivity is the channel of that name where there is one, and 0 without any") {
  Scan scan = test::scan_of_numbers({0, 0.5}, {0}, {2, 3});
  CHECK(ros::livox_message(scan, "").points[1].reflectivity == 0);
  scan.add_channel({.name = "reflectivity", .format = "%.0f"}, {17, 255});
  CHECK(ros::livox_message(scan, "").points[0].reflectivity == 17);
  CHECK(ros::livox_message(scan, "").points[1].reflectivity == 255);
}

TEST_CASE("a dense cloud of a scanner has the returns alone, each with its fields") {
  const Scan scan = two_rings();
  const PointCloud2 all = ros::point_cloud(scan, "TOP"), dense = ros::point_cloud(scan, "TOP", true);
  CHECK_FALSE(all.is_dense);
  CHECK(dense.is_dense);
  CHECK(dense.height == 1);
  REQUIRE(dense.width == 4);
  CHECK(dense.data.size() == 4 * all.point_step);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(std::memcmp(&dense.data[i * all.point_step], &all.data[kReturned[i] * all.point_step], all.point_step) == 0);
  }
}

// A plate of 2 m x 2 m at x = 2 before a camera with 90 degrees and 8 x 6 pixels, whose focal length is 4 px: pixel
// (x, y) sees the plate at ((x - 3.5) / 4, (y - 2.5) / 4) * 2 m if that is within 1 m.
constexpr std::uint32_t kWidth_px = 8, kHeight_px = 6;
constexpr double kDistance_m = 2, kFocal_px = 4, kPlate_m = 2;
// Depths of drawn pixels are near / d in float32, see design of the depth buffer: some half-steps of 2 m.
constexpr double kDepthRounding_m = 4 * 0x1p-23 * kDistance_m;

const std::string kPlate =
    R"(<part name="PLATE" insert_at="ROOT" shape="box" size="0.1 2 2" pose_offset="2.05 0 0 0 0 0"/>)";

std::string depth_sensor(const std::string& type, const std::string& more) {
  return "<sensor type='" + type + "' name='CAM' insert_at='ROOT' width='8' height='6' hfov='90' " + more + "/>";
}

/// Where the plate is seen in the optical frame; NaN: beside it.
glm::dvec3 seen_at(std::uint32_t x, std::uint32_t y) {
  const double across = (x - 3.5) / kFocal_px * kDistance_m, down = (y - 2.5) / kFocal_px * kDistance_m;
  const bool hits = std::abs(across) < kPlate_m / 2 && std::abs(down) < kPlate_m / 2;
  return hits ? glm::dvec3(across, down, kDistance_m) : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
}

TEST_CASE("the cloud of a depth camera has a point for each pixel, in the optical frame, with its colour") {
  for (const bool color : {false, true}) {
    CAPTURE(color);
    const std::string outputs = color ? "outputs='color depth'" : "outputs='depth'";
    for (const char* const type : {"camera", "rgbd_camera", "tof_camera"}) {
      CAPTURE(type);
      const bool colored = color && std::string(type) != "tof_camera";
      const bool phases = std::string(type) == "tof_camera";
      const McapFile file =
          recorded_frame(kPlate + depth_sensor(type, phases ? "outputs='depth'" : outputs), {"/CAM/*"});
      const auto clouds = file.all<PointCloud2>("/CAM/points");
      REQUIRE(clouds.size() == 1);
      const PointCloud2& cloud = clouds[0];
      CHECK(cloud.header.frame_id == "CAM_optical");
      CHECK(cloud.height == kHeight_px);
      REQUIRE(cloud.width == kWidth_px);
      CHECK_FALSE(cloud.is_dense);
      std::vector<ExpectedField> fields = {{"x", 0, kFloatType}, {"y", 4, kFloatType}, {"z", 8, kFloatType}};
      if (colored) fields.push_back({"rgb", 16, kFloatType});
      check_fields(cloud, fields, colored ? 32 : 16);
      const auto images = file.all<ros::Image>("/CAM/image_raw");
      REQUIRE(images.size() == (colored ? 1 : 0));
      int measured = 0;
      for (std::uint32_t i = 0; i < kWidth_px * kHeight_px; ++i) {
        const glm::dvec3 expected = seen_at(i % kWidth_px, i / kWidth_px);
        const glm::dvec3 point(at<float>(cloud, i, 0), at<float>(cloud, i, 4), at<float>(cloud, i, 8));
        if (colored) {
          const std::uint8_t* const rgb = &images[0].data[3 * std::size_t{i}];
          CHECK(at<std::uint32_t>(cloud, i, 16) == (rgb[0] << 16 | rgb[1] << 8 | rgb[2]));
        }
        // Two imagers: the second one, which stands to the right, does not see the left edge.
        if (std::isnan(point.x) && std::string(type) == "rgbd_camera") continue;
        REQUIRE(std::isnan(point.x) == std::isnan(expected.x));
        if (std::isnan(expected.x)) continue;
        ++measured;
        CHECK(glm::distance(point, expected) <= 2 * kDepthRounding_m);
      }
      CHECK(measured >= 9);
    }
  }
}

TEST_CASE("both views of a stereo camera have clouds, each in its own optical frame") {
  const McapFile file =
      recorded_frame(kPlate + depth_sensor("stereo_camera", "outputs='color depth' baseline='0.2'"), {"/CAM/*/points"});
  for (const std::string view : {"left", "right"}) {
    CAPTURE(view);
    const auto clouds = file.all<PointCloud2>("/CAM/" + view + "/points");
    REQUIRE(clouds.size() == 1);
    CHECK(clouds[0].header.frame_id == "CAM_" + view + "_optical");
    // The pixel whose ray leads to x = -0.25 m; the right camera stands 0.2 m to the right of the plate's middle.
    CHECK(std::abs(at<float>(clouds[0], 2 * kWidth_px + 3, 0) + 0.25) <= kDepthRounding_m);
    CHECK(std::abs(at<float>(clouds[0], 2 * kWidth_px + 3, 8) - kDistance_m) <= kDepthRounding_m);
  }
}

TEST_CASE("points through a lens lie on the plate that the camera sees") {
  // Of the lens model's inverse, see effects/camera/lens.h: 1e-9 px; of depth: float32.
  for (const char* const lens :
       {"distortion='brown_conrady' k1='-0.05' p1='0.01'", "distortion='kannala_brandt' k1='0.05'",
        "distortion='rational_polynomial' k4='0.05' s1='0.01' tau_x='3'", "distortion='double_sphere' alpha='0.6'",
        "fy='4' cx='1.5' cy='2.25'"}) {
    CAPTURE(lens);
    Simulation simulation = Simulation::from_string(
        "<simvis>" + kPlate + depth_sensor("camera", std::string("outputs='depth range' ") + lens) + "</simvis>");
    simulation.step();
    const Measurement measurement = simulation.measurement("CAM");
    const auto points = depth_points(measurement);
    REQUIRE(points);
    const MeasuredArray& range = *measurement.find("range");
    int measured = 0;
    for (std::size_t i = 0; i < points->size(); ++i) {
      const glm::dvec3& point = (*points)[i];
      REQUIRE(std::isnan(point.x) == std::isinf(range.number(i)));
      if (std::isnan(point.x)) continue;
      ++measured;
      CHECK(std::abs(point.x - kDistance_m) <= kDepthRounding_m);
      // The range is a number of its own: it checks the direction.
      CHECK(std::abs(glm::length(point) - range.number(i)) <= 2 * kDepthRounding_m);
    }
    CHECK(measured >= 9);
  }
}

TEST_CASE("depth_points() are in the sensor frame, and nothing without a depth") {
  Simulation simulation = Simulation::from_string(
      "<simvis>" + kPlate + depth_sensor("stereo_camera", "outputs='color depth' baseline='0.2'") +
      "<sensor type='imu' name='IMU' insert_at='ROOT'/></simvis>");
  simulation.step();
  const Measurement measurement = simulation.measurement("CAM");
  CHECK_FALSE(depth_points(measurement));  // its views have names
  CHECK_FALSE(depth_points(simulation.measurement("IMU")));
  for (const auto& [view, left_m] : {std::pair("left", 0.0), {"right", -0.2}}) {
    const auto points = depth_points(measurement, view);
    REQUIRE(points);
    REQUIRE(points->size() == kWidth_px * kHeight_px);
    const glm::dvec3 expected(kDistance_m, 0.25 + left_m, 0.25);
    CHECK(glm::distance((*points)[2 * kWidth_px + 3], expected) <= 2 * kDepthRounding_m);
  }
}

TEST_CASE("clouds of depth cameras come on request: by a pattern, or by a name in the scene") {
  const std::string camera = "outputs='depth' dense='on'";
  CHECK(recorded_frame(kPlate + depth_sensor("camera", camera)).counts().count("/CAM/points") == 0);
  const McapFile named = recorded_frame(kPlate + depth_sensor("camera", camera + " topics='points:=/cloud'"));
  const auto clouds = named.all<PointCloud2>("/cloud");
  REQUIRE(clouds.size() == 1);
  int seen = 0;
  for (std::uint32_t i = 0; i < kWidth_px * kHeight_px; ++i) seen += !std::isnan(seen_at(i % 8, i / 8).x);
  CHECK(clouds[0].is_dense);
  CHECK(clouds[0].height == 1);
  CHECK(clouds[0].width == static_cast<std::uint32_t>(seen));
}

TEST_CASE("a driver's layout is refused for a scan whose rings or times do not fit into its fields") {
  const auto error = [](const std::string& layout, const std::string& more) {
    return error_of([&] {
      recorded_frame("<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='2' layout='" + layout + "' " +
                     more + "/>");
    });
  };
  struct Case {
    std::string layout, fits, wrong, expected;
  };
  // 32 bits of nanoseconds, 8 and 16 bits of rings.
  const std::vector<Case> cases = {{"ouster", "sweep='4'", "sweep='4.1'", "expected at most 4 s"},
                                   {"livox", "sweep='4'", "sweep='4.1'", "expected at most 4 s"},
                                   {"velodyne", "sweep='5'", "vertical_samples='65537'", "expected at most 65536"},
                                   {"ouster", "vertical_samples='257'", "vertical_samples='65537'", "at most 65536"},
                                   {"livox", "vertical_samples='256'", "vertical_samples='257'", "at most 256"}};
  for (const Case& each : cases) {
    CAPTURE(each.layout);
    CAPTURE(each.wrong);
    CHECK(error(each.layout, each.fits) == "nothing was thrown");
    CHECK(contains(error(each.layout, each.wrong), each.expected));
    CHECK(error("simvis", each.wrong) == "nothing was thrown");
  }
}

TEST_CASE("layout and dense choose the messages of a scanner") {
  const auto scanner = [](const std::string& more) {
    return kPlate + "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='9' intensity='on' " + more +
           "/>";
  };
  CHECK(recorded_frame(scanner("")).all<PointCloud2>("/SCAN/points").at(0).width == 9);
  CHECK(recorded_frame(scanner("dense='on'")).all<PointCloud2>("/SCAN/points").at(0).is_dense);
  CHECK(recorded_frame(scanner("layout='velodyne'")).all<PointCloud2>("/SCAN/points").at(0).point_step == 22);
  CHECK(recorded_frame(scanner("layout='ouster'")).all<PointCloud2>("/SCAN/points").at(0).point_step == 48);
  CHECK(recorded_frame(scanner("layout='ouster'")).counts().count("/SCAN/livox") == 0);
  const McapFile livox = recorded_frame(scanner("layout='livox' topics='livox:=/livox/lidar'"));
  CHECK(livox.all<PointCloud2>("/SCAN/points").at(0).point_step == 26);
  const auto messages = livox.all<CustomMsg>("/livox/lidar");
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].point_num == livox.all<PointCloud2>("/SCAN/points")[0].width);
}

SimulationDesc ten_frames_a_second() {
  SimulationDesc desc;
  desc.rate_hz = 10;
  return desc;
}

TEST_CASE("clouds have the speed along each beam") {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::from_string(
      "<simvis>" + kPlate +
          "<part name='CAR' insert_at='ROOT'/><element type='pose' name='DRIVE' insert_at='CAR'/>"
          "<sensor type='laser_scanner' name='SCAN' insert_at='CAR' samples='3' min_angle='-20' max_angle='20' "
          "truth='radial_speed'/></simvis>",
      ten_frames_a_second());
  simulation.record({.file = folder / "run.mcap", .topics = {"/SCAN/points"}});
  simulation.step();
  simulation.set("DRIVE", "x", 0.1);  // 1 m/s ahead
  simulation.step();
  simulation.finish_recording();
  const auto clouds = McapReader::read(read_text(folder / "run.mcap")).all<PointCloud2>("/SCAN/points");
  REQUIRE(clouds.size() == 2);
  const PointField& field = clouds[1].fields.back();
  CHECK(field.name == "radial_speed");
  CHECK(field.datatype == kFloatType);
  for (std::size_t i = 0; i < 3; ++i) {
    const double expected = -std::cos(glm::radians(-20 + 20.0 * static_cast<double>(i)));
    // 0.1 m / 0.1 s in double, and one rounding to float32.
    CHECK(std::abs(at<float>(clouds[1], i, field.offset) - expected) <= 0x1p-24 + 1e-13);
    CHECK(at<float>(clouds[0], i, field.offset) == 0);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
