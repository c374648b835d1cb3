// Pictures through lenses. The colour of the room is an affine function of the place, so the colour and depth of each
// pixel follow from its ray.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "effects/camera/lens_distortion.h"
#include "sensors/camera/camera.h"
#include "tests/support/error_of.h"
#include "tests/support/made_lens.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"
#include "tests/support/renderer_scene.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wall_scene.h"

#ifdef SIMVIS_HAS_OPENCV
#include <opencv2/calib3d.hpp>
#include "program/output/camera_info.h"
#endif

TEST_SUITE_BEGIN("effects");

using namespace simvis;

namespace {

const glm::dvec3 kHalfRoom_m(5, 4, 3);
const glm::dvec3 kSlope[3] = {{0.05, 0.02, -0.03}, {-0.02, 0.06, 0.03}, {0.01, -0.04, 0.08}};  // of R, G and B, 1/m

// Rounding of vertices (at most 10 m) and of interpolation in float32: about ten operations each, on colours of at most
// 1 with a slope of at most 0.1 per metre and 3 per radian. Snapping of vertices moves no colour on lavapipe, and
// elsewhere by 1/256 pixel of 1/100 radian.
constexpr double kColorRounding = 2e-4;

double color_at(const glm::dvec3& place_m, int channel) { return 0.5 + glm::dot(kSlope[channel], place_m); }

test::RendererScene room() {
  test::RendererScene scene;
  Mesh mesh = half_box_mesh(glm::vec3(kHalfRoom_m));
  mesh.attributes.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (int c = 0; c < 3; ++c) mesh.attributes[i].color[c] = static_cast<float>(color_at(mesh.positions[i], c));
  }
  compute_bounds(mesh);
  Material material;
  material.unlit = material.double_sided = true;
  scene.add(std::move(mesh), material, glm::dmat4(1));
  return scene;
}

// No surface of the room is perpendicular to the camera's axis.
const glm::dmat4 kWorldFromCamera = to_matrix({{0.7, -0.4, 0.3}, 0.2, 0.3, 0.5});

// Where a ray of the view frame hits the room.
glm::dvec3 met(const glm::dvec3& ray) {
  const glm::dvec3 eye(kWorldFromCamera[3]);
  const glm::dvec3 direction = glm::dmat3(kWorldFromCamera * sensor_from_view()) * ray;
  double range_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double wall = direction[axis] > 0 ? kHalfRoom_m[axis] : -kHalfRoom_m[axis];
    if (direction[axis] != 0) range_m = std::min(range_m, (wall - eye[axis]) / direction[axis]);
  }
  return eye + range_m * direction;
}

double true_color(const glm::dvec3& ray, int channel) { return color_at(met(ray), channel); }

double true_depth(const glm::dvec3& ray) {
  const glm::dmat4 view_from_world = rigid_inverse(kWorldFromCamera * sensor_from_view());
  return (view_from_world * glm::dvec4(met(ray), 1)).z;
}

struct Lensed {
  test::MadeLens lens;
  double oversampling = 1;
  std::uint32_t width_px = 200, height_px = 160;
};

ChosenCameraEffect lens_effect(const Lensed& l) {
  const std::string xml = R"(<sensor type="camera" name="C" insert_at="ROOT" )" + test::lens_attributes(l.lens) +
                          " lens_oversampling=\"" + format_number(l.oversampling) + "\"/>";
  const std::vector<Command> commands = parse_commands(xml, "test", ".");
  const std::vector<AttributeSpec> table = all_attributes(*find_sensor_type("camera"));
  const AttributeValues values(commands[0], table, kSensorCommonAttributes);
  return {find_effect_type("lens_distortion"), std::make_shared<LensDistortion>(test::lens_type(l.lens), values)};
}

Camera lens_camera(const Lensed& l) {
  const Pinhole& p = l.lens.pinhole;
  return {"C",
          {.pinhole = {.width_px = l.width_px,
                       .height_px = l.height_px,
                       .fx_px = p.fx_px,
                       .fy_px = p.fy_px,
                       .column_px = p.cx_px - 0.5,
                       .row_px = p.cy_px - 0.5},
           .color = true,
           .depth = true,
           .effects = {lens_effect(l)}}};
}

