// Rectified pairs of worlds whose pixels follow from geometry, their disparity, and the written files.
#include "sensors/camera/stereo_camera.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <set>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "program/output/output_writer.h"
#include "tests/support/infinity.h"
#include "tests/support/measured_images.h"
#include "tests/support/picture_files.h"
#include "tests/support/renderer_scene.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

/// A bright plate that faces the camera: its left, right, top and bottom edges in pixels of the left picture.
struct StereoPlate {
  double depth_m, left_px, right_px, top_px, bottom_px;
};

// The edges are at least 0.1 pixels away from all centres of pixels in both pictures (checked below). float32 moves a
// corner by less than a thousandth, and drivers snap to 1/256 of a pixel.
constexpr double kEdgeMargin_px = 0.1;
constexpr StereoPlate kStereoPlates[] = {{1.0, 60.0, 80.0, 10.0, 20.0},
                                         {1.5, 20.2, 50.7, 30.0, 34.2},
                                         {2.0, 90.0, 95.9, 50.3, 60.0},
                                         {7.0, 55.0, 60.0, 62.0, 70.0}};

constexpr std::uint32_t kWidth_px = 120, kHeight_px = 80;
constexpr double kFocal_px = 100, kBaseline_m = 0.12;

double hfov(std::uint32_t width_px) { return 2 * std::atan(width_px / (2 * kFocal_px)); }

StereoCameraDesc desc_of(std::uint32_t width_px) {
  return {.pinhole = {.width_px = width_px, .height_px = kHeight_px, .hfov_rad = hfov(width_px)},
          .baseline_m = kBaseline_m,
          .color = true,
          .depth = true,
          .disparity = true};
}

/// The plates in front of the left camera of a sensor at `world_from_sensor`, with a black background.
test::RendererScene plates_scene(const glm::dmat4& world_from_sensor, std::uint32_t width_px) {
  test::RendererScene scene;
  scene.list.environment.background = glm::vec3(0);
  Material bright;
  bright.unlit = bright.double_sided = true;
  for (const StereoPlate& p : kStereoPlates) {
    const auto place = [&](double px, double middle_px) {
      return static_cast<float>((px - middle_px) * p.depth_m / kFocal_px);
    };
    const double cx = width_px / 2.0, cy = kHeight_px / 2.0;
    scene.add(test::rectangle(place(p.left_px, cx), place(p.top_px, cy), place(p.right_px, cx), place(p.bottom_px, cy)),
              bright, world_from_sensor * sensor_from_view() * test::at(0, 0, p.depth_m));
  }
  return scene;
}

void take(StereoCamera& camera, const DrawList& list, const glm::dmat4& world_from_sensor = glm::dmat4(1)) {
  Renderer renderer(test::device());
  FramePlan plan;
  camera.plan(world_from_sensor, list, plan);
  camera.collect({}, plan, renderer.render(list, plan));
}

bool clear_of_centres(double edge_px) { return std::abs(edge_px - 0.5 - std::round(edge_px - 0.5)) >= kEdgeMargin_px; }

/// The plate at a pixel of a picture in which the plates are shifted `shift(plate)` pixels to the left; null for none.
const StereoPlate* plate_at(std::uint32_t x, std::uint32_t y, const std::function<double(const StereoPlate&)>& shift) {
  for (const StereoPlate& p : kStereoPlates) {
    const double u = x + 0.5 + shift(p), v = y + 0.5;
    if (u > p.left_px && u < p.right_px && v > p.top_px && v < p.bottom_px) return &p;
  }
  return nullptr;
}

std::vector<std::string> names_of(const StereoCamera& camera) {
  std::vector<std::string> names;
  for (const MeasuredArray& each : camera.measurement().arrays) names.push_back(each.name);
  return names;
}

