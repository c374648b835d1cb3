// What messages say of measurements: conventions of REP 103, 105, 117 and of each type's definition.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "engine/base/srgb.h"
#include "exchange/messages/from_image.h"
#include "exchange/messages/from_pose.h"
#include "exchange/messages/from_scan.h"
#include "exchange/messages/topics.h"
#include "exchange/messages/transforms.h"
#include "scenegraph/pictures/png_bytes.h"
#include "scenegraph/pictures/png_file.h"
#include "tests/support/made_up_scan.h"

TEST_SUITE_BEGIN("messages");

namespace simvis::ros {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rounding of a few operations on numbers of the size of 1.
constexpr double kRounding = 1e-12;

/// Three beams at -1, 0 and 1 rad: a wall, nothing, and one that is too near.
Scan planar_scan(SharedArray<double> azimuths_rad = {-1, 0, 1}, SharedArray<double> elevations_rad = {0}) {
  Scan scan = simvis::test::scan_of_numbers(std::move(azimuths_rad), std::move(elevations_rad),
                                            {2.5f, std::numeric_limits<float>::infinity(), 0}, {0.25f, 0, 0});
  scan.time_ns = 2'500'000'000;
  return scan;
}

template <typename T>
T value_at(const PointCloud2& cloud, std::size_t point, const std::string& field) {
  for (const PointField& each : cloud.fields) {
    if (each.name != field) continue;
    CHECK(each.count == 1);
    T value;
    std::memcpy(&value, &cloud.data.at(point * cloud.point_step + each.offset), sizeof value);
    return value;
  }
  FAIL("no field " << field);
  return {};
}

TEST_CASE("a planar scan with even angles is a LaserScan") {
  const std::optional<LaserScan> message = laser_scan(planar_scan(), "FRONT", {0.05, 80}, 0.1);
  REQUIRE(message);
  CHECK(message->header.frame_id == "FRONT");
  CHECK(message->header.stamp.sec == 2);
  CHECK(message->header.stamp.nanosec == 500'000'000);
  CHECK(message->angle_min == -1);
  CHECK(message->angle_max == 1);
  CHECK(message->angle_increment == 1);
  CHECK(message->time_increment == 0);
  CHECK(message->scan_time == 0.1f);
  CHECK(message->range_min == 0.05f);
  CHECK(message->range_max == 80);
  // REP 117: nothing within reach is +infinity, something too near is -infinity.
  CHECK(message->ranges == std::vector<float>{2.5f, static_cast<float>(kInfinity), static_cast<float>(-kInfinity)});
  CHECK(message->intensities.empty());
}

TEST_CASE("a scan that is no planar sweep is no LaserScan") {
  const Scan uneven = planar_scan({-1, 0.001, 1}), raised = planar_scan({-1, 0, 1}, {0.1}),
             rings = planar_scan({0}, {-0.5, 0, 0.5}), backwards = planar_scan({1, 0, -1});
  for (const Scan& scan : {uneven, raised, rings, backwards, Scan{}}) {
    CHECK_FALSE(laser_scan(scan, "", {0, 1}, 0));
  }
}

TEST_CASE("the channels of a scan are intensities and times") {
  Scan scan = planar_scan();
  scan.add_channel({.name = "intensity", .format = "%.9g"}, {7, 8, 9});
  scan.add_channel({.name = "time_s", .format = "%.9g"}, {2.25, 2.375, 2.5});
  const std::optional<LaserScan> message = laser_scan(scan, "", {0, 1}, 0.25);
  REQUIRE(message);
  CHECK(message->intensities == std::vector<float>{7, 8, 9});
  CHECK(message->time_increment == 0.125);
  CHECK(message->header.stamp.sec == 2);  // of the first beam
  CHECK(message->header.stamp.nanosec == 250'000'000);
  // The stamp is the time of the beam that left first, whatever the message can say of the others.
  const auto set_times = [&](std::vector<double> times_s) {
    scan.clear_channels();
    scan.add_channel({.name = "time_s", .format = "%.9g"}, std::move(times_s));
  };
  set_times({2.25, 2.3, 2.5});
  CHECK(laser_scan(scan, "", {0, 1}, 0.25)->header.stamp.nanosec == 250'000'000);
}

TEST_CASE("a clockwise sweep stands in the order of its beams") {
  Scan scan = planar_scan();
  scan.add_channel({.name = "intensity", .format = "%.9g"}, {7, 8, 9});
  scan.add_channel({.name = "time_s", .format = "%.9g"}, {2.5, 2.375, 2.25});
  const std::optional<LaserScan> message = laser_scan(scan, "", {0, 1}, 0.25);
  REQUIRE(message);
  CHECK(message->header.stamp.sec == 2);
  CHECK(message->header.stamp.nanosec == 250'000'000);
  CHECK(message->angle_min == 1);  // of the first beam
  CHECK(message->angle_max == -1);
  CHECK(message->angle_increment == -1);
  CHECK(message->time_increment == 0.125);
  CHECK(message->ranges == std::vector<float>{static_cast<float>(-kInfinity), static_cast<float>(kInfinity), 2.5f});
  CHECK(message->intensities == std::vector<float>{9, 8, 7});
}

TEST_CASE("a scan that began before time 0 keeps the times of its beams") {
  Scan scan = planar_scan();
  scan.time_ns = 0;
  for (const bool clockwise : {false, true}) {
    CAPTURE(clockwise);
    scan.clear_channels();
    scan.add_channel({.name = "time_s", .format = "%.9g"},
                     clockwise ? std::vector<double>{0, -0.125, -0.25} : std::vector<double>{-0.25, -0.125, 0});
    const std::optional<LaserScan> message = laser_scan(scan, "", {0, 1}, 0.25);
    REQUIRE(message);
    CHECK(message->header.stamp.sec == 0);  // no stamp is before 0
    CHECK(message->header.stamp.nanosec == 0);
    CHECK(message->time_increment == 0.125);
    const PointCloud2 cloud = point_cloud(scan, "");
    CHECK(cloud.header.stamp.nanosec == 0);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(value_at<float>(cloud, i, "time") == 0.125f * static_cast<float>(clockwise ? 2 - i : i));
    }
  }
}