void take(Camera& camera, const DrawList& list, FramePlan& plan) {
  static Renderer renderer(test::device());
  camera.begin({});
  camera.plan(kWorldFromCamera, list, plan);
  camera.collect({}, plan, renderer.render(list, plan));
}

struct Errors {
  double color = 0;         // the largest
  double color_excess = 0;  // the largest above the allowed interpolation error
  double depth_m = 0, depth_excess_m = 0;
  std::size_t pixels = 0, beside_steps = 0;
};

// Bound of the interpolation between the pixels of a view with a pitch of at most `pitch` radians. Anywhere in a pixel,
// the error is at most an eighth of the second difference over two pitches along each axis. The second differences of
// the true colour are taken about the ray itself over twice the pitch: that is four times as much where the truth is
// smooth, and at a kink no less than what the kink gives within a pitch.
double interpolation_bound(const glm::dvec3& ray, double pitch, int channel) {
  const glm::dvec3 a =
      glm::normalize(glm::cross(ray, std::abs(ray.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 b = glm::cross(ray, a);
  double most = 0;
  for (int turn = 0; turn < 4; ++turn) {
    const double angle = turn * 3.14159265358979 / 4;
    const glm::dvec3 step = 2 * pitch * (std::cos(angle) * a + std::sin(angle) * b);
    most = std::max(most, std::abs(true_color(ray + step, channel) - 2 * true_color(ray, channel) +
                                   true_color(ray - step, channel)));
  }
  return 2 * most;  // for the two axes
}

// Of a depth within ten metres that is interpolated on one wall: a thousand roundings of float32. Pixels that show two
// walls or three are off by far more.
constexpr double kOneSurface_m = 1024 * 0x1p-24 * 10;

Errors compare(const Camera& camera, const Lensed& l) {
  const Lens lens = test::made(l.lens);
  Errors e;
  const Image color = color_of(camera), depth = depth_of(camera);
  for (std::uint32_t y = 0; y < l.height_px; ++y) {
    for (std::uint32_t x = 0; x < l.width_px; ++x) {
      const std::size_t i = std::size_t{y} * l.width_px + x;
      const float* const pixel = color.pixels.data() + 4 * i;
      const float depth_m = depth.pixels[i];
      const glm::dvec3 ray = lens.direction({x + 0.5, y + 0.5}).value();
      CHECK(pixel[3] == 1);
      if (ray == glm::dvec3(0)) {
        if (pixel[0] != 0 || pixel[1] != 0 || pixel[2] != 0 || depth_m != std::numeric_limits<float>::infinity()) {
          FAIL("a pixel beyond the lens shows something");
        }
        continue;
      }
      ++e.pixels;
      const double pitch = 1 / (l.oversampling * std::min(l.lens.pinhole.fx_px, l.lens.pinhole.fy_px));
      for (int c = 0; c < 3; ++c) {
        const double off = std::abs(static_cast<double>(pixel[c]) - true_color(ray, c));
        e.color = std::max(e.color, off);
        e.color_excess = std::max(e.color_excess, off - interpolation_bound(ray, pitch, c));
      }
      const double depth_off_m = std::abs(static_cast<double>(depth_m) - true_depth(ray));
      e.depth_m = std::max(e.depth_m, depth_off_m);
      // The edges of the room are creases, where the view has no finer information than that.
      if (depth_off_m > kOneSurface_m) ++e.beside_steps;
    }
  }
  return e;
}

const Lensed kBarrel{{"brown_conrady", {150, 145, 101.25, 78.75}, {-0.28, 0.09, 1e-3, -2e-3, -0.01}}};
// 220 degrees in an image circle of 192 pixels.
const Lensed kFisheye{{"kannala_brandt", {50, 50, 100, 80}, {0, 0, 0, 0}}};
const Lensed kBentFisheye{{"kannala_brandt", {60, 58, 96.2, 83.1}, {-0.02, 0.003, -0.0005, 0}}};
// All 14 coefficients, and fisheyes of the other models that are black in the corners.
const Lensed kTilted{{"rational_polynomial",
                      {150, 145, 101.25, 78.75},
                      {0.5, 0.1, 1e-3, -2e-3, 0.01, 0.7, 0.15, 0.02, 3e-3, -1e-3, 2e-3, 5e-4, 0.05, -0.03}}};
const Lensed kDoubleSphere{{"double_sphere", {45, 44, 98, 81.5}, {-0.1, 0.55}}};
const Lensed kFTheta{{"ftheta", {52, 52, 97, 82}, {0, 52, -1, 0.5}}};
const Lensed kBackward{{"ftheta_backward", {50, 50, 103.5, 79}, {0, 0.02, -2e-6, 1e-8}}};

}  // namespace

TEST_CASE("every pixel of a distorted image shows what its ray hits, also across borders of views") {
  const test::RendererScene scene = room();
  for (const Lensed& lens : {kBarrel, kFisheye, kBentFisheye, kTilted, kDoubleSphere, kFTheta, kBackward}) {
    CAPTURE(lens.lens.model);
    const bool is_fisheye = lens.lens.pinhole.fx_px < 100;
    Camera camera = lens_camera(lens);
    FramePlan plan;
    take(camera, scene.list, plan);
    CHECK(plan.passes.size() == 1);
    CHECK(plan.passes[0].views.size() == (is_fisheye ? 5 : 1));
    const Errors e = compare(camera, lens);
    CHECK(e.pixels > 20'000);
    CHECK(e.color_excess <= kColorRounding);
    // Only pixels at the edges of the room are off, and where three walls meet they do not say by how much: the largest
    // error of the image has no bound.
    CHECK(e.beside_steps > 0);
    CHECK(50 * e.beside_steps <= e.pixels);
    CHECK(std::isinf(requested(camera, "depth_error_bound_m")));
    MESSAGE("largest error of colour " << e.color << ", of depth " << e.depth_m << " m, bound "
                                       << requested(camera, "depth_error_bound_m") << " m, beside " << e.beside_steps);
  }
}

TEST_CASE("twice the oversampling reduces the interpolation error to a quarter") {
  const test::RendererScene scene = room();
  double sum[2] = {0, 0};
  for (int i = 0; i < 2; ++i) {
    // The picture has few pixels, so the interpolation error is much larger than rounding.
    Lensed lens{{"kannala_brandt", {12.5, 12.5, 25, 20}, {0, 0, 0, 0}}, 0, 50, 40};
    lens.oversampling = i == 0 ? 2 : 4;
    Camera camera = lens_camera(lens);
    FramePlan plan;
    take(camera, scene.list, plan);
    const Lens model = test::made(lens.lens);
    const Image color = color_of(camera);
    for (std::uint32_t y = 0; y < lens.height_px; ++y) {
      for (std::uint32_t x = 0; x < lens.width_px; ++x) {
        const glm::dvec3 ray = model.direction({x + 0.5, y + 0.5}).value();
        if (ray == glm::dvec3(0)) continue;
        const double off =
            static_cast<double>(color.pixels[4 * (std::size_t{y} * lens.width_px + x)]) - true_color(ray, 0);
        sum[i] += std::abs(off);
      }
    }
  }
  MESSAGE("mean error falls by a factor of " << sum[0] / sum[1]);
  // A second-order method gives the factor four, a first-order one two. (From an oversampling of 1 the factor would be
  // less than four, because there the rays in the middle hit the centres of pixels.)
  CHECK(sum[0] / sum[1] > 3);
}

TEST_CASE("a lens without distortion gives the picture of a pinhole camera") {
  const test::RendererScene scene = room();
  const Lensed straight{{"brown_conrady", {600, 600, 100, 80}, {0, 0, 0, 0, 0}}};  // it sees one wall
  Camera camera = lens_camera(straight);
  Camera plain("P", {.pinhole = {.width_px = 200, .height_px = 160, .hfov_rad = 2 * std::atan(100.0 / 600)},
                     .color = true,
                     .depth = true});
  FramePlan plan, plain_plan;
  take(camera, scene.list, plan);
  take(plain, scene.list, plain_plan);
  const auto largest_difference = [](const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
      largest = std::max(largest, std::abs(static_cast<double>(a.pixels[i] - b.pixels[i])));
    }
    return largest;
  };
  CHECK(largest_difference(color_of(camera), color_of(plain)) <= kColorRounding);
  const double depth = largest_difference(depth_of(camera), depth_of(plain));
  CHECK(std::isfinite(requested(camera, "depth_error_bound_m")));
  CHECK(depth <= requested(camera, "depth_error_bound_m") + requested(plain, "depth_error_bound_m"));
}

#ifdef SIMVIS_HAS_OPENCV

TEST_CASE("OpenCV removes the distortion") {
  const test::RendererScene scene = room();
  Camera camera = lens_camera(kBarrel);
  FramePlan plan;
  take(camera, scene.list, plan);
  const Image& image = color_of(camera);
  const Pinhole& p = kBarrel.lens.pinhole;
  const double cx = p.cx_px - 0.5, cy = p.cy_px - 0.5;
  const cv::Matx33d matrix(p.fx_px, 0, cx, 0, p.fy_px, cy, 0, 0, 1);
  cv::Mat from_x, from_y;
  cv::initUndistortRectifyMap(matrix, kBarrel.lens.coefficients, cv::noArray(), matrix, {200, 160}, CV_32FC1, from_x,
                              from_y);
  // Errors of the distorted image, which is interpolated again: its own error, and an eighth of its second differences
  // per axis, which grow by the magnification of the lens, here below 1.3. The map is rounded to 2^-17 pixels.
  double worst = 0;
  std::size_t pixels = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double u = from_x.at<float>(y, x), v = from_y.at<float>(y, x);
      if (!(u >= 0 && v >= 0 && u < 199 && v < 159)) continue;
      ++pixels;
      const auto column = static_cast<std::size_t>(u), row = static_cast<std::size_t>(v);
      const double fx = u - static_cast<double>(column), fy = v - static_cast<double>(row);
      const glm::dvec3 ray = glm::normalize(glm::dvec3((x - cx) / p.fx_px, (y - cy) / p.fy_px, 1));
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = [&](std::size_t dx, std::size_t dy) {
          return static_cast<double>(image.pixels[4 * ((row + dy) * 200 + column + dx) + c]);
        };
        const double seen =
            (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) + fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
        const auto channel = static_cast<int>(c);
        const double allowed = 2 * interpolation_bound(ray, 1.3 / 145, channel);
        worst = std::max(worst, std::abs(seen - true_color(ray, channel)) - allowed);
      }
    }
  }
  CHECK(pixels > 25'000);
  CHECK(worst <= kColorRounding);
}

