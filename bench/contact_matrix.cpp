// Measures contacts of all pairs of shapes against closed formulas.
//
//   contact_matrix [drop|rest|slope|energy|stack|all] [STEP_MS]
//
// Prints one line for each body and floor, as rigid bodies and as free bases of robots. docs/dynamics.md has the table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/world.h"

namespace {

using namespace simvis;
constexpr double kGravity_m_s2 = 9.80665;

CollisionShape box_shape(const glm::dvec3& half) { return {.kind = CollisionKind::box, .half_m = half}; }

CollisionShape hull_shape(const glm::dvec3& half, const glm::dvec3& at = glm::dvec3(0)) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 8; ++i) points.push_back(at + half * glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  return dynamics_engine().convex_hull(points).value();
}

CollisionShape prism_shape(int sides, double radius, double half) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 2 * sides; ++i) {
    const double angle = 2 * std::numbers::pi * (i / 2) / sides;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), i % 2 ? half : -half);
  }
  return dynamics_engine().convex_hull(points).value();
}

CollisionShape mesh_floor(int cells, double half, double bump = 0) {
  CollisionShape mesh{.kind = CollisionKind::mesh};
  const auto n = static_cast<std::uint32_t>(cells);
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = -half + 2 * half * i / n, y = -half + 2 * half * j / n;
      mesh.points.emplace_back(x, y, bump * std::sin(3 * x) * std::cos(2 * y));
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.insert(mesh.triangles.end(), {a, b, d, a, d, c});
    }
  }
  return mesh;
}

CollisionShape moved(CollisionShape shape, const glm::dvec3& by) {
  shape.body_from_shape = glm::translate(glm::dmat4(1), by);
  return shape;
}

struct Body {
  std::string name;
  std::vector<CollisionShape> shapes;
  double height_m;   // of the centre over the floor
  double rolls = 0;  // moment of inertia about the rolling axis over m r^2; 0: it slides
  glm::dvec3 inertia_of_box{0.2, 0.2, 0.2};
};

struct Floor {
  std::string name;
  std::vector<CollisionShape> shapes;
};

std::vector<Body> bodies() {
  CollisionShape lying{.kind = CollisionKind::cylinder, .half_m = {0.1, 0.1, 0.1}};
  lying.body_from_shape = glm::rotate(glm::dmat4(1), std::numbers::pi / 2, glm::dvec3(1, 0, 0));
  CollisionShape capsule{.kind = CollisionKind::capsule, .half_m = {0.05, 0.05, 0.08}};
  capsule.body_from_shape = glm::rotate(glm::dmat4(1), std::numbers::pi / 2, glm::dvec3(0, 1, 0));
  return {
      {"box", {box_shape(glm::dvec3(0.1))}, 0.1},
      {"sphere", {{.kind = CollisionKind::sphere, .half_m = glm::dvec3(0.1)}}, 0.1, 0.4},
      {"cylinder", {{.kind = CollisionKind::cylinder, .half_m = {0.1, 0.1, 0.1}}}, 0.1},
      {"lying cyl", {lying}, 0.1, 0.5},
      {"capsule", {capsule}, 0.05},
      {"hull", {hull_shape(glm::dvec3(0.1))}, 0.1},
      {"prism 24", {prism_shape(24, 0.1, 0.1)}, 0.1},
      {"pieces",
       {hull_shape({0.03, 0.1, 0.05}, {-0.07, 0, -0.05}), hull_shape({0.03, 0.1, 0.05}, {0.07, 0, -0.05}),
        hull_shape({0.1, 0.1, 0.05}, {0, 0, 0.05})},
       0.1},
      {"table",
       {moved(box_shape({0.1, 0.1, 0.02}), {0, 0, 0.08}), moved(box_shape({0.02, 0.02, 0.08}), {0.08, 0.08, -0.02}),
        moved(box_shape({0.02, 0.02, 0.08}), {-0.08, 0.08, -0.02}),
        moved(box_shape({0.02, 0.02, 0.08}), {0.08, -0.08, -0.02}),
        moved(box_shape({0.02, 0.02, 0.08}), {-0.08, -0.08, -0.02})},
       0.1},
      {"hull 1 cm", {hull_shape(glm::dvec3(0.005))}, 0.005, 0, {0.01, 0.01, 0.01}},
  };
}

std::vector<Floor> floors() {
  return {
      {"box", {moved(box_shape({20, 20, 0.5}), {0, 0, -0.5})}},
      {"mesh 2", {mesh_floor(1, 20)}},
      {"mesh 5cm", {mesh_floor(160, 4)}},
      {"mesh 1cm", {mesh_floor(100, 0.5)}},
      {"plane", {{.kind = CollisionKind::plane}}},
      {"hull", {hull_shape({20, 20, 0.5}, {0, 0, -0.5})}},
      {"two hulls", {hull_shape({10, 20, 0.5}, {-10, 0, -0.5}), hull_shape({10, 20, 0.5}, {10, 0, -0.5})}},
  };
}

