// Compares round shapes with the meshes of 60 sides that stood for them: 10,000 spheres in a cube, and 100 humanoids of
// 17 capsules and 3 spheres. Each is cast and drawn with the shapes and, in turns, without.
//
//   round_shapes [REPETITIONS]
//
// Prints CSV, a line for each scene, scanner or picture, and kind. Of rays: nanoseconds a ray (median), bytes of the
// trees of the meshes, the largest distance of the range from that of the shape, and how many rays hit another item. Of
// a picture in colour from the middle: milliseconds of processor time of a frame (median), bytes of meshes on the
// device, and triangles drawn. The first time includes trees, or meshes and pipelines.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <simvis/device.h>
#include <simvis/frame_plan.h>
#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <glm/gtc/matrix_transform.hpp>
#include "bench/picture_plan.h"
#include "engine/base/thread_pool.h"
#include "engine/raycast/blas.h"
#include "engine/render/renderer.h"
#include "scenegraph/primitive_meshes.h"

namespace {

using namespace simvis;
using Clock = std::chrono::steady_clock;

constexpr const char* kKinds[] = {"shapes", "60 sides"};

double median_of(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

std::uint32_t add_mesh(DrawList& list, Mesh mesh) {
  list.meshes.push_back(std::make_shared<const Mesh>(std::move(mesh)));
  return static_cast<std::uint32_t>(list.meshes.size() - 1);
}

void add_item(DrawList& list, std::uint32_t mesh, const glm::dmat4& world_from_mesh) {
  list.items.push_back(
      {.mesh = mesh, .material = 0, .transform = static_cast<std::uint32_t>(list.world_from_node.size())});
  list.world_from_node.push_back(world_from_mesh);
}

DrawList empty_list() {
  DrawList list;
  list.world_from_node.emplace_back(1.0);
  list.materials.push_back(std::make_shared<Material>());
  list.material_revision.push_back(0);
  return list;
}

DrawList spheres() {
  DrawList list = empty_list();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::uint32_t> meshes;
  for (int i = 1; i <= 10; ++i) meshes.push_back(add_mesh(list, sphere_mesh(0.02 * i)));
  while (list.items.size() < 10'000) {
    const glm::dvec3 place(20 * unit(random), 20 * unit(random), 20 * unit(random));
    if (glm::length(place) < 0.5) continue;
    add_item(list, meshes[list.items.size() % meshes.size()], glm::translate(glm::dmat4(1), place));
  }
  return list;
}

// Limbs as capsules between joints, and head and hands as spheres; every humanoid turns its own way.
DrawList humanoids() {
  struct Limb {
    glm::dvec3 from, to;
    double radius_m;
  };
  std::vector<Limb> limbs{{{0, -0.07, 0.95}, {0, 0.07, 0.95}, 0.09},
                          {{0, -0.06, 1.1}, {0, 0.06, 1.1}, 0.08},
                          {{0, -0.08, 1.25}, {0, 0.08, 1.25}, 0.09},
                          {{0, 0, 1.4}, {0, 0, 1.46}, 0.05}};
  for (const double side : {-1.0, 1.0}) {
    limbs.insert(limbs.end(), {{{0, side * 0.1, 0.9}, {0, side * 0.1, 0.55}, 0.06},
                               {{0, side * 0.1, 0.5}, {0, side * 0.1, 0.15}, 0.05},
                               {{-0.05, side * 0.1, 0.03}, {0.14, side * 0.12, 0.03}, 0.027},
                               {{-0.05, side * 0.1, 0.03}, {0.14, side * 0.08, 0.03}, 0.027},
                               {{0, side * 0.17, 1.3}, {0.1, side * 0.25, 1.1}, 0.04},
                               {{0.1, side * 0.25, 1.1}, {0.3, side * 0.2, 1.15}, 0.031}});
  }
  limbs.push_back({{0, -0.05, 1.0}, {0, 0.05, 1.0}, 0.085});
  DrawList list = empty_list();
  const std::uint32_t head = add_mesh(list, sphere_mesh(0.09)), hand = add_mesh(list, sphere_mesh(0.04));
  for (const Limb& limb : limbs) add_mesh(list, capsule_mesh(limb.radius_m, glm::distance(limb.from, limb.to)));
  for (int i = 0; i < 100; ++i) {
    const glm::dmat4 body = matrix_from_degrees({2.0 * (i % 10) - 9, 2.0 * (i / 10) - 9, -1.0}, 0, 0, 37.0 * i);
    add_item(list, head, glm::translate(body, {0, 0, 1.6}));
    for (const double side : {-0.2, 0.2}) add_item(list, hand, glm::translate(body, {0.35, side, 1.15}));
    for (std::size_t k = 0; k < limbs.size(); ++k) {
      const glm::dvec3 z = glm::normalize(limbs[k].to - limbs[k].from);
      const glm::dvec3 x =
          glm::normalize(glm::cross(z, std::abs(z.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1)));
      glm::dmat4 place(glm::dmat3(x, glm::cross(z, x), z));
      place[3] = glm::dvec4((limbs[k].from + limbs[k].to) / 2.0, 1);
      add_item(list, hand + 1 + static_cast<std::uint32_t>(k), body * place);
    }
  }
  return list;
}

DrawList without_shapes(DrawList list) {
  for (std::shared_ptr<const Mesh>& mesh : list.meshes) {
    auto plain = std::make_shared<Mesh>(*mesh);
    plain->surface.reset();
    mesh = std::move(plain);
  }
  return list;
}

std::vector<glm::dvec3> directions_of(int beams, int rings) {
  std::vector<glm::dvec3> directions;
  for (int ring = 0; ring < rings; ++ring) {
    const double e = rings == 1 ? 0 : 0.5 * (2.0 * ring / (rings - 1) - 1);
    for (int beam = 0; beam < beams; ++beam) directions.push_back(beam_direction(6.283 * beam / beams - 3.1415, e));
  }
  return directions;
}

// Bytes of the trees that the rays needed.
std::size_t tree_bytes(const DrawList& list) {
  std::size_t bytes = 0;
  for (const std::shared_ptr<const Mesh>& mesh : list.meshes) {
    if (mesh->surface) continue;
    const std::shared_ptr<const Blas> blas = shared_blas(mesh, {}, shared_thread_pool());
    bytes += blas->tree().nodes().size() * sizeof(WideNode) + blas->leaves().size() * sizeof(WideBvh::Leaf);
  }
  return bytes;
}

void time_scene(const char* name, const DrawList& shapes, int beams, int rings, int repetitions) {
  const DrawList sides = without_shapes(shapes);
  const std::vector<glm::dvec3> directions = directions_of(beams, rings);
  const DrawList* const lists[2] = {&shapes, &sides};
  std::vector<RayHit> hits[2];
  std::vector<double> times_ns[2];
  double first_ms[2] = {};
  const std::unique_ptr<RayCaster> casters[2] = {make_host_ray_caster({}, 1), make_host_ray_caster({}, 1)};
  for (int r = 0; r <= repetitions; ++r) {
    for (const int k : {r % 2, 1 - r % 2}) {
      hits[k].resize(directions.size());
      const auto start = Clock::now();
      casters[k]->set_world(*lists[k]);
      casters[k]->cast(glm::dmat4(1), directions, hits[k]);
      const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
      if (r == 0) first_ms[k] = ns / 1e6;
      if (r > 0) times_ns[k].push_back(ns / static_cast<double>(directions.size()));
    }
  }
  double worst_m = 0;
  std::size_t other = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const bool same =
        hits[0][i].item == hits[1][i].item && std::isfinite(hits[0][i].range_m) == std::isfinite(hits[1][i].range_m);
    other += !same;
    if (same && std::isfinite(hits[0][i].range_m))
      worst_m = std::max(worst_m, std::abs(hits[0][i].range_m - hits[1][i].range_m));
  }
  const double sides_ns = median_of(times_ns[1]);
  for (int k = 0; k < 2; ++k) {
    std::printf("%s,%dx%d beams,%s,%.1f ns,%.3f,%.2f,%zu,0,%.2g,%zu\n", name, rings, beams, kKinds[k],
                median_of(times_ns[k]), median_of(times_ns[k]) / sides_ns, first_ms[k], tree_bytes(*lists[k]),
                k == 0 ? 0 : worst_m, k == 0 ? 0 : other);
  }
}

void time_picture(const char* name, const DrawList& shapes, Device& device, std::uint32_t width_px,
                  std::uint32_t height_px, int repetitions) {
  const DrawList sides = without_shapes(shapes);
  const DrawList* const lists[2] = {&shapes, &sides};
  const double focal_px = width_px / 2.0 / std::tan(glm::radians(30.0));
  const FramePlan plan = bench::picture_plan(glm::dmat4(1), focal_px, width_px, height_px);
  Renderer renderers[2] = {Renderer(device), Renderer(device)};
  std::vector<double> times_ms[2];
  double first_ms[2] = {};
  for (int r = 0; r <= repetitions; ++r) {
    for (const int k : {r % 2, 1 - r % 2}) {
      const std::clock_t start = std::clock();
      renderers[k].render(*lists[k], plan);
      const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      r == 0 ? void(first_ms[k] = ms) : times_ms[k].push_back(ms);
    }
  }
  const double sides_ms = median_of(times_ms[1]);
  for (int k = 0; k < 2; ++k) {
    const FrameCounters& counters = renderers[k].counters();
    std::printf("%s,%ux%u pixels,%s,%.2f ms,%.3f,%.1f,%zu,%zu,,\n", name, width_px, height_px, kKinds[k],
                median_of(times_ms[k]), median_of(times_ms[k]) / sides_ms, first_ms[k],
                static_cast<std::size_t>(counters.mesh_bytes), static_cast<std::size_t>(counters.triangles));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::atoi(argv[1]) : 31;
  std::printf("scene,measured,kind,time,ratio,first_ms,bytes,triangles,largest_error_m,other_item\n");
  const DrawList balls = spheres(), people = humanoids();
  for (const auto& [beams, rings] : {std::pair{361, 1}, {1024, 64}}) {
    time_scene("10000 spheres", balls, beams, rings, repetitions);
    time_scene("100 humanoids", people, beams, rings, repetitions);
  }
  Device device;
  for (const auto& [width_px, height_px] : {std::pair{640u, 480u}, {1920u, 1080u}}) {
    time_picture("10000 spheres", balls, device, width_px, height_px, repetitions);
    time_picture("100 humanoids", people, device, width_px, height_px, repetitions);
  }
  return 0;
}