TEST_CASE("a cloud has every beam, its bound, its ring and its channels") {
  Scan scan = planar_scan({1}, {-0.5, 0, 0.5});
  scan.add_channel({.name = "intensity", .format = "%.9g"}, {7, 8, 9});
  scan.add_channel({.name = "time_s", .format = "%.9g"}, {2.25, 2.375, 2.5});
  scan.add_channel({.name = "echo", .format = "%.9g"}, {0.1, 0.2, 0.3});
  const PointCloud2 cloud = point_cloud(scan, "TOP");
  CHECK(cloud.header.frame_id == "TOP");
  CHECK(cloud.header.stamp.sec == 2);  // of the first beam, as of the LaserScan
  CHECK(cloud.header.stamp.nanosec == 250'000'000);
  CHECK(cloud.height == 3);
  CHECK(cloud.width == 1);
  CHECK(cloud.row_step == cloud.point_step);
  CHECK(cloud.data.size() == 3 * cloud.point_step);
  CHECK_FALSE(cloud.is_bigendian);
  CHECK_FALSE(cloud.is_dense);
  const glm::dvec3 point = scan.points()[0];
  CHECK(value_at<float>(cloud, 0, "x") == static_cast<float>(point.x));
  CHECK(value_at<float>(cloud, 0, "y") == static_cast<float>(point.y));
  CHECK(value_at<float>(cloud, 0, "z") == static_cast<float>(point.z));
  CHECK(value_at<float>(cloud, 0, "error_bound_m") == 0.25f);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(value_at<std::uint16_t>(cloud, i, "ring") == i);
    CHECK(value_at<float>(cloud, i, "intensity") == 7 + static_cast<float>(i));
    CHECK(value_at<float>(cloud, i, "time") == 0.125f * static_cast<float>(i));
    CHECK(value_at<double>(cloud, i, "echo") == scan.channel("echo")[i]);
    CHECK(std::isnan(value_at<float>(cloud, i, "x")) == (i > 0));
  }
  std::ranges::fill(scan.edit_ranges().range_m, 1.0f);
  CHECK(point_cloud(scan, "").is_dense);
}