struct Trial {
  std::unique_ptr<DynamicsWorld> world;
  std::size_t id = 0;
  double mass = 0.5;
  glm::dvec3 moments{0};
  glm::dvec3 gravity{0};
  double step_s = 1e-3;

  bool step() { return !world->step(); }
  BodyState state() const { return world->state(id); }
  // Kinetic and potential energy with the speed in the middle between both steps, which free flight keeps.
  double energy() const {
    const BodyState now = state();
    const glm::dvec3 own = glm::transpose(glm::dmat3(now.world_from_body)) * now.angular_velocity_rad_s;
    return mass * glm::dot(now.velocity_m_s, now.velocity_m_s) / 2 + glm::dot(own, moments * own) / 2 -
           mass * glm::dot(gravity, now.center_m) + mass * step_s / 2 * glm::dot(gravity, now.velocity_m_s);
  }
};

struct Setting {
  double step_s = 1e-3, friction = 0.5, restitution = 0, height_m = 0;
  glm::dvec3 gravity{0, 0, -kGravity_m_s2};
  glm::dmat3 turn{1.0};
  glm::dvec3 at{0.013, 0.007, 0}, velocity{0};
  bool is_link = false;
};

Trial start(const Body& body, const Floor& floor, const Setting& setting) {
  Trial trial{.world = dynamics_engine().make_world(
                  {.gravity_m_s2 = setting.gravity, .step_s = setting.step_s, .iterations = 50}),
              .gravity = setting.gravity,
              .step_s = setting.step_s};
  BodyDesc ground{.kind = BodyKind::fixed, .shapes = floor.shapes};
  ground.surface = {.friction = 1, .restitution = 1};
  trial.world->add_body(ground);
  const glm::dvec3 size = body.inertia_of_box, square = size * size;
  trial.moments = trial.mass / 12 * glm::dvec3(square.y + square.z, square.x + square.z, square.x + square.y);
  if (body.rolls > 0) trial.moments = glm::dvec3(body.rolls * trial.mass * body.height_m * body.height_m);
  const MassProperties mass{.mass_kg = trial.mass, .inertia_kg_m2 = glm::dmat3(1.0)};
  MassProperties own = mass;
  for (int i = 0; i < 3; ++i) own.inertia_kg_m2[i][i] = trial.moments[i];
  glm::dmat4 pose(setting.turn);
  pose[3] = glm::dvec4(setting.at + glm::dvec3(0, 0, body.height_m + setting.height_m), 1);
  const SurfaceProperties surface{.friction = setting.friction, .restitution = setting.restitution};
  if (setting.is_link) {
    ArticulationDesc desc{.fixed_base = false, .world_from_base = pose, .mass = own, .shapes = body.shapes};
    desc.surface = surface;
    trial.id = trial.world->add_articulation(desc);
  } else {
    BodyDesc desc{.world_from_body = pose, .mass = own, .shapes = body.shapes, .surface = surface};
    desc.velocity_m_s = setting.velocity;
    trial.id = trial.world->add_body(desc);
  }
  return trial;
}

double tilt_deg(const BodyState& state, const glm::dmat3& from) {
  const glm::dvec3 up = glm::dmat3(state.world_from_body) * glm::transpose(from) * glm::dvec3(0, 0, 1);
  return std::acos(std::min(1.0, up.z)) * 180 / std::numbers::pi;
}

void drop(const Body& body, const Floor& floor, Setting setting) {
  setting.height_m = 1;
  Trial trial = start(body, floor, setting);
  const double fall_s = std::sqrt(2 / kGravity_m_s2);
  double rebound = 0, tilt = 0;
  const int steps = static_cast<int>(2 / setting.step_s);
  for (int i = 0; i < steps && trial.step(); ++i) {
    if (i * setting.step_s < fall_s + 2.5 * setting.step_s) continue;
    rebound = std::max(rebound, trial.state().center_m.z - body.height_m);
    if (body.rolls == 0) tilt = std::max(tilt, tilt_deg(trial.state(), setting.turn));
  }
  const glm::dvec3 at = trial.state().center_m;
  std::printf("  rebound %8.4f mm  tilt %7.4f deg  aside %8.4f mm  sunk %8.4f mm", rebound * 1e3, tilt,
              std::hypot(at.x - setting.at.x, at.y - setting.at.y) * 1e3, (body.height_m - at.z) * 1e3);
}

void rest(const Body& body, const Floor& floor, const Setting& setting) {
  Trial trial = start(body, floor, setting);
  const glm::dvec3 from = trial.state().center_m;
  double moved = 0, tilt = 0;
  const int steps = static_cast<int>(10 / setting.step_s);
  for (int i = 0; i < steps && trial.step(); ++i) {
    moved = std::max(moved, glm::length(trial.state().center_m - from));
    if (body.rolls == 0) tilt = std::max(tilt, tilt_deg(trial.state(), setting.turn));
  }
  std::printf("  moved %9.5f mm  tilt %7.4f deg", moved * 1e3, tilt);
}

