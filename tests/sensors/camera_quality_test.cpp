// Supersampling and MSAA of cameras: the samples of a pixel, the unchanged outputs, the cost in counters, and the
// errors.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <random>

#include <simvis/simulation.h>
#include "engine/base/srgb.h"
#include "program/report/explain.h"
#include "sensors/camera/camera.h"
#include "sensors/camera/stereo_camera.h"
#include "tests/support/error_of.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

using test::device;

// A corner of a triangle is snapped to the rasteriser's grid of 1/256 pixel (or finer), and an edge moves with it. The
// float32 rounding of corners several hundred pixels away adds the same amount.
constexpr double kSnap_px = 1.0 / 256;
constexpr std::uint32_t kSize_px = 24;

// Sample positions of MSAA in a pixel, as shares of it (Vulkan 1.2, section 24.4, standard sample locations).
std::vector<glm::dvec2> standard_places(std::uint32_t msaa) {
  switch (msaa) {
    case 2:
      return {{0.75, 0.75}, {0.25, 0.25}};
    case 4:
      return {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}};
    case 8:
      return {{0.5625, 0.3125}, {0.4375, 0.6875}, {0.8125, 0.5625}, {0.3125, 0.1875},
              {0.1875, 0.8125}, {0.0625, 0.4375}, {0.6875, 0.9375}, {0.9375, 0.0625}};
    default:
      return {{0.5, 0.5}};
  }
}

std::vector<glm::dvec2> sample_places(std::uint32_t supersampling, std::uint32_t msaa) {
  std::vector<glm::dvec2> places;
  for (std::uint32_t y = 0; y < supersampling; ++y) {
    for (std::uint32_t x = 0; x < supersampling; ++x) {
      for (const glm::dvec2& place : standard_places(msaa)) {
        places.push_back((glm::dvec2(x, y) + place) / static_cast<double>(supersampling));
      }
    }
  }
  return places;
}

Material unlit(const glm::vec4& color) {
  Material material = test::colored(color);
  material.unlit = material.double_sided = true;
  return material;
}

// White to the right of a line through `point` (pixels) whose normal has this angle, black to its left.
struct Edge {
  glm::dvec2 point;
  double angle_rad;
  glm::dvec2 normal() const { return {std::cos(angle_rad), std::sin(angle_rad)}; }
  double distance_px(const glm::dvec2& p) const { return glm::dot(p - point, normal()); }
};

test::RendererScene scene_with(const Edge& edge) {
  test::RendererScene scene;
  scene.list.environment.background = glm::vec3(0);
  // A pixel of plan_of(..., kSize_px, ...) is 1 / kSize_px of a metre at 1 m.
  const glm::dvec2 middle(kSize_px / 2.0), p = (edge.point - middle) / static_cast<double>(kSize_px);
  glm::dmat4 m = test::at(p.x, p.y, 1);
  m[0] = {edge.normal(), 0, 0};
  m[1] = {-edge.normal().y, edge.normal().x, 0, 0};
  scene.add(test::rectangle(0, -4, 4, 4), unlit({1, 1, 1, 1}), m);
  return scene;
}

std::vector<glm::vec4> picture(Renderer& renderer, const DrawList& list, FramePlan plan, std::uint32_t supersampling,
                               std::uint32_t msaa) {
  plan.passes[0].supersampling = supersampling;
  plan.passes[0].msaa = msaa;
  return test::copy(renderer.render(list, plan)[0].color);
}

FramePlan square_plan() { return test::plan_of(kSize_px, kSize_px, kSize_px, true, false); }