#endif

TEST_CASE("a wrong lens is an error with its place") {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& attributes) {
    const auto scene =
        write_wall_scene(folder.path(), R"(<sensor type="camera" name="C" insert_at="ROOT" )" + attributes + "/>");
    return error_of([&] { Simulation::load(scene); });
  };
  const std::string folds = error(R"(hfov="90" distortion="brown_conrady" k1="-0.3")");
  CHECK(contains(folds,
                 "scene.xml:3:59: error: attribute \"distortion\": with these coefficients the lens shows nothing "
                 "at column 0 of row 0, expected a lens that fills the image: this one folds at 224.8"));
  CHECK(contains(error(R"(distortion="kannala_brandt" k1="-0.3")"), "the lens shows nothing at column"));
  CHECK(contains(error(R"(distortion="brown" k1="1")"), "none, brown_conrady, kannala_brandt, rational_polynomial"));
  struct Case {
    const char *attributes, *message;
  };
  for (const Case& wrong : {
           Case{R"(distortion="kannala_brandt" p1="0.1")",
                "scene.xml:3:77: error: attribute \"p1\" is not allowed with distortion=\"kannala_brandt\", expected "
                "k1, "
                "k2, k3, k4"},
           {R"(distortion="brown_conrady" k1="nan")", "scene.xml:3:76: error: attribute \"k1\": \"nan\""},
           {R"(distortion="rational_polynomial" k4="inf")", "scene.xml:3:82: error: attribute \"k4\": \"inf\""},
           {R"(distortion="rational_polynomial" k1="-0.3" hfov="90")", "the lens shows nothing at column 0 of row 0"},
           {R"(distortion="rational_polynomial" tau_x="90")",
            "\"tau_x\": 90 is not allowed, expected a number greater "
            "than -90 and below 90 (deg)"},
           {R"(distortion="rational_polynomial" tau_y="-90")", "\"tau_y\": -90 is not allowed"},
           {R"(distortion="rational_polynomial" tau_y="80" hfov="100")", "the lens shows nothing at column"},
           {R"(distortion="double_sphere" alpha="1.01")",
            "\"alpha\": 1.01 is not allowed, expected a number from 0 to 1"},
           {R"(distortion="double_sphere" alpha="-0.01")", "\"alpha\": -0.01 is not allowed"},
           {R"(distortion="double_sphere" xi="-1")", "\"xi\": -1 is not allowed, expected a number greater than -1"},
           {R"(distortion="double_sphere" xi="1.01")", "\"xi\": 1.01 is not allowed"},
           {R"(distortion="double_sphere" alpha="1" hfov="90")", "the lens shows nothing at column 0 of row 0"},
           {R"(distortion="ftheta")", "scene.xml:3:49: error: attribute \"distortion\": f-theta needs a polynomial"},
           {R"(distortion="ftheta" polynomial="0 400 x")",
            "scene.xml:3:69: error: attribute \"polynomial\": \"0 400 x\" is "
            "not allowed, expected two to six finite numbers"},
           {R"(distortion="ftheta" polynomial="0 400 inf")", "expected two to six finite numbers"},
           {R"(distortion="ftheta" polynomial="0")", "expected two to six finite numbers"},
           {R"(distortion="ftheta" polynomial="0 400 0 0 0 0 0")", "expected two to six finite numbers"},
           {R"(distortion="ftheta" polynomial="1 400")", "of which the first is 0"},
           {R"(distortion="ftheta_backward" polynomial="0 1e-320")", "and the second is above 0"},
           {R"(distortion="ftheta_backward" polynomial="0 -1")", "and the second is above 0"},
           {R"(distortion="ftheta" polynomial="0 400 -200")", "this one folds at 200 px from the principal point"},
           {R"(distortion="ftheta_backward" polynomial="0 0.005 -2e-5")", "this one folds at 125 px"},
           {R"(distortion="ftheta" polynomial="0 400" hfov="60")",
            "attribute \"hfov\" is allowed only without fx, and with a lens that has no focal length of its own"},
           {R"(distortion="ftheta" polynomial="0 400" fy="400")",
            "attribute \"fy\" is allowed only with a lens that has no focal length of its own"},
           {R"(fx="400" hfov="60")", "scene.xml:3:58: error: attribute \"hfov\" is allowed only without fx"},
           {R"(fx="-400")",
            "scene.xml:3:49: error: attribute \"fx\": -400 is not allowed, expected a number greater than 0"},
           {R"(fy="0")", "attribute \"fy\": 0 is not allowed"},
           {R"(cx="nan")", "attribute \"cx\": \"nan\""},
       }) {
    CAPTURE(wrong.attributes);
    const std::string message = error(wrong.attributes);
    CHECK_MESSAGE(contains(message, wrong.message), message);
  }
  CHECK(contains(error(R"(distortion="brown_conrady" width="6000" height="4000" lens_oversampling="16")"),
                 "attribute \"lens_oversampling\": with 16 this lens needs a view of"));
}