void slope(const Body& body, const Floor& floor, Setting setting) {
  const bool rolls = body.rolls > 0;
  const double angle = std::atan(0.5) + 2 * std::numbers::pi / 180;
  setting.friction = rolls ? 1 : 0.5;
  setting.gravity = kGravity_m_s2 * glm::dvec3(std::sin(angle), 0, -std::cos(angle));
  constexpr double kTime_s = 1;
  Trial trial = start(body, floor, setting);
  const glm::dvec3 from = trial.state().center_m;
  const int steps = static_cast<int>(std::lround(kTime_s / setting.step_s));
  double highest = 0;
  for (int i = 0; i < steps && trial.step(); ++i) highest = std::max(highest, trial.state().center_m.z - from.z);
  const double along = rolls ? std::sin(angle) / (1 + body.rolls) : std::sin(angle) - 0.5 * std::cos(angle);
  const double exact = kGravity_m_s2 * along * kTime_s * (kTime_s + setting.step_s) / 2;
  const glm::dvec3 moved = trial.state().center_m - from;
  std::printf("  way %7.4f of exact  aside %8.4f mm  jumped %7.4f mm", moved.x / exact, moved.y * 1e3, highest * 1e3);
}

void energy(const Body& body, const Floor& floor, Setting setting) {
  double worst = 0, apex = 0;
  for (const double restitution : {0.0, 0.5, 1.0}) {
    for (const double friction : {0.0, 0.7}) {
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 2.0}, {30.0, 20.0}, {45.0, 35.264}, {80.0, 10.0}}) {
        const double to_rad = std::numbers::pi / 180;
        setting.turn = glm::dmat3(
            glm::rotate(glm::rotate(glm::dmat4(1), x * to_rad, glm::dvec3(1, 0, 0)), y * to_rad, glm::dvec3(0, 1, 0)));
        setting.height_m = 1;
        setting.restitution = restitution;
        setting.friction = friction;
        Trial trial = start(body, floor, setting);
        const double from = trial.energy();
        const int steps = static_cast<int>(5 / setting.step_s);
        for (int i = 0; i < steps && trial.step(); ++i) {
          worst = std::max(worst, trial.energy() / from);
          if (x == 0 && restitution == 1 && i * setting.step_s > 4) apex = std::max(apex, trial.state().center_m.z);
        }
      }
    }
  }
  std::printf("  energy at most %8.5f of the start  apex after 5 bounces %8.5f of the drop", worst,
              (apex - body.height_m) / 1.0);
}

void stack(const Setting& setting) {
  for (const double ratio : {0.001, 1.0, 10.0, 100.0, 1000.0}) {
    const auto world =
        dynamics_engine().make_world({.gravity_m_s2 = setting.gravity, .step_s = setting.step_s, .iterations = 50});
    BodyDesc ground{.kind = BodyKind::fixed, .shapes = {moved(box_shape({20, 20, 0.5}), {0, 0, -0.5})}};
    world->add_body(ground);
    std::vector<std::size_t> ids;
    double mass = 1;
    for (int i = 0; i < 2; ++i) {
      BodyDesc desc{.shapes = {box_shape(glm::dvec3(0.1))}};
      desc.world_from_body[3] = {0, 0, 0.1 + 0.2 * i, 1};
      desc.mass = {.mass_kg = mass, .inertia_kg_m2 = glm::dmat3(mass * 0.04 / 6)};
      ids.push_back(world->add_body(desc));
      mass *= ratio;
    }
    for (int i = 0; i * setting.step_s < 10; ++i) world->step();
    std::printf("stack 1:%g", ratio);
    for (int i = 0; i < 2; ++i) {
      const glm::dvec3 at = world->state(ids[static_cast<std::size_t>(i)]).center_m;
      std::printf("  box %d moved %8.5f mm", i, glm::length(at - glm::dvec3(0, 0, 0.1 + 0.2 * i)) * 1e3);
    }
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  const double step_s = argc > 2 ? std::atof(argv[2]) * 1e-3 : 1e-3;
  const std::string only_body = argc > 3 ? argv[3] : "", only_floor = argc > 4 ? argv[4] : "";
  for (const bool is_link : {false, true}) {
    for (const Body& body : bodies()) {
      if (!only_body.empty() && body.name != only_body) continue;
      for (const Floor& floor : floors()) {
        if (!only_floor.empty() && floor.name != only_floor) continue;
        const auto run = [&](const char* name, void (*trial)(const Body&, const Floor&, Setting)) {
          if (what != name && what != "all") return;
          std::printf("%-6s %-4s %-9s on %-9s", name, is_link ? "link" : "body", body.name.c_str(), floor.name.c_str());
          trial(body, floor, {.step_s = step_s, .is_link = is_link});
          std::printf("\n");
        };
        run("drop", drop);
        run("rest", [](const Body& b, const Floor& f, Setting s) { rest(b, f, s); });
        run("slope", slope);
        run("energy", energy);
      }
    }
  }
  if (what == "stack" || what == "all") stack({.step_s = step_s});
}
