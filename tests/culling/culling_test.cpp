// Culling changes no byte of the visible output: every scene that comes with SimVis, driven along, and random rooms
// full of objects, with culling and without. See engine/culling/column_occlusion_buffer.h and
// engine/geometry/clusters.h.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "engine/geometry/view_projection.h"
#include "engine/render/frame_draw_lists.h"
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/rendered_scan.h"
#include "tests/support/random_room.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine/culling");

using namespace simvis;

namespace {

struct DrivenScene {
  const char *folder, *file, *trajectory;  ///< null: nothing moves
  std::vector<double> times_s;
};
const DrivenScene kScenes[] = {{"marvin", "marvin.xml", "drive.csv", {0, 3.7}},
                               {"ravon", "ravon.xml", "drive.csv", {3.7}},
                               {"arm", "arm.xml", "reach.csv", {0, 3.7}},
                               {"showcase", "showcase.xml", nullptr, {0}},
                               {"showcase", "surfaces.xml", nullptr, {0}}};
const std::size_t kScenesDriven =
    sanitized() ? 1 : std::size(kScenes);  // pictures are ten times slower under sanitizers

FramePlan without_culling(FramePlan plan) {
  for (Pass& pass : plan.passes) {
    for (View& view : pass.views) view.culled = false;
  }
  return plan;
}

/// A copy of the results of a plan's passes.
struct Picture {
  std::vector<std::vector<float>> depth;
  std::vector<std::vector<glm::vec4>> color;
  FrameCounters counters;
};

Picture draw(Renderer& renderer, const DrawList& list, const FramePlan& plan) {
  Picture picture;
  for (const PassResult& result : renderer.render(list, plan)) {
    picture.depth.emplace_back(result.depth.begin(), result.depth.end());
    picture.color.emplace_back(result.color.begin(), result.color.end());
  }
  picture.counters = renderer.counters();
  return picture;
}

/// Comparison of the pixels that are read.
std::size_t differences(const Pass& pass, const std::vector<float>& a, const std::vector<float>& b) {
  std::size_t count = 0;
  for (const View& view : pass.views) {
    for (std::uint32_t y = view.y_px; y < view.y_px + view.height_px; ++y) {
      for (std::uint32_t x = 0; x < view.width_px; ++x) {
        if (view.columns && !std::ranges::binary_search(*view.columns, x)) continue;
        const std::size_t pixel = std::size_t{y} * pass.width_px + view.x_px + x;
        count += std::memcmp(&a[pixel], &b[pixel], sizeof(float)) != 0;
      }
    }
  }
  return count;
}

/// Compares both and sums how many triangles were drawn.
struct Comparison {
  std::uint64_t culled = 0, whole = 0, pixels_seen = 0;

  void add(Renderer& renderer, const DrawList& list, const FramePlan& plan, const std::string& what) {
    const Picture seen = draw(renderer, list, plan);
    const Picture all = draw(renderer, list, without_culling(plan));
    for (std::size_t i = 0; i < plan.passes.size(); ++i) {
      const Pass& pass = plan.passes[i];
      const std::string where = what + ", pass " + pass.name;
      CAPTURE(where);
      if (pass.depth) CHECK(differences(pass, seen.depth[i], all.depth[i]) == 0);
      CHECK(std::ranges::equal(seen.color[i], all.color[i]));
      pixels_seen += static_cast<std::uint64_t>(std::ranges::count_if(all.depth[i], [](float d) { return d > 0; }));
    }
    culled += seen.counters.triangles;
    whole += all.counters.triangles;
  }
};

/// A horizontal ring over a half circle, as in the scanners of the paper, or over the full circle with few beams.
ScanPattern ring(std::uint32_t samples, double half_width_rad) {
  return {.beams = samples, .rings = 1, .min_azimuth_rad = -half_width_rad, .max_azimuth_rad = half_width_rad};
}

glm::dmat4 random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const glm::dvec3 place(4.5 * unit(random), 3.5 * unit(random), 1.5 + 1.2 * unit(random));
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.2 * unit(random), 0.2 * unit(random), 1));
  return glm::rotate(glm::translate(glm::dmat4(1.0), place), 3 * unit(random), axis);
}

}  // namespace