/// Compares every pixel of all five pictures with the plates.
void check_plates(const StereoCamera& camera, std::uint32_t width_px) {
  // Corners are at most 10 m away (counted 16 times, because each step rounds them). A disparity is at most 12 px, with
  // the same relative error as its depth.
  constexpr double kDepthTolerance_m = 16 * 10 * 0x1p-24, kDisparityTolerance_px = 12 * kDepthTolerance_m / 1.0;
  const auto disparity_of = [](const StereoPlate& p) { return kFocal_px * kBaseline_m / p.depth_m; };
  const auto none = [](const StereoPlate&) { return 0.0; };
  const Image left = image_of(camera, "left"), right = image_of(camera, "right");
  const Image left_depth = image_of(camera, "left_depth"), right_depth = image_of(camera, "right_depth");
  const Image disparity = image_of(camera, "disparity");
  for (const Image* image : {&left, &right, &left_depth, &right_depth, &disparity}) {
    REQUIRE(image->width == width_px);
    REQUIRE(image->height == kHeight_px);
    REQUIRE(image->pixels.size() == std::size_t{width_px} * kHeight_px * image->channels);
  }
  int wrong = 0, seen_left = 0, seen_right = 0;
  for (std::uint32_t y = 0; y < kHeight_px; ++y) {
    for (std::uint32_t x = 0; x < width_px; ++x) {
      const std::size_t i = std::size_t{y} * width_px + x;
      const StereoPlate *const in_left = plate_at(x, y, none), *const in_right = plate_at(x, y, disparity_of);
      seen_left += in_left != nullptr;
      seen_right += in_right != nullptr;
      wrong += left.pixels[4 * i] != (in_left ? 1 : 0);
      wrong += right.pixels[4 * i] != (in_right ? 1 : 0);
      if (in_left == nullptr) {
        wrong += left_depth.pixels[i] != kInfinity || disparity.pixels[i] != 0;
      } else {
        wrong += !(std::abs(left_depth.pixels[i] - in_left->depth_m) <= kDepthTolerance_m);
        wrong += !(std::abs(disparity.pixels[i] - disparity_of(*in_left)) <= kDisparityTolerance_px);
      }
      if (in_right == nullptr) {
        wrong += right_depth.pixels[i] != kInfinity;
      } else {
        wrong += !(std::abs(right_depth.pixels[i] - in_right->depth_m) <= kDepthTolerance_m);
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(seen_left > 300);
  CHECK(seen_right > 300);
}

}  // namespace

TEST_CASE("a point that the left camera sees at u is at u - disparity in the right one") {
  for (const StereoPlate& p : kStereoPlates) {
    const double shift = kFocal_px * kBaseline_m / p.depth_m;
    for (const double edge : {p.left_px, p.right_px, p.top_px, p.bottom_px, p.left_px - shift, p.right_px - shift}) {
      CHECK(clear_of_centres(edge));
    }
  }
  StereoCamera camera("S", desc_of(kWidth_px));
  take(camera, plates_scene(glm::dmat4(1), kWidth_px).list);
  check_plates(camera, kWidth_px);
  CHECK(camera.measurement().find("middle") == nullptr);
}

TEST_CASE("a rotated and moved pair sees the same pictures of objects that move with it") {
  for (const Pose& pose : {Pose{{3, -2, 1}, 0, 0, 2.1}, Pose{{-1, 4, 2}, 0.4, -0.7, -1.3}}) {
    const glm::dmat4 world_from_sensor = to_matrix(pose);
    StereoCamera camera("S", desc_of(kWidth_px));
    take(camera, plates_scene(world_from_sensor, kWidth_px).list, world_from_sensor);
    check_plates(camera, kWidth_px);
  }
}

TEST_CASE("the right camera is at -y of the left one") {
  StereoCamera camera("S", desc_of(kWidth_px));
  FramePlan plan;
  const glm::dmat4 world_from_sensor = to_matrix({{5, 6, 7}, 0, 0, std::numbers::pi / 2});
  camera.plan(world_from_sensor, {}, plan);
  REQUIRE(plan.passes.size() == 1);
  REQUIRE(plan.passes[0].views.size() == 2);
  // When it looks along +y, its right is +x.
  const glm::dvec3 left(rigid_inverse(plan.passes[0].views[0].view_from_world)[3]);
  const glm::dvec3 right(rigid_inverse(plan.passes[0].views[1].view_from_world)[3]);
  constexpr double kRounding_m = 32 * 7 * 0x1p-53;
  CHECK(glm::length(left - glm::dvec3(5, 6, 7)) <= kRounding_m);
  CHECK(glm::length(right - glm::dvec3(5 + kBaseline_m, 6, 7)) <= kRounding_m);
}

TEST_CASE("both views share a pass if they fit, and take two passes otherwise") {
  StereoCamera narrow("S", desc_of(2048)), wide("S", desc_of(2050));
  FramePlan one, two;
  narrow.plan(glm::dmat4(1), {}, one);
  wide.plan(glm::dmat4(1), {}, two);
  REQUIRE(one.passes.size() == 1);
  CHECK(one.passes[0].width_px == 4096);
  CHECK(one.passes[0].views[1].x_px == 2048);
  REQUIRE(two.passes.size() == 2);
  CHECK(two.passes[0].width_px == 2050);
  CHECK(two.passes[1].views[0].x_px == 0);
  // The plates are in the left part of the picture; the pictures in two passes equal those in one.
  take(wide, plates_scene(glm::dmat4(1), 2050).list);
  check_plates(wide, 2050);
}

TEST_CASE("only requested outputs are rendered") {
  StereoCameraDesc desc = desc_of(kWidth_px);
  desc.color = desc.depth = false;
  StereoCamera disparity("S", desc);
  FramePlan plan;
  disparity.plan(glm::dmat4(1), {}, plan);
  REQUIRE(plan.passes.size() == 1);
  CHECK(plan.passes[0].views.size() == 1);
  CHECK_FALSE(plan.passes[0].color);
  CHECK(names_of(disparity) == std::vector<std::string>{"disparity"});

  desc.color = true;
  desc.disparity = false;
  StereoCamera color("S", desc);
  plan.passes.clear();
  color.plan(glm::dmat4(1), {}, plan);
  REQUIRE(plan.passes.size() == 1);
  CHECK(plan.passes[0].views.size() == 2);
  CHECK(plan.passes[0].color);
  CHECK_FALSE(plan.passes[0].depth);
  CHECK(names_of(color) == std::vector<std::string>{"left", "right"});
}

namespace {

const std::string kEyes = R"(
<sensor type="stereo_camera" name="EYES" insert_at="ROOT" width="64" height="48" hfov="90" baseline="0.25"/>)";

void write_frame(Simulation& simulation, OutputWriter& writer) {
  const FrameTime time = simulation.next_frame();
  simulation.step();
  for (const std::string& name : simulation.measured()) {
    glm::dmat4 pose;
    REQUIRE(simulation.sensor_pose(name, pose));
    writer.write(name, time, pose, simulation.measurement(name));
  }
}

/// A number of a row-major matrix in a YAML file.
double entry(const std::string& yaml, const std::string& matrix, std::size_t index) {
  std::size_t at = yaml.find("data: [", yaml.find(matrix + ":")) + 7;
  for (std::size_t i = 0; i < index; ++i) at = yaml.find(", ", at) + 2;
  return std::stod(yaml.substr(at));
}

}  // namespace

TEST_CASE("the files of a run") {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), kEyes));
  const std::vector<std::string> names = {"EYES"};
  OutputWriter writer({.folder = folder / "out", .sensors = names});
  write_frame(simulation, writer);
  writer.end_frame();
  write_frame(simulation, writer);  // files of the frame before are written meanwhile
  write_text(folder / "out/EYES_left.yaml", "as the first frame left it");
  write_frame(simulation, writer);
  writer.finish();
  CHECK(read_text(folder / "out/EYES_left.yaml") == "as the first frame left it");
  CHECK(files_below(folder / "out") ==
        std::vector<std::string>{"EYES_disparity/000000.exr", "EYES_disparity/000001.exr", "EYES_disparity/000002.exr",
                                 "EYES_left.yaml", "EYES_left/000000.png", "EYES_left/000001.png",
                                 "EYES_left/000002.png", "EYES_poses.csv", "EYES_poses.tum", "EYES_right.yaml",
                                 "EYES_right/000000.png", "EYES_right/000001.png", "EYES_right/000002.png"});
  const ExrPicture exr = read_exr(folder / "out/EYES_disparity/000000.exr");
  REQUIRE(exr.channels.size() == 1);
  const std::vector<float>& disparity = exr.channels.at("disparity");
  CHECK(disparity == simulation.picture("EYES", "disparity").pixels);
  // fx = 32, and the wall is 4 m away and reaches 10 m to the sides: 2 pixels everywhere, with the relative error of
  // the depth.
  constexpr double kTolerance_px = 2 * 16 * 10 * 0x1p-24 / 4;
  REQUIRE(disparity.size() == 64 * 48);
  for (const float d : disparity) CHECK(std::abs(d - 2) <= kTolerance_px);
  CHECK(simulation.color("EYES").pixels.data() == simulation.picture("EYES", "left").pixels.data());
  CHECK_THROWS_WITH_AS(simulation.picture("EYES", "right_depth"),
                       R"(sensor "EYES", a stereo_camera, has no picture "right_depth")", InputError);
}