TEST_CASE("images in each encoding") {
  const simvis::Image color{2, 1, 4, {1, 0, 0.5f, 1, 0, 2, 0, 1}};
  const std::uint8_t half = srgb_code(0.5f);
  const Image rgb = to_image(color, header_of(0, "CAM_optical"), "rgb8");
  CHECK(rgb.header.frame_id == "CAM_optical");
  CHECK(rgb.encoding == "rgb8");
  CHECK(rgb.step == 6);
  CHECK(rgb.data == std::vector<std::uint8_t>{255, 0, half, 0, 255, 0});
  CHECK(to_image(color, {}, "bgr8").data == std::vector<std::uint8_t>{half, 0, 255, 0, 255, 0});
  // 0.2126 + 0.5 * 0.0722 = 0.2487 of 65535 is 16299 = 0x3fab; 1.4304 is clamped.
  CHECK(to_image(color, {}, "mono16").data == std::vector<std::uint8_t>{0xab, 0x3f, 0xff, 0xff});
  const std::vector<std::uint32_t> counts{0x3fab, 0, 65535, 70000};
  const Image mono = counts_image(counts, 2, header_of(0, "T_optical"));
  CHECK(mono.header.frame_id == "T_optical");
  CHECK(mono.encoding == "mono16");
  CHECK(mono.width == 2);
  CHECK(mono.height == 2);
  CHECK(mono.step == 4);
  CHECK(mono.is_bigendian == 0);
  CHECK(mono.data == std::vector<std::uint8_t>{0xab, 0x3f, 0, 0, 0xff, 0xff, 0xff, 0xff});
  const simvis::Image depth{2, 2, 1, {1.5f, static_cast<float>(kInfinity), 65.5351f, 66}};
  const Image metres = to_image(depth, {}, "32FC1");
  CHECK(metres.step == 8);
  CHECK(std::memcmp(metres.data.data(), depth.pixels.data(), 16) == 0);
  const Image millimetres = to_image(depth, {}, "16UC1");
  CHECK(millimetres.height == 2);
  CHECK(millimetres.data == std::vector<std::uint8_t>{0xdc, 0x05, 0, 0, 0xff, 0xff, 0, 0});
  const CompressedImage png = compressed_image(color, {}, "png");
  CHECK(png.format == "png");
  CHECK(std::string(png.data.begin(), png.data.end()) == encode_png(color));
  const CompressedImage jpeg = compressed_image(color, {}, "jpeg");
  CHECK(std::string(jpeg.data.begin(), jpeg.data.end()) == encode_jpeg(color));
}

TEST_CASE("compressed depth is 12 bytes and a PNG of 16 bits with the millimetres") {
  const simvis::Image depth{2, 1, 1, {1.5f, std::numeric_limits<float>::infinity()}};
  const CompressedImage message = compressed_depth(depth, header_of(0, "CAM_optical"));
  CHECK(message.format == "16UC1; compressedDepth png");
  CHECK(message.header.frame_id == "CAM_optical");
  REQUIRE(message.data.size() > 12);
  CHECK(std::all_of(message.data.begin(), message.data.begin() + 12, [](std::uint8_t byte) { return byte == 0; }));
  const std::string png(message.data.begin() + 12, message.data.end());
  CHECK(png.substr(1, 3) == "PNG");
  const std::vector<std::uint8_t> codes{1500 >> 8, 1500 & 0xff, 0, 0};
  CHECK(png == png_bytes({.width = 2, .height = 1, .bits = 16, .channels = 1, .filter = PngFilter::up}, codes));
}

TEST_CASE("intrinsics count pixels from their centres, and a right camera says where it stands") {
  CameraCalibration right{.width_px = 64, .height_px = 48, .pinhole = {50, 60, 32, 24}, .baseline_m = 0.5};
  const CameraInfo info = camera_info(right, {});
  CHECK(info.width == 64);
  CHECK(info.height == 48);
  CHECK(info.k == std::array<double, 9>{50, 0, 31.5, 0, 60, 23.5, 0, 0, 1});
  CHECK(info.p == std::array<double, 12>{50, 0, 31.5, -25, 0, 60, 23.5, 0, 0, 0, 1, 0});
  CHECK(info.distortion_model == "plumb_bob");
  CHECK(info.d == std::vector<double>(5, 0));
  const DisparityImage disparity = disparity_image(simvis::Image{2, 1, 1, {3, 0}}, right, {});
  CHECK(disparity.f == 50);
  CHECK(disparity.t == 0.5f);
  CHECK(disparity.max_disparity == 3);
  CHECK(disparity.image.encoding == "32FC1");
}