// The white share of the pixel's square: the square cut by the line, by the shoelace formula.
double covered_share(const Edge& edge, const glm::dvec2& corner) {
  const glm::dvec2 square[] = {corner, corner + glm::dvec2(1, 0), corner + glm::dvec2(1, 1), corner + glm::dvec2(0, 1)};
  std::vector<glm::dvec2> kept;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec2 a = square[i], b = square[(i + 1) % 4];
    const double da = edge.distance_px(a), db = edge.distance_px(b);
    if (da >= 0) kept.push_back(a);
    if ((da < 0) != (db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
  }
  double twice = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const glm::dvec2 a = kept[i], b = kept[(i + 1) % kept.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return twice / 2;
}

// Along each row of the grid (each column for steep edges) the count of samples is wrong by at most half a sample. The
// two rows where the edge leaves the pixel cut a corner of at most an eighth of a sample each.
double grid_quantum(std::uint32_t supersampling) {
  return 0.5 / supersampling + 2 * 0.125 / (supersampling * supersampling);
}

void check_edge(Renderer& renderer, const Edge& edge, std::uint32_t supersampling, std::uint32_t msaa) {
  const std::vector<glm::vec4> seen = picture(renderer, scene_with(edge).list, square_plan(), supersampling, msaa);
  const std::vector<glm::dvec2> places = sample_places(supersampling, msaa);
  const auto count = static_cast<double>(places.size());
  int wrong = 0, uncovered = 0;
  for (std::uint32_t y = 0; y < kSize_px; ++y) {
    for (std::uint32_t x = 0; x < kSize_px; ++x) {
      const glm::dvec2 corner(x, y);
      double least = 0, most = 0;  // white samples, without and with those on the edge itself
      for (const glm::dvec2& place : places) {
        const double distance = edge.distance_px(corner + place);
        least += distance > kSnap_px;
        most += distance > -kSnap_px;
      }
      const glm::vec4& color = seen[y * kSize_px + x];
      // Sums and quotients of whole numbers this small are exact in float32.
      wrong += !(color.r >= least / count && color.r <= most / count && color.r == color.g && color.g == color.b &&
                 color.a == 1);
      if (msaa == 1) {
        const double on_edge = (most - least) / count;
        uncovered += !(std::abs(color.r - covered_share(edge, corner)) <= grid_quantum(supersampling) + on_edge);
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(uncovered == 0);
}

std::filesystem::path marvin() { return std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin/marvin.xml"; }

/// marvin with only ROBOT_CAM.
Simulation robot_cam(int supersampling, int msaa, const char* outputs, int width, int height) {
  SimulationDesc desc;
  const auto set = [&](const char* name, const std::string& value) {
    desc.overrides.push_back({"camera", name, value, "this test"});
  };
  set("supersampling", std::to_string(supersampling));
  set("msaa", std::to_string(msaa));
  set("outputs", outputs);
  set("width", std::to_string(width));
  set("height", std::to_string(height));
  Simulation simulation = Simulation::load(marvin(), desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == "ROBOT_CAM");
  simulation.step();
  return simulation;
}

}  // namespace

TEST_CASE(
    "an edge: a pixel is the mean of its samples at their places, and its covered share within the grid's quantum") {
  Renderer renderer(device());
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int e = 0; e < 24; ++e) {
    const Edge edge{{kSize_px / 2.0 + 4 * unit(random), kSize_px / 2.0 + 4 * unit(random)},
                    e % 4 == 0 ? e / 4 * std::numbers::pi / 2 : 2 * std::numbers::pi * unit(random)};
    for (const std::uint32_t supersampling : {1u, 2u, 4u}) {
      for (const std::uint32_t msaa : device().target_limits().msaa) {
        CAPTURE(e);
        CAPTURE(supersampling);
        CAPTURE(msaa);
        check_edge(renderer, edge, supersampling, msaa);
      }
    }
  }
}

TEST_CASE("a half covered white pixel on black has half the linear light, 188 in sRGB") {
  Renderer renderer(device());
  const std::size_t middle = (kSize_px / 2) * kSize_px + 7;
  const DrawList list = scene_with({{7.5, 12}, 0}).list;
  for (const std::uint32_t supersampling : {2u, 4u}) {
    const std::vector<glm::vec4> seen = picture(renderer, list, square_plan(), supersampling, 1);
    CHECK(seen[middle - 1].r == 0);
    CHECK(seen[middle].r == 0.5f);
    CHECK(seen[middle + 1].r == 1);
    CHECK(srgb_code(seen[middle].r) == 188);
  }
}

TEST_CASE("16 samples are the mean of 16 pictures taken at their positions") {
  Renderer renderer(device());
  test::RendererScene scene;
  scene.list.environment.background = {0.1f, 0.2f, 0.4f};
  // Edges and borders of texels (at 3.3 + 2.35 k pixels across) are away from the samples, which are at odd eighths of
  // a pixel.
  const auto metres = [](double px) { return static_cast<float>((px - kSize_px / 2.0) / kSize_px); };
  Material textured = unlit({1, 0.8f, 0.6f, 1});
  textured.base_color_texture = test::four_texels();
  scene.add(test::rectangle(metres(3.3), metres(2.2), metres(12.7), metres(20.45)), textured, test::at(0, 0, 1));
  scene.add(test::rectangle(metres(8.7), metres(9.3), metres(21.2), metres(15.05)), unlit({0.9f, 0.3f, 0, 1}),
            test::at(0, 0, 0.999));
  const std::vector<glm::vec4> seen = picture(renderer, scene.list, square_plan(), 4, 1);
  std::vector<glm::dvec4> mean(seen.size());
  for (const glm::dvec2& place : sample_places(4, 1)) {
    FramePlan shifted = square_plan();
    test::view_of(shifted).pinhole.cx_px += 0.5 - place.x;
    test::view_of(shifted).pinhole.cy_px += 0.5 - place.y;
    const std::vector<glm::vec4> one = picture(renderer, scene.list, shifted, 1, 1);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += glm::dvec4(one[i]) / 16.0;
  }
  // 15 sums of float32 values up to 16.
  constexpr double kTolerance = 15 * 0x1p-24;
  double worst = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    for (int c = 0; c < 4; ++c) worst = std::max(worst, std::abs(static_cast<double>(seen[i][c]) - mean[i][c]));
  }
  CHECK(worst <= kTolerance);
  CHECK(seen[0].b == 0.4f);
}

TEST_CASE("views of one pass, and strips with guard rows, stay in their rectangles") {
  Renderer renderer(device());
  test::RendererScene scene;
  scene.list.environment.background = glm::vec3(0);
  scene.add(test::rectangle(-0.25, -0.25, 0.25, 0.25), unlit({1, 1, 1, 1}), test::at(0, 0, 1));
  FramePlan plan = test::plan_of(32, 4, 32, true, false);
  plan.passes[0].height_px = 8;
  plan.passes[0].views.push_back(plan.passes[0].views[0]);
  plan.passes[0].views[1].y_px = 4;
  plan.passes[0].views[1].pinhole.cx_px += 8;
  const std::vector<glm::vec4> plain = picture(renderer, scene.list, plan, 1, 1);
  for (const std::uint32_t supersampling : {2u, 4u}) {
    const std::vector<glm::vec4> seen = picture(renderer, scene.list, plan, supersampling, 1);
    CHECK(test::same_bytes(std::span<const glm::vec4>(seen), std::span<const glm::vec4>(plain)));
  }
  CHECK(plain[16].r == 1);
  CHECK(plain[7].r == 0);
  CHECK(plain[4 * 32 + 24].r == 1);
  CHECK(plain[4 * 32 + 15].r == 0);
}

TEST_CASE(
    "depth is never averaged: its bytes are the same for any number of samples, and the plan gives the reason for a "
    "separate pass") {
  constexpr int kWidth = 160, kHeight = 120;
  const Simulation plain = robot_cam(1, 1, "color depth", kWidth, kHeight);
  REQUIRE(plain.diagnostics().frame_plan().passes.size() == 1);
  CHECK(plain.diagnostics().counters().dispatches == 0);
  CHECK(plain.diagnostics().counters().bytes_read_back == kWidth * kHeight * (16 + 4));
  struct Variant {
    int supersampling, msaa;
  };
  for (const auto& [supersampling, msaa] : {Variant{4, 1}, Variant{16, 1}, Variant{1, 4}, Variant{4, 4}}) {
    const Simulation several = robot_cam(supersampling, msaa, "color depth", kWidth, kHeight);
    CHECK(several.depth("ROBOT_CAM").pixels == plain.depth("ROBOT_CAM").pixels);
    CHECK(several.color("ROBOT_CAM").pixels != plain.color("ROBOT_CAM").pixels);
    REQUIRE(several.diagnostics().frame_plan().passes.size() == 2);
    CHECK(several.diagnostics().counters().passes == 2);
    CHECK(several.diagnostics().counters().dispatches == 1);
    CHECK(several.diagnostics().counters().bytes_read_back == plain.diagnostics().counters().bytes_read_back);
    const std::string text = explain(several.diagnostics().frame_plan(), {several.diagnostics().counters()});
    CHECK(contains(text, "the mean of " + std::to_string(supersampling * msaa) + " samples a pixel"));
    CHECK(contains(text, "depth of camera ROBOT_CAM, apart"));
    const Simulation colour = robot_cam(supersampling, msaa, "color", kWidth, kHeight);
    CHECK(colour.diagnostics().counters().passes == 1);
    CHECK(colour.color("ROBOT_CAM").pixels == several.color("ROBOT_CAM").pixels);
    const Simulation depth = robot_cam(supersampling, msaa, "depth", kWidth, kHeight);
    CHECK(depth.diagnostics().counters().dispatches == 0);
    CHECK(depth.depth("ROBOT_CAM").pixels == plain.depth("ROBOT_CAM").pixels);
  }
}

TEST_CASE("a stereo camera averages colour, but not depth and disparity") {
  Renderer renderer(device());
  DrawList list = random_room(7, 30, 16);
  Material both_sides;
  both_sides.double_sided = true;
  list.materials[0] = std::make_shared<Material>(both_sides);
  glm::dmat4 pose(1.0);
  pose[3].z = 1.2;
  for (const std::uint32_t width : {96u, 1100u}) {  // 2 x 2 x 1100 is too wide for both views in one pass
    StereoCameraDesc desc{.pinhole = {.width_px = width, .height_px = 64}, .depth = true};
    StereoCamera plain("EYES", desc);
    desc.sampling.supersampling = 2;
    StereoCamera several("EYES", desc);
    for (StereoCamera* const camera : {&plain, &several}) {
      FramePlan plan;
      camera->plan(pose, list, plan);
      CHECK(plan.passes.size() == (camera == &plain ? 1u : width == 96 ? 2u : 3u));
      camera->collect({}, plan, renderer.render(list, plan));
    }
    for (const char* same : {"left_depth", "right_depth", "disparity"}) {
      CHECK(image_of(plain, same).pixels == image_of(several, same).pixels);
    }
    for (const char* finer : {"left", "right"}) {
      CHECK(image_of(plain, finer).pixels.size() == image_of(several, finer).pixels.size());
      CHECK(image_of(plain, finer).pixels != image_of(several, finer).pixels);
    }
  }
}

TEST_CASE("the error against 256 samples falls from 1 to 4 to 16 samples") {
  constexpr int kWidth = 80, kHeight = 60, kFiner = 4;
  const Simulation fine = robot_cam(16, 1, "color", kFiner * kWidth, kFiner * kHeight);
  const Image& samples = fine.color("ROBOT_CAM");
  const auto rms = [&](int supersampling, int msaa) {
    const Simulation simulation = robot_cam(supersampling, msaa, "color", kWidth, kHeight);
    const Image& image = simulation.color("ROBOT_CAM");
    double sum = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const std::size_t x = i / 4 % kWidth, y = i / 4 / kWidth;
      double mean = 0;
      for (std::size_t k = 0; k < kFiner * kFiner; ++k) {
        mean += samples.pixels[((y * kFiner + k / kFiner) * samples.width + x * kFiner + k % kFiner) * 4 + i % 4] /
                (kFiner * kFiner);
      }
      sum += (image.pixels[i] - mean) * (image.pixels[i] - mean);
    }
    return std::sqrt(sum / static_cast<double>(image.pixels.size()));
  };
  const double one = rms(1, 1), four = rms(4, 1), sixteen = rms(16, 1), edges = rms(1, 4);
  MESSAGE("RMS error, linear: 1 sample " << one << ", 4 " << four << ", 16 " << sixteen << ", msaa 4 " << edges);
  CHECK(four < one);
  CHECK(sixteen < four);
  CHECK(edges < one);
}

TEST_CASE(
    "a setting that the device lacks is an error when the scene is loaded, with its place and the allowed values") {
  const TargetLimits& limits = device().target_limits();
  const auto scene = [](const std::string& attributes) {
    return "<scene>\n <sensor type=\"camera\" name=\"C\" insert_at=\"ROOT\" " + attributes + "/>\n</scene>";
  };
  const auto load = [](const std::string& xml) { return Simulation::from_string(xml, {}, ".", "s.xml"); };
  for (const std::uint32_t msaa : {2u, 4u, 8u}) {
    const std::string xml = scene("msaa=\"" + std::to_string(msaa) + "\"");
    if (std::ranges::find(limits.msaa, msaa) != limits.msaa.end()) {
      load(xml).step();
      continue;
    }
    const std::string message = error_of([&] { load(xml); });
    CHECK(contains(message, "s.xml:2:50: error: attribute \"msaa\""));
    CHECK(contains(message, "expected one of 1"));
    CHECK(contains(message, std::to_string(limits.msaa.back())));
    load(scene("outputs=\"depth\" msaa=\"" + std::to_string(msaa) + "\"")).step();  // of colour alone

    Simulation running = load("<scene/>");
    CHECK(contains(error_of([&] { running.execute(xml); }), "\"msaa\""));
    CHECK(running.sensors().empty());
  }
  const std::uint32_t widest = limits.width_px / 4;
  REQUIRE(widest < 16384);
  const std::string message =
      error_of([&] { load(scene("width=\"" + std::to_string(widest + 1) + "\" height=\"1\" supersampling=\"16\"")); });
  CHECK(contains(message, "error: attribute \"supersampling\": with 16"));
  CHECK(contains(message, std::to_string(widest) + " x "));
  load(scene("width=\"" + std::to_string(widest) + "\" height=\"1\" supersampling=\"16\"")).step();
  CHECK(contains(error_of([&] { load(scene("supersampling=\"9\"")); }), "1, 4"));
  for (const char* type : {"camera", "stereo_camera"}) {
    CHECK(contains(error_of([&] {
                     load(std::string("<sensor type=\"") + type +
                          "\" name=\"S\" insert_at=\"ROOT\" width=\"16384\" supersampling=\"16\"/>");
                   }),
                   "supersampling"));
  }
}

TEST_SUITE_END();
