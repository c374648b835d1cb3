#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include <simvis/error.h>
#include "shaders/interop.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
using namespace simvis::test;

namespace {

// Depth deviates from near / z by a few float32 operations: rounding of the rows and of their product with the vertex,
// the division, and the interpolation across the triangle (three products and sums). Each is at most half a unit in the
// last place of the largest depth on the triangle. 16 of 2^-24 leave room for the driver's order of operations.
constexpr double kDepthRounding = 16.0 / (1 << 24);  // relative to the largest depth on the surface

Mesh cube() {
  Mesh mesh;
  mesh.name = "cube";
  for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
  mesh.attributes.resize(8);
  mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 4, 6, 0, 6, 2,
                  1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3};
  compute_bounds(mesh);
  return mesh;
}

void add_random_cubes(RendererScene& scene, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-20, 20), angle(-3, 3), size(0.1, 1.5);
  const std::uint32_t mesh = scene.add_mesh(cube());
  Material material;
  material.double_sided = true;
  const std::uint32_t m = scene.add_material(material);
  for (int i = 0; i < count; ++i) {
    glm::dmat4 t = at(place(random), place(random), place(random));
    t = glm::rotate(t, angle(random), glm::normalize(glm::dvec3(place(random), place(random), 1)));
    scene.add(mesh, m, glm::scale(t, glm::dvec3(size(random), size(random), size(random))));
  }
}

}  // namespace

TEST_CASE("a wall at a known distance has depth near / z at every pixel") {
  Renderer renderer(device());
  RendererScene scene;
  scene.add(rectangle(-10, -10, 10, 10), {}, at(0, 0, 4));
  const FramePlan plan = plan_of(64, 48, 32, false, true);
  const auto results = renderer.render(scene.list, plan);
  REQUIRE(results.size() == 1);
  REQUIRE(results[0].depth.size() == 64 * 48);
  CHECK(results[0].color.empty());
  const double expected = 0.05 / 4;
  double worst = 0;
  for (const float d : results[0].depth) worst = std::max(worst, std::abs(d - expected));
  CHECK(worst <= kDepthRounding * expected);
  CHECK(renderer.counters().passes == 1);
  CHECK(renderer.counters().views == 1);
  CHECK(renderer.counters().draws == 1);
  CHECK(renderer.counters().triangles == 2);
  CHECK(renderer.counters().bytes_read_back == 64 * 48 * 4);
}

TEST_CASE("depth is affine in the pixel on a slanted wall") {
  Renderer renderer(device());
  RendererScene scene;
  const double slant = 1.0;
  const glm::dmat4 turned = glm::rotate(at(0, 0, 5), slant, glm::dvec3(0, 1, 0));
  scene.add(rectangle(-100, -100, 100, 100), {}, turned);
  FramePlan plan = plan_of(64, 64, 64, false, true);
  view_of(plan).sees_back_faces = true;
  const PassResult result = renderer.render(scene.list, plan)[0];
  const auto depth = result.depth;
  // The wall contains the points with n . p = n . q.
  const glm::dvec3 n = glm::dvec3(turned[2]), q(0, 0, 5);
  // Corners are 140 m away, and their coordinates have the rounding of about four operations. That moves the wall
  // towards the eye, which is only n . q away from its plane; depth is one over that distance.
  const double vertex_rounding = 4 * 140.0 / (1 << 24) / std::abs(glm::dot(n, q));
  // Where a device takes the depth from corners that it has snapped to its grid, each may stand that far from its
  // place.
  const double per_px = 0.05 * (std::abs(n.x) + std::abs(n.y)) / 64 / std::abs(glm::dot(n, q));
  const double snapping = result.depth_snap_px * per_px;
  double worst = 0, largest = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 ray((x + 0.5 - 32) / 64, (y + 0.5 - 32) / 64, 1);
      const double expected = 0.05 * glm::dot(n, ray) / glm::dot(n, q);
      const double tolerance = (vertex_rounding + kDepthRounding) * expected + snapping;
      largest = std::max(largest, expected);
      worst = std::max(worst, std::abs(depth[y * 64 + x] - expected) / tolerance);
    }
  }
  CHECK(largest > 0.01);
  CHECK(worst <= 1);
}

