#include "sensors/laser_scanner/scan_calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <memory>
#include <numbers>

#include <simvis/pose.h>
#include <simvis/scan.h>
#include "engine/base/now_ns.h"
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/method_survey.h"
#include "sensors/laser_scanner/rendered_scan.h"

namespace simvis {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kRepetitions = 5;

// A sphere of radius 1 about the origin; with 4 columns and 2 rows it is an octahedron.
std::shared_ptr<const Mesh> make_ball(std::uint32_t columns, std::uint32_t rows) {
  auto mesh = std::make_shared<Mesh>();
  for (std::uint32_t row = 0; row <= rows; ++row) {
    const double down = kPi * row / rows;
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double around = 2 * kPi * column / columns;
      mesh->positions.emplace_back(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around),
                                   std::cos(down));
    }
  }
  const auto vertex = [&](std::uint32_t row, std::uint32_t column) { return row * columns + column % columns; };
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t a = vertex(row, column), b = vertex(row, column + 1);
      const std::uint32_t c = vertex(row + 1, column), d = vertex(row + 1, column + 1);
      mesh->indices.insert(mesh->indices.end(), {a, c, b, b, c, d});
    }
  }
  mesh->attributes.resize(mesh->positions.size());
  for (std::size_t i = 0; i < mesh->positions.size(); ++i) mesh->attributes[i].uv[0] = glm::vec2(mesh->positions[i]);
  compute_bounds(*mesh);
  return mesh;
}

void add_ball(DrawList& list, std::uint32_t mesh, double radius_m, const glm::dvec3& place) {
  list.items.push_back({mesh, 0, static_cast<std::uint32_t>(list.world_from_node.size())});
  list.world_from_node.push_back(glm::scale(glm::translate(glm::dmat4(1.0), place), glm::dvec3(radius_m)));
}

// Nested balls around the sensor as walls, and other balls inside them, distributed by the golden angle as the seeds of
// a sunflower.
DrawList make_room(int walls, std::uint32_t wall_columns, std::uint32_t objects, std::uint32_t object_columns) {
  const double golden_rad = kPi * (3 - std::sqrt(5.0));
  DrawList list;
  list.world_from_node.emplace_back(1.0);
  list.materials.push_back(std::make_shared<Material>());
  list.material_revision.push_back(0);
  list.meshes = {make_ball(wall_columns, wall_columns / 2), make_ball(object_columns, object_columns / 2)};
  for (int i = 0; i < walls; ++i) add_ball(list, 0, 10 + i, {0, 0, 0});
  for (std::uint32_t i = 0; i < objects; ++i) {
    const double away_m = 2 + 7 * std::sqrt((i + 0.5) / objects);
    const glm::dvec3 place(away_m * std::cos(i * golden_rad), away_m * std::sin(i * golden_rad), std::sin(3.0 * i));
    add_ball(list, 1, 0.3, place);
  }
  return list;
}

// Makes materials masked like leaves: every other texel is opaque.
void make_masked(DrawList& list) {
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = 64;
  for (std::uint32_t i = 0; i < texture->width * texture->height; ++i) {
    const std::uint8_t alpha = (i + i / texture->width) % 2 == 0 ? 255 : 0;
    texture->rgba.insert(texture->rgba.end(), {255, 255, 255, alpha});
  }
  auto material = std::make_shared<Material>();
  material->alpha_mode = AlphaMode::mask;
  material->base_color_texture = texture;
  list.materials.front() = material;
}

ScanPattern rings(std::uint32_t beams, std::uint32_t count, double half_width_rad) {
  const double half_height_rad = count > 1 ? kPi / 12 : 0;
  return {.beams = beams,
          .rings = count,
          .min_azimuth_rad = -half_width_rad,
          .max_azimuth_rad = half_width_rad,
          .min_elevation_rad = -half_height_rad,
          .max_elevation_rad = half_height_rad};
}

class CostCalibration {
 public:
  CostCalibration(Device& device, RayCaster& rays) : renderer_(device), rays_(rays) {}

  void render(const DrawList& list, const ScanPattern& pattern, double resolution_px);
  void cast(DrawList& list, const ScanPattern& pattern);
  CostModel costs() const { return fit_costs(measurements_); }

 private:
  Renderer renderer_;
  RayCaster& rays_;
  std::vector<TimedWork> measurements_;
};