TEST_CASE("a twist is the mean velocity in the body's frame") {
  const glm::dmat4 still(1);
  // Half a turn about z in two seconds, 4 m along the world's x: at the end the body looks along -x.
  glm::dmat4 moved = glm::rotate(glm::dmat4(1), glm::radians(180.0), glm::dvec3(0, 0, 1));
  moved[3] = glm::dvec4(4, 0, 0, 1);
  const Twist twist = mean_twist({1'000'000'000, still}, {3'000'000'000, moved});
  CHECK(twist.linear.x == doctest::Approx(-2).epsilon(kRounding));
  CHECK(std::abs(twist.linear.y) < kRounding);
  CHECK(std::abs(twist.angular.z) == doctest::Approx(glm::radians(90.0)).epsilon(kRounding));
  CHECK(mean_twist({0, moved}, {1, moved}).angular.z == 0);
  const Odometry odom = odometry({1'000'000'000, still}, {3'000'000'000, moved}, "map", "ROBOT");
  CHECK(odom.header.frame_id == "map");
  CHECK(odom.child_frame_id == "ROBOT");
  CHECK(odom.pose.pose.position.x == 4);
  CHECK(odom.twist.twist.linear.x == twist.linear.x);
}

TEST_CASE("a transform that cannot move is fixed until it moves") {
  const auto at = [](double x) { return glm::translate(glm::dmat4(1), glm::dvec3(x, 0, 0)); };
  Transforms transforms;
  transforms.begin(0);
  transforms.set("map", "ROBOT", at(0), true);
  transforms.set("ROBOT", "ARM", at(1), false);
  transforms.set("ROBOT", "EYE", at(2), false);
  CHECK(transforms.moving().transforms.size() == 1);  // what can move
  const std::optional<TFMessage> fixed = transforms.new_fixed();
  REQUIRE(fixed);
  CHECK(fixed->transforms.size() == 2);
  transforms.begin(1);
  transforms.set("ROBOT", "ARM", at(1 + 0.5 * Transforms::kFixed_m), false);
  CHECK(transforms.moving().transforms.empty());
  CHECK_FALSE(transforms.new_fixed());
  for (const double x : {1 + 2 * Transforms::kFixed_m, 1.0}) {  // from now on, also when it comes back
    transforms.begin(2);
    transforms.set("ROBOT", "ARM", at(x), false);
    REQUIRE(transforms.moving().transforms.size() == 1);
    CHECK(transforms.moving().transforms[0].child_frame_id == "ARM");
    CHECK(transforms.moving().transforms[0].transform.translation.x == x);
  }
  const std::optional<TFMessage> left = transforms.new_fixed();
  REQUIRE(left);
  REQUIRE(left->transforms.size() == 1);
  CHECK(left->transforms[0].child_frame_id == "EYE");
}

TEST_CASE("names of topics") {
  CHECK(topic_name("FRONT", "scan") == "/FRONT/scan");
  CHECK(topic_name("2/LEFT-ARM/CAM 1", "image") == "/n2/LEFT_ARM/CAM_1/image");
}

TEST_CASE("patterns of topics") {
  TopicFilter all({});
  CHECK(all.wants("/a/b"));
  CHECK_FALSE(all.wants("/a/b", TopicForm::other));
  TopicFilter some({"/CAM/*", "/t?", "/none"});
  CHECK(some.wants("/CAM/image_raw/compressed", TopicForm::other));
  CHECK(some.wants("/tf"));
  CHECK_FALSE(some.wants("/tf_static"));
  CHECK(some.unmatched() == std::vector<std::string>{"/none"});
}

}  // namespace
}  // namespace simvis::ros

TEST_SUITE_END();