TEST_CASE("background is 0, nearer is greater, and the nearer surface wins in any order") {
  Renderer renderer(device());
  for (const bool near_first : {false, true}) {
    RendererScene scene;
    const double first = near_first ? 2 : 8, second = near_first ? 8 : 2;
    scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, first));
    scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, second));
    const auto depth = renderer.render(scene.list, plan_of(32, 32, 16, false, true))[0].depth;
    CHECK(depth[0] == 0);
    CHECK(depth[16 * 32 + 16] == doctest::Approx(0.05 / 2).epsilon(kDepthRounding));
  }
}

TEST_CASE("an edge is at its place in the pinhole camera") {
  Renderer renderer(device());
  RendererScene scene;
  // Left edge at u = cx + fx * x / z = 20.25 + 40 * (-0.5) / 2 = 10.25, upper edge at v = 11.75 + 50 * 0.1 / 2 = 14.25.
  scene.add(rectangle(-0.5f, 0.1f, 9, 9), {}, at(0, 0, 2));
  FramePlan plan = plan_of(40, 30, 40, false, true);
  view_of(plan).pinhole = {40, 50, 20.25, 11.75};
  const auto check_edges = [&](double u, double v) {
    const PassResult result = renderer.render(scene.list, plan)[0];
    const auto depth = result.depth;
    const double edge_px = 2 * result.snap_px;  // an edge lies between two snapped vertices
    int wrong = 0;
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        const double px = x + 0.5, py = y + 0.5;
        if (std::abs(px - u) < edge_px || std::abs(py - v) < edge_px) continue;
        wrong += (depth[y * 40 + x] > 0) != (px > u && py > v);
      }
    }
    CHECK(wrong == 0);
  };
  check_edges(10.25, 14.25);
  view_of(plan).pinhole.cx_px += 0.3;  // 10.55 lies beyond the centre of pixel 10.
  check_edges(10.55, 14.25);
  view_of(plan).pinhole.cy_px += 0.3;
  check_edges(10.55, 14.55);
}

TEST_CASE("views of one pass stay in their rectangles") {
  Renderer renderer(device());
  RendererScene scene;
  scene.add(rectangle(-100, -100, 100, 100), {}, at(0, 0, 4));
  FramePlan plan = plan_of(64, 8, 16, false, true);
  View& left = view_of(plan);
  left.width_px = 16;
  left.height_px = 3;
  left.x_px = 2;
  left.y_px = 1;
  View right = left;
  right.x_px = 40;
  right.y_px = 4;
  right.view_from_world = at(0, 0, 4);
  plan.passes[0].views.push_back(right);
  const auto depth = renderer.render(scene.list, plan)[0].depth;
  int wrong = 0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 64; ++x) {
      double expected = 0;
      if (x >= 2 && x < 18 && y >= 1 && y < 4) expected = 0.05 / 4;
      if (x >= 40 && x < 56 && y >= 4 && y < 7) expected = 0.05 / 8;
      wrong += std::abs(depth[y * 64 + x] - expected) > kDepthRounding * expected;
    }
  }
  CHECK(wrong == 0);
  CHECK(renderer.counters().views == 2);
  CHECK(renderer.counters().passes == 1);
}

TEST_CASE("items that share a mesh are one draw, and each has its own place") {
  Renderer renderer(device());
  RendererScene scene;
  const std::uint32_t mesh = scene.add_mesh(rectangle(-0.4f, -0.4f, 0.4f, 0.4f));
  const std::uint32_t material = scene.add_material({});
  for (int i = 0; i < 8; ++i) scene.add(mesh, material, at(i - 3.5, 0, 4 + i));
  FramePlan plan = plan_of(512, 64, 256, false, true);
  const auto depth = renderer.render(scene.list, plan)[0].depth;
  CHECK(renderer.counters().draws == 1);
  CHECK(renderer.counters().triangles == 16);
  for (int i = 0; i < 8; ++i) {
    const int x = static_cast<int>(256 + 256 * (i - 3.5) / (4 + i));
    CHECK(depth[32 * 512 + x] == doctest::Approx(0.05 / (4 + i)).epsilon(kDepthRounding));
  }
}