void CostCalibration::render(const DrawList& list, const ScanPattern& pattern, double resolution_px) {
  RenderedScan scan(pattern, resolution_px);
  const std::size_t beams = scan.layout().taps.size();
  TimedWork drawing{.time_ns = std::numeric_limits<double>::infinity()}, taking = drawing;
  double sum_m = 0;
  for (int i = 0; i <= kRepetitions; ++i) {
    FramePlan plan;
    const std::int64_t start_ns = now_ns();
    const VertexRounding rounding(list, glm::dmat4(1.0));
    scan.plan("calibration", "", glm::dmat4(1.0), plan, "calibration");
    const std::span<const PassResult> results = renderer_.render(list, plan);
    const std::int64_t rendered_ns = now_ns();
    scan.collect(plan, results, rounding);
    for (std::size_t beam = 0; beam < beams; ++beam) sum_m += scan.planar(beam).error_bound_m;
    if (i == 0) continue;  // the first frame uploads data and creates pipelines
    drawing.time_ns = std::min(drawing.time_ns, static_cast<double>(rendered_ns - start_ns));
    taking.time_ns = std::min(taking.time_ns, static_cast<double>(now_ns() - rendered_ns));
  }
  drawing.work = scan.work(list.items.size());
  std::swap(drawing.work[CostTerm::beam], taking.work[CostTerm::beam]);
  measurements_.insert(measurements_.end(), {drawing, taking});
  static_cast<void>(sum_m);
}

// An object moves between any two casts, as in a typical simulated scene.
void CostCalibration::cast(DrawList& list, const ScanPattern& pattern) {
  std::vector<glm::dvec3> directions;
  for (const double e : elevations(pattern)) {
    for (const double a : azimuths(pattern)) {
      directions.push_back(beam_direction(a, e));
    }
  }
  std::vector<RayHit> hits(directions.size());
  const auto last = static_cast<std::uint32_t>(list.world_from_node.size() - 1);
  TimedWork casting{.time_ns = std::numeric_limits<double>::infinity()};
  RayCounters before, after;
  for (int i = 0; i <= kRepetitions; ++i) {
    list.world_from_node.back()[3].z += 1e-3;
    list.changes.mark_transforms_dirty({last, last + 1});
    before = rays_.counters();
    const std::int64_t start_ns = now_ns();
    rays_.set_world(list);
    rays_.cast(glm::dmat4(1.0), directions, hits);
    if (i > 0) casting.time_ns = std::min(casting.time_ns, static_cast<double>(now_ns() - start_ns));
    after = rays_.counters();
  }
  add_cast(casting.work, list.items.size());
  add_rays(casting.work, before, after);
  measurements_.push_back(casting);
}

}  // namespace

CostModel fit_costs(std::span<const TimedWork> measurements) {
  // The normal equations of sum over measurements of (work . cost / time - 1)^2.
  double matrix[kCostTerms][kCostTerms] = {}, right[kCostTerms] = {};
  for (const TimedWork& each : measurements) {
    for (std::size_t i = 0; i < kCostTerms; ++i) {
      right[i] += each.work.of[i] / each.time_ns;
      for (std::size_t j = 0; j < kCostTerms; ++j) {
        matrix[i][j] += each.work.of[i] * each.work.of[j] / (each.time_ns * each.time_ns);
      }
    }
  }
  constexpr int kSweeps = 20000;  // far more than convergence needs
  CostModel cost;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < kCostTerms; ++i) {
      if (matrix[i][i] == 0) continue;
      double rest = right[i];
      for (std::size_t j = 0; j < kCostTerms; ++j) rest -= i == j ? 0 : matrix[i][j] * cost.of[j];
      cost.of[i] = std::max(0.0, rest / matrix[i][i]);
    }
  }
  return cost;
}

CostModel measure_scan_costs(Device& device, RayCaster& rays) {
  const ScanPattern half = rings(361, 1, kPi / 2), full = rings(1001, 1, kPi), few = rings(25, 1, kPi / 2);
  const ScanPattern lidar = rings(128, 16, kPi);
  DrawList bare = make_room(1, 8, 0, 4), fine = make_room(1, 64, 0, 4), nested = make_room(12, 4, 0, 4);
  DrawList boxes = make_room(1, 8, 400, 4), balls = make_room(1, 16, 60, 24);
  DrawList leaves = make_room(1, 8, 400, 12);
  make_masked(leaves);
  // The lists keep a change log, as the lists of scenes do.
  for (DrawList* const list : {&bare, &fine, &nested, &boxes, &balls, &leaves}) list->changes.mark_structure_dirty();
  CostCalibration calibration(device, rays);
  calibration.render(bare, half, 512);
  calibration.render(bare, half, 8000);
  calibration.render(bare, full, 1024);
  calibration.render(bare, lidar, 256);
  calibration.render(fine, half, 1024);
  calibration.render(fine, lidar, 128);
  calibration.render(boxes, half, 512);
  calibration.render(boxes, full, 4096);
  calibration.render(leaves, half, 1024);
  calibration.render(leaves, half, 4096);
  calibration.render(balls, half, 2048);
  calibration.render(balls, full, 512);
  for (DrawList* const list : {&bare, &fine, &nested, &boxes, &balls}) {
    for (const ScanPattern& pattern : {few, half, full}) calibration.cast(*list, pattern);
  }
  return calibration.costs();
}

}  // namespace simvis
