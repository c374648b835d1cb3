// Measures contacts of all pairs of shapes against closed formulas, as bodies, as bases of robots and as links of them.
//
//   contact_matrix [STEP_MS...]        1 and 4 ms without an argument
//   contact_matrix STEP_MS BODY FLOOR  one pair
//
// Each row is a body on a floor: a drop from 1 m without restitution (rebound, tilt, way aside), a rest of 2 s (the
// largest way), a slope of atan 0.5 + 2 degrees with the friction 0.5, or 1 for what rolls (way as a share of the exact
// one, way aside), and the largest energy of six bounces with restitution and friction, as a share of that at the
// start. Rows of stacks have the largest way of two boxes within 10 s, of which the upper one has RATIO times the mass
// of the lower one.
//
// Prints CSV: carrier, body, floor, step_ms, rebound_mm, tilt_deg, aside_mm, rest_mm, slope_share, slope_aside_mm,
// energy_share. bench/contact_peers.py prints the same of pybullet, and docs/dynamics.md has a table of both.
#include <algorithm>
#include <array>
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

CollisionShape mesh_floor(int cells, double half) {
  CollisionShape mesh{.kind = CollisionKind::mesh};
  const auto n = static_cast<std::uint32_t>(cells);
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = -half + 2 * half * i / n, y = -half + 2 * half * j / n;
      mesh.points.emplace_back(x, y, 0);
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

// A floor with a wall along x, which bodies all but touch: its foot is a concave edge.
CollisionShape corner_floor() {
  constexpr double kWall = 0.1071, kSide = 20;
  CollisionShape corner{.kind = CollisionKind::mesh};
  for (const glm::dvec2& profile : {glm::dvec2(-kSide, 0), glm::dvec2(kWall, 0), glm::dvec2(kWall, kSide)}) {
    corner.points.emplace_back(-kSide, profile);
    corner.points.emplace_back(kSide, profile);
  }
  for (const std::uint32_t i : {0U, 2U}) {
    corner.triangles.insert(corner.triangles.end(), {i, i + 1, i + 3, i, i + 3, i + 2});
  }
  return corner;
}

// Two legs below a beam, as one closed mesh that is divided into convex pieces.
std::vector<CollisionShape> arch() {
  std::vector<glm::dvec3> corners;
  std::vector<std::uint32_t> triangles;
  const std::vector<glm::dvec2> outline = {{-0.1, -0.1}, {-0.04, -0.1}, {-0.04, 0}, {0.04, 0},
                                           {0.04, -0.1}, {0.1, -0.1},   {0.1, 0.1}, {-0.1, 0.1}};
  const auto add = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    for (const glm::dvec3& corner : {a, b, c}) {
      triangles.push_back(static_cast<std::uint32_t>(corners.size()));
      corners.push_back(corner);
    }
  };
  const auto at = [&](std::size_t i, double y) { return glm::dvec3(outline[i].x, y, outline[i].y); };
  for (const auto& [a, b, c] :
       {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 5, 6}, {3, 4, 5}}) {
    add(at(a, -0.1), at(b, -0.1), at(c, -0.1));
    add(at(a, 0.1), at(c, 0.1), at(b, 0.1));
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t next = (i + 1) % outline.size();
    add(at(i, -0.1), at(i, 0.1), at(next, 0.1));
    add(at(i, -0.1), at(next, 0.1), at(next, -0.1));
  }
  return dynamics_engine().convex_pieces(corners, triangles, 0.02);
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
      {"decomposition", arch(), 0.1},
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
      {"corner", {corner_floor()}},
  };
}

enum class Carrier {
  body,
  base,
  link
};  // a body; the base of a robot; a link that a joint holds at a base without shape

constexpr std::array<const char*, 3> kCarriers = {"body", "base", "link"};