TEST_CASE("back faces are culled unless the view or the material needs them, also with mirrored transforms") {
  Renderer renderer(device());
  for (const bool mirrored : {false, true}) {
    for (const bool turned : {false, true}) {
      for (const bool double_sided : {false, true}) {
        for (const bool sees_back : {false, true}) {
          CAPTURE(mirrored);
          CAPTURE(turned);
          CAPTURE(double_sided);
          CAPTURE(sees_back);
          glm::dmat4 m = at(0, 0, 3);
          if (turned) m = glm::rotate(m, std::acos(-1.0), glm::dvec3(0, 1, 0));
          if (mirrored) m = glm::scale(m, glm::dvec3(-1, 1, 1));
          Material material;
          material.double_sided = double_sided;
          RendererScene scene;
          scene.add(rectangle(-1, -1, 1, 1), material, m);
          FramePlan plan = plan_of(16, 16, 16, false, true);
          view_of(plan).sees_back_faces = sees_back;
          const float d = renderer.render(scene.list, plan)[0].depth[8 * 16 + 8];
          CHECK((d > 0) == (!turned || double_sided || sees_back));
        }
      }
    }
  }
}

TEST_CASE("culling saves draws and changes no byte") {
  Renderer renderer(device());
  RendererScene scene;
  add_random_cubes(scene, 400);
  FramePlan plan = plan_of(128, 4, 64, false, true);
  const std::vector<float> culled = copy(renderer.render(scene.list, plan)[0].depth);
  const FrameCounters with = renderer.counters();
  CHECK(with.items_culled > 300);
  CHECK(std::count_if(culled.begin(), culled.end(), [](float d) { return d > 0; }) > 100);

  // The same triangles with bounds that reach all around, so that nothing is culled.
  Mesh wide = cube();
  wide.bounds_min = glm::vec3(-1000);
  wide.bounds_max = glm::vec3(1000);
  scene.list.meshes[0] = std::make_shared<const Mesh>(wide);
  const auto all = renderer.render(scene.list, plan)[0].depth;
  CHECK(renderer.counters().items_culled == 0);
  CHECK(same_bytes<float>(culled, all));
}

TEST_CASE("a rectangle of a wider image equals the view of that rectangle") {
  // The sides of the strip clip the scene at other places than the wide view's, so this holds up to the rounding of
  // clipping.
  Renderer renderer(device());
  RendererScene scene;
  add_random_cubes(scene, 400);
  const std::vector<float> wide = copy(renderer.render(scene.list, plan_of(128, 128, 64, false, true))[0].depth);
  FramePlan strip = plan_of(128, 1, 64, false, true);
  view_of(strip).pinhole.cy_px = 64 - 70;  // row 70 of the wide view
  const auto row = renderer.render(scene.list, strip)[0].depth;
  int hits = 0, differ = 0;
  for (int x = 0; x < 128; ++x) {
    hits += row[x] > 0;
    // An edge that snaps differently may flip a pixel. All other differences are rounding of depth.
    differ += std::abs(row[x] - wide[70 * 128 + x]) > 2 * kDepthRounding;
  }
  CHECK(hits > 60);
  CHECK(differ <= 2);
}

TEST_CASE("an offset that cancels exactly changes no byte") {
  Renderer renderer(device());
  const double far = 1e7;
  RendererScene here, there;
  for (int i = 0; i < 20; ++i) {
    const glm::dmat4 m = at(i * 0.25 - 2.5, (i % 5) * 0.5 - 1, 3 + i * 0.125);
    here.add(rectangle(-0.2f, -0.3f, 0.2f, 0.3f), {}, m);
    there.add(rectangle(-0.2f, -0.3f, 0.2f, 0.3f), {}, at(far, -far, far) * m);
  }
  FramePlan plan = plan_of(128, 64, 64, false, true);
  const std::vector<float> near_depth = copy(renderer.render(here.list, plan)[0].depth);
  CHECK(std::count_if(near_depth.begin(), near_depth.end(), [](float d) { return d > 0; }) > 100);
  view_of(plan).view_from_world = at(-far, far, -far);
  CHECK(same_bytes<float>(near_depth, renderer.render(there.list, plan)[0].depth));
}

TEST_CASE("parts in front of the near plane are clipped") {
  Renderer renderer(device());
  RendererScene scene;
  scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, 0.049));
  scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, -2));
  const auto depth = renderer.render(scene.list, plan_of(16, 16, 8, false, true))[0].depth;
  CHECK(std::all_of(depth.begin(), depth.end(), [](float d) { return d == 0; }));
  CHECK(renderer.counters().items_culled == 2);
}