TEST_CASE("intrinsics and coefficients are written in the form that ROS reads") {
  const auto written = [](const Camera& camera) {
    return camera_info_yaml("C", *camera.measurement().calibration(""));
  };
  const std::string barrel = written(lens_camera(kBarrel));
  CHECK(contains(barrel, "data: [150, 0, 100.75, 0, 145, 78.25, 0, 0, 1]"));
  CHECK(contains(barrel, "distortion_model: plumb_bob\n"));
  CHECK(contains(barrel, "cols: 5\n  data: [-0.28, 0.09, 0.001, -0.002, -0.01]"));
  const std::string fisheye = written(lens_camera(kBentFisheye));
  CHECK(contains(fisheye, "distortion_model: equidistant\n"));
  CHECK(contains(fisheye, "cols: 4\n  data: [-0.02, 0.003, -5.0e-04, 0]"));
  for (const Lensed& each : {kTilted, kDoubleSphere, kFTheta, kBackward}) {
    const std::string text = written(lens_camera(each));
    CAPTURE(text);
    CHECK(contains(text, "distortion_model: " + std::string(each.lens.model) + "\n"));
    CHECK(contains(text, "cols: " + std::to_string(each.lens.coefficients.size()) + "\n  data: ["));
  }
}

TEST_SUITE_END();