TEST_CASE("every sensor of every scene gives the same bytes with culling and without") {
  Device device;
  Renderer renderer(device);
  for (const DrivenScene& scene : std::span(kScenes, kScenesDriven)) {
    const std::filesystem::path folder = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes" / scene.folder;
    SimulationDesc desc;
    desc.overrides = {{"laser_scanner", "method", "planar", "this test"}};
    Simulation simulation = Simulation::load(folder / scene.file, desc);
    std::optional<Trajectory> trajectory;
    if (scene.trajectory) trajectory.emplace(folder / scene.trajectory, simulation.parameters());
    Comparison comparison;
    for (const double time_s : scene.times_s) {
      if (trajectory) trajectory->apply(time_s, simulation.parameters());
      simulation.step();
      comparison.add(renderer, simulation.diagnostics().draw_list(), simulation.diagnostics().frame_plan(), scene.file);
    }
    MESSAGE(std::string(scene.file) << ": " << comparison.culled << " of " << comparison.whole << " triangles drawn");
    CHECK(comparison.culled <= comparison.whole);
    if (scene.trajectory) CHECK(comparison.culled < comparison.whole * 2 / 3);  // the others stand before one camera
  }
}

TEST_CASE("strips of rooms full of objects give the same bytes at any resolution and draw few of the triangles") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(11);
  Comparison comparison;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const DrawList room = random_room(seed, 40, seed % 2 ? 12 : 48);
    for (const double resolution_px : {64.0, 512.0, 4096.0}) {
      RenderedScan scan(ring(seed % 3 ? 361 : 40, std::numbers::pi / (seed % 2 ? 1 : 2)), resolution_px);
      FramePlan plan;
      scan.plan("scanner", "", rigid_inverse(random_pose(random)), plan, "scanner");
      comparison.add(renderer, room, plan, "room " + std::to_string(seed));
      // All columns, not only those that beams read.
      for (Pass& pass : plan.passes) {
        for (View& view : pass.views) view.columns = nullptr;
      }
      comparison.add(renderer, room, plan, "room " + std::to_string(seed) + ", all columns");
    }
  }
  CHECK(comparison.pixels_seen > 100000);
  CHECK(comparison.culled < comparison.whole / 20);
}

TEST_CASE("a strip draws surfaces in front of a wall and none behind it, in one draw for all meshes") {
  Device device;
  Renderer renderer(device);
  RenderedScan scan(ring(361, std::numbers::pi / 2), 4096);
  FramePlan plan;
  scan.plan("scanner", "", glm::dmat4(1.0), plan, "scanner");
  const auto triangles = [&](bool wall) {
    DrawList list;
    for (int i = 0; i < 3; ++i) add_item(list, sphere_mesh(0.3, 40), glm::translate(glm::dmat4(1.0), {6.0, i - 1, 0}));
    // One triangle in the view of either face.
    Mesh screen;
    screen.positions = {{3, 0, -2}, {3, -2.9, 2}, {3, 2.9, 2}};
    screen.indices = {0, 1, 2};
    if (wall) {
      for (const double turn : {-0.7, 0.0, 0.7}) {
        add_item(list, screen, glm::rotate(glm::dmat4(1.0), turn, glm::dvec3(0, 0, 1)));
      }
    }
    renderer.render(list, plan);
    CHECK(renderer.counters().draws <= plan.passes[0].views.size());
    return renderer.counters().triangles;
  };
  const std::uint64_t bare = triangles(false), behind = triangles(true);
  MESSAGE(bare << " triangles, with the wall " << behind);
  CHECK(behind < bare / 2);
}

// The first frame of a renderer culls its views one after the other. Later frames use all cores if the previous frame
// was expensive enough.
TEST_CASE("views that are culled in parallel draw the same as those culled one after the other") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(4);
  const DrawList room = random_room(3, 60, 96);
  FramePlan plan;
  for (int i = 0; i < 5; ++i) {
    RenderedScan scan(ring(i % 2 ? 361 : 91, std::numbers::pi / 2), 512);
    scan.plan("scanner " + std::to_string(i), "", rigid_inverse(random_pose(random)), plan, "scanner");
  }
  const Picture first = draw(renderer, room, plan);
  for (int frame = 0; frame < 3; ++frame) {
    const Picture later = draw(renderer, room, plan);
    CHECK(later.depth == first.depth);
    CHECK(later.counters.triangles == first.counters.triangles);
    CHECK(later.counters.draws == first.counters.draws);
  }
  std::uint64_t looks = 0;
  for (const PassResult& result : renderer.render(room, plan)) {
    for (const ViewCounts& counts : result.views) looks += counts.boxes_examined + counts.triangles_examined;
  }
  CHECK(looks >= kWorthThreads);
}

TEST_SUITE_END();