TEST_CASE("lines and points are drawn only for views that see them") {
  Renderer renderer(device());
  Mesh line;
  line.name = "line";
  line.topology = Topology::lines;
  line.positions = {{-1, 0.01f, 0}, {1, 0.01f, 0}};
  line.attributes.resize(2);
  line.indices = {0, 1};
  compute_bounds(line);
  Mesh point = line;
  point.name = "point";
  point.topology = Topology::points;
  point.positions = {{0.03f, 1.03f, 0}};
  point.attributes.resize(1);
  point.indices = {0};
  compute_bounds(point);
  RendererScene scene;
  scene.add(line, {}, at(0, 0, 2));
  scene.add(point, {}, at(0, 0, 2));
  FramePlan plan = plan_of(32, 32, 16, false, true);
  std::vector<float> depth = copy(renderer.render(scene.list, plan)[0].depth);
  CHECK(depth[16 * 32 + 16] == doctest::Approx(0.05 / 2).epsilon(kDepthRounding));
  CHECK(depth[24 * 32 + 16] == doctest::Approx(0.05 / 2).epsilon(kDepthRounding));
  CHECK(renderer.counters().draws == 2);
  CHECK(renderer.counters().triangles == 0);
  view_of(plan).sees_lines_and_points = false;
  depth = copy(renderer.render(scene.list, plan)[0].depth);
  CHECK(std::all_of(depth.begin(), depth.end(), [](float d) { return d == 0; }));
  CHECK(renderer.counters().draws == 0);
}

TEST_CASE("an empty plan submits nothing, an empty list clears") {
  Renderer renderer(device());
  RendererScene scene;
  scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, 2));
  CHECK(renderer.render(scene.list, {}).empty());
  CHECK(renderer.counters() == FrameCounters{});
  const auto depth = renderer.render(DrawList{}, plan_of(16, 16, 8, false, true))[0].depth;
  CHECK(std::all_of(depth.begin(), depth.end(), [](float d) { return d == 0; }));
}

TEST_CASE("a pass that is too large is the user's error, and the renderer still works") {
  Renderer renderer(device());
  RendererScene scene;
  scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, 2));
  FramePlan plan = plan_of(1u << 20, 16, 8, false, true);
  plan.passes[0].name = "HUGE";
  try {
    renderer.render(scene.list, plan);
    FAIL("no exception");
  } catch (const InputError& error) {
    const std::string what = error.what();
    CHECK(what.find("HUGE") != std::string::npos);
    CHECK(what.find("1048576 x 16") != std::string::npos);
    CHECK(what.find("expected at most") != std::string::npos);
  }
  CHECK(renderer.render(scene.list, plan_of(16, 16, 8, false, true))[0].depth[8 * 16 + 8] > 0);
}

TEST_CASE("meshes are added and removed, and the others are neither uploaded again nor lost") {
  Renderer renderer(device());
  const FramePlan plan = plan_of(16, 16, 8, false, true);
  const auto grid = [](float z_scale) {
    Mesh mesh = rectangle(-1, -1, 1, 1);
    // Enough vertices to make the buffers grow several times.
    for (int i = 0; i < 3000; ++i) mesh.positions.push_back({0, 0, z_scale * static_cast<float>(i)});
    mesh.attributes.resize(mesh.positions.size());
    return mesh;
  };
  RendererScene scene;
  scene.add(grid(0), {}, at(0, 0, 9));
  for (int i = 8; i >= 2; --i) {
    scene.add(grid(1), {}, at(0, 0, i));
    const float d = renderer.render(scene.list, plan)[0].depth[8 * 16 + 8];
    CHECK(d == doctest::Approx(0.05 / i).epsilon(kDepthRounding));
    CHECK(renderer.counters().bytes_uploaded < 2 * 3004 * sizeof(glm::vec3) + 2000);
  }
  scene.list.items.resize(1);
  scene.list.meshes.resize(1);
  CHECK(renderer.render(scene.list, plan)[0].depth[8 * 16 + 8] == doctest::Approx(0.05 / 9).epsilon(kDepthRounding));
  CHECK(renderer.counters().bytes_uploaded == sizeof(shader::Instance));
}

TEST_SUITE_END();