TEST_CASE("intrinsics in the layout of ROS's camera_info") {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), kEyes));
  const std::vector<std::string> names = {"EYES"};
  OutputWriter writer({.folder = folder / "out", .sensors = names});
  write_frame(simulation, writer);
  writer.finish();
  const std::string left = read_text(folder / "out/EYES_left.yaml"), right = read_text(folder / "out/EYES_right.yaml");
  const std::string fx = format_number(64 / (2 * std::tan(std::numbers::pi / 4)));
  CHECK(left ==
        "image_width: 64\nimage_height: 48\ncamera_name: 'EYES_left'\n"
        "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [" +
            fx + ", 0, 31.5, 0, " + fx +
            ", 23.5, 0, 0, 1]\n"
            "distortion_model: plumb_bob\n"
            "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n"
            "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
            "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [" +
            fx + ", 0, 31.5, 0, 0, " + fx + ", 23.5, 0, 0, 0, 1, 0]\n");
  CHECK(right.find("camera_name: 'EYES_right'\n") != std::string::npos);
  CHECK(std::abs(entry(right, "projection_matrix", 3) - -32 * 0.25) <= 8 * 0x1p-50);
  CHECK(entry(right, "camera_matrix", 2) == 31.5);

  // P projects to the pictures: a point 4 m ahead and 1 m to the right, counted from pixel centres.
  const double u_left = (entry(left, "projection_matrix", 0) * 1 + entry(left, "projection_matrix", 2) * 4) / 4;
  const double u_right = (entry(right, "projection_matrix", 0) * 1 + entry(right, "projection_matrix", 2) * 4 +
                          entry(right, "projection_matrix", 3)) /
                         4;
  CHECK(std::abs(u_left + 0.5 - 40) <= 40 * 8 * 0x1p-53);
  CHECK(std::abs(u_left - u_right - 2) <= 40 * 8 * 0x1p-53);
}

TEST_CASE("two sensors never write the same files") {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(
      folder.path(), kEyes + R"(<sensor type="camera" name="EYES_left" insert_at="ROOT" width="8" height="8"/>)"));
  const std::vector<std::string> names = {"EYES", "EYES_left"};
  OutputWriter writer({.folder = folder / "out", .sensors = names});
  try {
    write_frame(simulation, writer);
    FAIL("nothing was refused");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).starts_with("sensors \"EYES\" and \"EYES_left\" would both write "));
  }
}

TEST_SUITE_END();
