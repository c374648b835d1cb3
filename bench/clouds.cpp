// Rays into a cloud of spheres, and into the same of discs, and pictures.
//
//   clouds [POINTS [REPETITIONS]]
//
// POINTS: default 10,000,000, on hills of 400 x 400 m, each a sphere or a disc with a radius of 5 cm. Prints CSV, a
// line for each scanner or picture and shape: milliseconds of a scan or a frame (median), the first time, which makes
// the tree or fills the device, and bytes of the tree or of meshes on the device. Scans of both shapes are in turns.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <random>
#include <vector>

#include <simvis/device.h>
#include <simvis/frame_plan.h>
#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <simvis/scan.h>
#include "bench/picture_plan.h"
#include "bench/timing.h"
#include "engine/base/thread_pool.h"
#include "engine/raycast/blas.h"
#include "engine/render/renderer.h"

namespace {

using namespace simvis;
using Clock = std::chrono::steady_clock;

constexpr SurfaceKind kShapes[] = {SurfaceKind::sphere, SurfaceKind::disc};
constexpr const char* kNames[] = {"spheres", "discs"};

DrawList cloud_of(std::size_t points, SurfaceKind shape) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-200, 200), shade(0.2f, 1);
  auto mesh = std::make_shared<Mesh>();
  mesh->topology = Topology::points;
  mesh->surface = ExactSurface{.kind = shape, .radius_m = 0.05};
  for (std::uint32_t i = 0; i < points; ++i) {
    const float x = place(random), y = place(random), a = 0.05f * x, b = 0.04f * y;
    mesh->positions.emplace_back(x, y, 8 * std::sin(a) * std::cos(b));
    const glm::vec3 up(-0.4f * std::cos(a) * std::cos(b), 0.32f * std::sin(a) * std::sin(b), 1);
    mesh->attributes.push_back(
        {.normal = glm::normalize(up), .color = {shade(random), 0.5f + 0.05f * mesh->positions.back().z, 0.3f, 1}});
    mesh->indices.push_back(i);
  }
  compute_bounds(*mesh);
  Material material;
  material.unlit = true;
  DrawList list;
  list.world_from_node = {glm::dmat4(1)};
  list.materials = {std::make_shared<const Material>(material)};
  list.material_revision = {0};
  list.meshes = {std::move(mesh)};
  list.items = {{.mesh = 0, .material = 0, .transform = 0}};
  return list;
}

glm::dmat4 pose_of(int step) { return matrix_from_degrees({0.5 * step, -0.3 * step, 14}, 0, 5, 3.0 * step); }

void time_scans(const std::vector<DrawList>& lists, int beams, int rings, int repetitions) {
  std::vector<glm::dvec3> directions;
  for (int ring = 0; ring < rings; ++ring) {
    const double e = rings == 1 ? -0.1 : -0.4 + 0.5 * ring / (rings - 1);
    for (int beam = 0; beam < beams; ++beam) directions.push_back(beam_direction(6.283 * beam / beams - 3.1415, e));
  }
  struct Shape {
    std::unique_ptr<RayCaster> caster = make_host_ray_caster({}, 0);
    std::vector<RayHit> hits{};
    std::vector<double> times_ms{};
    double first_ms = 0;
  };
  std::vector<Shape> shapes(lists.size());
  for (int r = 0; r <= repetitions; ++r) {
    for (std::size_t i = 0; i < lists.size(); ++i) {
      shapes[i].hits.resize(directions.size());
      const auto start = Clock::now();
      shapes[i].caster->set_world(lists[i]);
      shapes[i].caster->cast(pose_of(r), directions, shapes[i].hits);
      (r == 0 ? shapes[i].first_ms : shapes[i].times_ms.emplace_back()) = bench::since_ms(start);
    }
  }
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const Shape& shape = shapes[i];
    const auto found = std::ranges::count_if(shape.hits, [](const RayHit& hit) { return std::isfinite(hit.range_m); });
    const std::shared_ptr<const Blas> blas = shared_blas(lists[i].meshes[0], {}, shared_thread_pool());
    const std::size_t bytes =
        blas->tree().nodes().size() * sizeof(WideNode) + blas->leaves().size() * sizeof(WideBvh::Leaf);
    std::printf("scan,%s,%dx%d beams,%.1f,%.0f,%zu,%.2f\n", kNames[i], rings, beams, bench::median(shape.times_ms),
                shape.first_ms, bytes, static_cast<double>(found) / static_cast<double>(shape.hits.size()));
  }
}

void time_pictures(const DrawList& list, std::uint32_t width_px, std::uint32_t height_px, int repetitions) {
  Device device;
  Renderer renderer(device);
  std::vector<double> times_ms;
  double first_ms = 0;
  for (int r = 0; r <= repetitions; ++r) {
    FramePlan plan = bench::picture_plan(pose_of(r), 0.7 * width_px, width_px, height_px);
    plan.passes[0].views[0].sees_lines_and_points = true;
    const auto start = Clock::now();
    renderer.render(list, plan);
    (r == 0 ? first_ms : times_ms.emplace_back()) = bench::since_ms(start);
  }
  std::printf("picture,spheres,%ux%u pixels,%.1f,%.0f,%zu,\n", width_px, height_px, bench::median(times_ms), first_ms,
              static_cast<std::size_t>(renderer.counters().mesh_bytes));
}

}  // namespace

int main(int argc, char** argv) {
  const auto points = static_cast<std::size_t>(argc > 1 ? std::atoll(argv[1]) : 10'000'000);
  const int repetitions = argc > 2 ? std::atoi(argv[2]) : 15;
  std::vector<DrawList> lists;
  for (const SurfaceKind shape : kShapes) lists.push_back(cloud_of(points, shape));
  std::printf("what,points,size,ms,first_ms,bytes,share_of_hits\n");
  time_scans(lists, 361, 1, repetitions);
  time_scans(lists, 1024, 64, repetitions);
  time_pictures(lists[0], 640, 480, repetitions);
  return 0;
}