struct Trial {
  std::unique_ptr<DynamicsWorld> world;
  WorldLink id{};
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
  glm::dvec3 at{0.013, 0.007, 0};
  Carrier carrier = Carrier::body;
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
  switch (setting.carrier) {
    case Carrier::body:
      trial.id.id =
          trial.world->add_body({.world_from_body = pose, .mass = own, .shapes = body.shapes, .surface = surface});
      break;
    case Carrier::base:
      trial.id.id = trial.world->add_articulation(
          {.fixed_base = false, .world_from_base = pose, .mass = own, .shapes = body.shapes, .surface = surface});
      break;
    case Carrier::link: {
      MassProperties half = own;
      half.mass_kg /= 2;
      half.inertia_kg_m2 /= 2;
      const LinkDesc link{.mass = half, .shapes = body.shapes, .surface = surface};
      trial.id = {
          trial.world->add_articulation({.fixed_base = false, .world_from_base = pose, .mass = half, .links = {link}}),
          0};
      break;
    }
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
  const int steps = static_cast<int>(1.2 / setting.step_s);
  for (int i = 0; i < steps && trial.step(); ++i) {
    if (i * setting.step_s < fall_s + 2.5 * setting.step_s) continue;
    rebound = std::max(rebound, trial.state().center_m.z - body.height_m);
    if (body.rolls == 0) tilt = std::max(tilt, tilt_deg(trial.state(), setting.turn));
  }
  const glm::dvec3 at = trial.state().center_m;
  std::printf(",%.5f,%.5f,%.5f", rebound * 1e3, tilt, std::hypot(at.x - setting.at.x, at.y - setting.at.y) * 1e3);
}

void rest(const Body& body, const Floor& floor, const Setting& setting) {
  Trial trial = start(body, floor, setting);
  const glm::dvec3 from = trial.state().center_m;
  double moved = 0;
  const int steps = static_cast<int>(2 / setting.step_s);
  for (int i = 0; i < steps && trial.step(); ++i) moved = std::max(moved, glm::length(trial.state().center_m - from));
  std::printf(",%.5f", moved * 1e3);
}

void slope(const Body& body, const Floor& floor, Setting setting) {
  const bool rolls = body.rolls > 0;
  const double angle = std::atan(0.5) + 2 * std::numbers::pi / 180;
  setting.friction = rolls ? 1 : 0.5;
  setting.gravity = kGravity_m_s2 * glm::dvec3(std::sin(angle), 0, -std::cos(angle));
  constexpr double kTime_s = 0.5;
  Trial trial = start(body, floor, setting);
  const glm::dvec3 from = trial.state().center_m;
  const int steps = static_cast<int>(std::lround(kTime_s / setting.step_s));
  for (int i = 0; i < steps && trial.step(); ++i) continue;
  const double along = rolls ? std::sin(angle) / (1 + body.rolls) : std::sin(angle) - 0.5 * std::cos(angle);
  const double exact = kGravity_m_s2 * along * kTime_s * (kTime_s + setting.step_s) / 2;
  const glm::dvec3 moved = trial.state().center_m - from;
  std::printf(",%.5f,%.5f", moved.x / exact, std::abs(moved.y) * 1e3);
}

void energy(const Body& body, const Floor& floor, Setting setting) {
  double worst = 0;
  for (const auto& [restitution, friction] : {std::pair{1.0, 0.0}, {1.0, 0.7}}) {
    for (const auto& [x, y] : {std::pair{1.0, 2.0}, {30.0, 20.0}, {45.0, 35.264}}) {
      const double to_rad = std::numbers::pi / 180;
      setting.turn = glm::dmat3(
          glm::rotate(glm::rotate(glm::dmat4(1), x * to_rad, glm::dvec3(1, 0, 0)), y * to_rad, glm::dvec3(0, 1, 0)));
      setting.height_m = 1;
      setting.at.y = -0.08;  // turned bodies reach farther, and must not overlap the wall of a corner at the start
      setting.restitution = restitution;
      setting.friction = friction;
      Trial trial = start(body, floor, setting);
      const double from = trial.energy();
      const int steps = static_cast<int>(2 / setting.step_s);
      for (int i = 0; i < steps && trial.step(); ++i) worst = std::max(worst, trial.energy() / from);
    }
  }
  std::printf(",%.6f", worst);
}

void stack(const Setting& setting) {
  for (const double ratio : {0.001, 1.0, 1000.0}) {
    const auto world =
        dynamics_engine().make_world({.gravity_m_s2 = setting.gravity, .step_s = setting.step_s, .iterations = 50});
    world->add_body({.kind = BodyKind::fixed, .shapes = floors()[0].shapes});
    std::vector<std::size_t> ids;
    double mass = 1;
    for (int i = 0; i < 2; ++i) {
      const MassProperties own{.mass_kg = mass, .inertia_kg_m2 = glm::dmat3(mass * 0.04 / 6)};
      const glm::dmat4 pose = glm::translate(glm::dmat4(1), {0, 0, 0.1 + 0.2 * i});
      const std::vector<CollisionShape> shapes = {box_shape(glm::dvec3(0.1))};
      ids.push_back(
          setting.carrier == Carrier::body
              ? world->add_body({.world_from_body = pose, .mass = own, .shapes = shapes})
              : world->add_articulation({.fixed_base = false, .world_from_base = pose, .mass = own, .shapes = shapes}));
      mass *= ratio;
    }
    double moved = 0;
    for (int i = 0; i * setting.step_s < 10; ++i) {
      world->step();
      for (int k = 0; k < 2; ++k) {
        const glm::dvec3 at = world->state(ids[static_cast<std::size_t>(k)]).center_m;
        moved = std::max(moved, glm::length(at - glm::dvec3(0, 0, 0.1 + 0.2 * k)));
      }
    }
    std::printf("%s,stack %g,box,%g,,,,%.5f,,,\n", kCarriers[static_cast<std::size_t>(setting.carrier)], ratio,
                setting.step_s * 1e3, moved * 1e3);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool one_pair = argc == 4 && std::atof(argv[2]) == 0;
  std::vector<double> steps_ms;
  for (int i = 1; i < (one_pair ? 2 : argc); ++i) steps_ms.push_back(std::atof(argv[i]));
  if (steps_ms.empty()) steps_ms = {1, 4};
  std::printf(
      "carrier,body,floor,step_ms,rebound_mm,tilt_deg,aside_mm,rest_mm,slope_share,slope_aside_mm,energy_share\n");
  for (const double step_ms : steps_ms) {
    for (const Carrier carrier : {Carrier::body, Carrier::base, Carrier::link}) {
      const Setting setting{.step_s = step_ms * 1e-3, .carrier = carrier};
      for (const Body& body : bodies()) {
        if (one_pair && body.name != argv[2]) continue;
        for (const Floor& floor : floors()) {
          if (one_pair && floor.name != argv[3]) continue;
          std::printf("%s,%s,%s,%g", kCarriers[static_cast<std::size_t>(carrier)], body.name.c_str(),
                      floor.name.c_str(), step_ms);
          drop(body, floor, setting);
          rest(body, floor, setting);
          slope(body, floor, setting);
          energy(body, floor, setting);
          std::printf("\n");
          std::fflush(stdout);
        }
      }
      if (!one_pair && carrier != Carrier::link) stack(setting);
    }
  }
}
