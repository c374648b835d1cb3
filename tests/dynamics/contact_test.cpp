// Contacts of each pair of shapes: drops, rest, slopes, bounces. bench/contact_matrix.cpp prints the whole table.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/world.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kHalf_m = 0.1, kDropMass_kg = 0.5;
// Of the energy at the start: the passes of a step end once no speed changes by more than 1e-8 m/s.
constexpr double kPassEnergy = 1e-6;

CollisionShape contact_box(const glm::dvec3& half, const glm::dvec3& at = glm::dvec3(0)) {
  CollisionShape box{.kind = CollisionKind::box, .half_m = half};
  box.body_from_shape = glm::translate(glm::dmat4(1), at);
  return box;
}

CollisionShape contact_hull(const glm::dvec3& half, const glm::dvec3& at = glm::dvec3(0)) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 8; ++i) {
    points.push_back(at + half * glm::dvec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
  }
  return dynamics_engine().convex_hull(points).value();
}

// A flat square of `cells` times `cells` squares, of two triangles each.
CollisionShape contact_mesh(std::uint32_t cells, double half_m) {
  CollisionShape mesh{.kind = CollisionKind::mesh};
  for (std::uint32_t i = 0; i < (cells + 1) * (cells + 1); ++i) {
    mesh.points.emplace_back(half_m * (2.0 * (i % (cells + 1)) / cells - 1),
                             half_m * (2.0 * (i / (cells + 1)) / cells - 1), 0);
  }
  for (std::uint32_t i = 0; i < cells * cells; ++i) {
    const std::uint32_t a = i / cells * (cells + 1) + i % cells, b = a + 1, c = a + cells + 1, d = c + 1;
    mesh.triangles.insert(mesh.triangles.end(), {a, b, d, a, d, c});
  }
  return mesh;
}

// The same with a wall along x behind the bodies, which they all but touch: its foot is a concave edge.
CollisionShape contact_corner() {
  constexpr double kWall_m = 0.1071, kSide_m = 20;
  CollisionShape corner{.kind = CollisionKind::mesh};
  for (const glm::dvec2& profile : {glm::dvec2(-kSide_m, 0), glm::dvec2(kWall_m, 0), glm::dvec2(kWall_m, kSide_m)}) {
    corner.points.emplace_back(-kSide_m, profile);
    corner.points.emplace_back(kSide_m, profile);
  }
  for (const std::uint32_t i : {0U, 2U}) {
    corner.triangles.insert(corner.triangles.end(), {i, i + 1, i + 3, i, i + 3, i + 2});
  }
  return corner;
}

// Two legs below a beam, as one closed mesh that HACD divides.
std::vector<CollisionShape> contact_arch() {
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
    add(at(a, -kHalf_m), at(b, -kHalf_m), at(c, -kHalf_m));
    add(at(a, kHalf_m), at(c, kHalf_m), at(b, kHalf_m));
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t next = (i + 1) % outline.size();
    add(at(i, -kHalf_m), at(i, kHalf_m), at(next, kHalf_m));
    add(at(i, -kHalf_m), at(next, kHalf_m), at(next, -kHalf_m));
  }
  constexpr double kConcavity_m = 0.02;
  return dynamics_engine().convex_pieces(corners, triangles, kConcavity_m);
}

struct ContactBody {
  std::string name;
  std::vector<CollisionShape> shapes;
  double height_m = kHalf_m;  // of its centre, when it stands
  bool rolls = false;
};

std::vector<ContactBody> contact_bodies() {
  CollisionShape capsule{.kind = CollisionKind::capsule, .half_m = {0.05, 0.05, 0.08}};
  capsule.body_from_shape = glm::rotate(glm::dmat4(1), std::numbers::pi / 2, glm::dvec3(0, 1, 0));
  CollisionShape lying{.kind = CollisionKind::cylinder, .half_m = glm::dvec3(kHalf_m)};
  lying.body_from_shape = glm::rotate(glm::dmat4(1), std::numbers::pi / 2, glm::dvec3(1, 0, 0));
  return {{"box", {contact_box(glm::dvec3(kHalf_m))}},
          {"sphere", {{.kind = CollisionKind::sphere, .half_m = glm::dvec3(kHalf_m)}}, kHalf_m, true},
          {"cylinder", {{.kind = CollisionKind::cylinder, .half_m = glm::dvec3(kHalf_m)}}},
          {"capsule", {capsule}, 0.05},
          {"hull", {contact_hull(glm::dvec3(kHalf_m))}},
          {"small hull", {contact_hull(glm::dvec3(0.005))}, 0.005},
          {"pieces",
           {contact_hull({0.03, 0.1, 0.05}, {-0.07, 0, -0.05}), contact_hull({0.03, 0.1, 0.05}, {0.07, 0, -0.05}),
            contact_hull({0.1, 0.1, 0.05}, {0, 0, 0.05})}},
          {"lying cylinder", {lying}, kHalf_m, true},
          {"decomposition", contact_arch()}};
}

struct ContactFloor {
  std::string name;
  std::vector<CollisionShape> shapes;
};

std::vector<ContactFloor> contact_floors() {
  return {{"box", {contact_box({20, 20, 0.5}, {0, 0, -0.5})}},
          {"two triangles", {contact_mesh(1, 20)}},
          {"mesh", {contact_mesh(40, 1)}},
          {"plane", {{.kind = CollisionKind::plane}}},
          {"hull", {contact_hull({20, 20, 0.5}, {0, 0, -0.5})}},
          {"two hulls", {contact_hull({10, 20, 0.5}, {-10, 0, -0.5}), contact_hull({10, 20, 0.5}, {10, 0, -0.5})}},
          {"corner", {contact_corner()}}};
}

struct ContactTrial {
  double step_s = kStep_s, friction = 0.5, restitution = 0, height_m = 0;
  glm::dvec3 gravity{0, 0, -kGravity_m_s2};
  glm::dmat3 turn{1.0};
  bool is_link = false;
};

class ContactWorld {
 public:
  ContactWorld(const ContactBody& body, const ContactFloor& floor, const ContactTrial& trial)
      : trial_(trial),
        moment_(kDropMass_kg * 4 * body.height_m * body.height_m / 6),
        world_(
            dynamics_engine().make_world({.gravity_m_s2 = trial.gravity, .step_s = trial.step_s, .iterations = 50})) {
    BodyDesc ground{.kind = BodyKind::fixed, .shapes = floor.shapes};
    ground.surface = {.friction = 1, .restitution = 1};
    world_->add_body(ground);
    const MassProperties mass{.mass_kg = kDropMass_kg, .inertia_kg_m2 = glm::dmat3(moment_)};
    glm::dmat4 pose(trial.turn);
    pose[3] = {0.013, 0.007, body.height_m + trial.height_m, 1};
    const SurfaceProperties surface{.friction = trial.friction, .restitution = trial.restitution};
    if (trial.is_link) {
      ArticulationDesc desc{.fixed_base = false, .world_from_base = pose, .mass = mass, .shapes = body.shapes};
      desc.surface = surface;
      id_ = world_->add_articulation(desc);
    } else {
      id_ = world_->add_body({.world_from_body = pose, .mass = mass, .shapes = body.shapes, .surface = surface});
    }
  }
  /// Calls `each` after each step.
  template <typename Each>
  void run(double time_s, Each&& each) {
    const long steps = std::lround(time_s / trial_.step_s);
    for (long i = 0; i < steps; ++i) {
      REQUIRE_FALSE(world_->step());
      each(state());
    }
  }
  BodyState state() const { return world_->state(id_); }
  // With the speed in the middle between both steps, which free flight keeps exactly.
  double energy_j() const {
    const BodyState now = state();
    return kDropMass_kg * glm::dot(now.velocity_m_s, now.velocity_m_s) / 2 +
           moment_ * glm::dot(now.angular_velocity_rad_s, now.angular_velocity_rad_s) / 2 -
           kDropMass_kg * glm::dot(trial_.gravity, now.center_m - trial_.step_s / 2 * now.velocity_m_s);
  }

 private:
  ContactTrial trial_;
  double moment_;  // a cube's
  std::unique_ptr<DynamicsWorld> world_;
  std::size_t id_ = 0;
};

template <typename Check>
void for_each_pair(Check&& check) {
  int pairs = 0;
  for (const bool is_link : {false, true}) {
    for (const ContactBody& body : contact_bodies()) {
      for (const ContactFloor& floor : contact_floors()) {
        CAPTURE(is_link);
        CAPTURE(body.name);
        CAPTURE(floor.name);
        check(body, floor, is_link);
        ++pairs;
      }
    }
  }
  CHECK(pairs == 2 * 9 * 7);
}

TEST_CASE("without restitution each body stops where it hits each floor, and stays") {
  constexpr double kRebound_m = 1e-3, kMoved_m = 1e-4;
  for (const double step_s : {2.5e-4, 1e-3, 4e-3}) {
    for_each_pair([&](const ContactBody& body, const ContactFloor& floor, bool is_link) {
      CAPTURE(step_s);
      ContactWorld world(body, floor, {.step_s = step_s, .height_m = 1, .is_link = is_link});
      const glm::dvec3 from = world.state().center_m;
      world.run(std::sqrt(2 / kGravity_m_s2) + 3 * step_s, [](const BodyState&) {});
      const glm::dvec3 hit = world.state().center_m;
      CHECK(std::abs(hit.z - body.height_m) < kRebound_m);
      CHECK(std::hypot(hit.x - from.x, hit.y - from.y) < kMoved_m);
      double moved = 0;
      world.run(0.25, [&](const BodyState& now) { moved = std::max(moved, glm::length(now.center_m - hit)); });
      CHECK(moved < kMoved_m);
    });
  }
}

TEST_CASE("a cylinder that lies on small triangles rests") {
  constexpr double kMoved_m = 1e-6;  // what rolls on by a lean of 1e-7 rad moves by as much
  for (const bool is_link : {false, true}) {
    for (const std::uint32_t cells : {12U, 60U}) {  // of 5 cm and 1 cm
      CAPTURE(is_link);
      CAPTURE(cells);
      ContactWorld world(contact_bodies()[7], {"mesh", {contact_mesh(cells, 0.3)}}, {.is_link = is_link});
      const glm::dvec3 from = world.state().center_m;
      double moved = 0;
      world.run(2, [&](const BodyState& now) { moved = std::max(moved, glm::length(now.center_m - from)); });
      CHECK(moved < kMoved_m);
    }
  }
}

TEST_CASE("bodies that fall on bumps come to rest, and never gain energy") {
  CollisionShape bumps = contact_mesh(40, 2);
  for (glm::dvec3& point : bumps.points) point.z = 0.05 * std::sin(7 * point.x) * std::cos(5 * point.y);
  for (const bool is_link : {false, true}) {
    for (const ContactBody& body : contact_bodies()) {
      CAPTURE(is_link);
      CAPTURE(body.name);
      ContactWorld world(body, {"bumps", {bumps}}, {.height_m = 0.5, .is_link = is_link});
      const double start = world.energy_j();
      double most = 0;
      world.run(2, [&](const BodyState&) { most = std::max(most, world.energy_j()); });
      CHECK(most < start + kPassEnergy * std::abs(start));
      CHECK(world.state().center_m.z > -0.05);
      if (body.rolls || body.name == "capsule" || body.name == "cylinder") continue;  // they roll on
      const glm::dvec3 from = world.state().center_m;
      world.run(1, [](const BodyState&) {});
      CHECK(glm::length(world.state().center_m - from) < 1e-4);
    }
  }
}

// Boxes on each other, each `ratio` times as heavy as the one below, on a box. Returns how far they move.
double stack_moves_m(int boxes, double ratio, double step_s, bool is_link, double time_s) {
  const auto world =
      dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -kGravity_m_s2}, .step_s = step_s, .iterations = 50});
  world->add_body({.kind = BodyKind::fixed, .shapes = contact_floors()[0].shapes});
  std::vector<std::pair<std::size_t, glm::dvec3>> placed;
  double mass = 1;
  for (int i = 0; i < boxes; ++i, mass *= ratio) {
    const glm::dvec3 at{0, 0, (2 * i + 1) * kHalf_m};
    const MassProperties properties{.mass_kg = mass, .inertia_kg_m2 = glm::dmat3(mass * 4 * kHalf_m * kHalf_m / 6)};
    const std::vector<CollisionShape> shapes = {contact_box(glm::dvec3(kHalf_m))};
    const glm::dmat4 pose = glm::translate(glm::dmat4(1), at);
    const std::size_t id =
        is_link ? world->add_articulation(
                      {.fixed_base = false, .world_from_base = pose, .mass = properties, .shapes = shapes})
                : world->add_body({.world_from_body = pose, .mass = properties, .shapes = shapes});
    placed.emplace_back(id, at);
  }
  double moved = 0;
  for (long i = 0; i < std::lround(time_s / step_s); ++i) {
    REQUIRE_FALSE(world->step());
    for (const auto& [id, at] : placed) moved = std::max(moved, glm::length(world->state(id).center_m - at));
  }
  return moved;
}

TEST_CASE("boxes on each other rest, whatever their masses and the step, as bodies and as links") {
  constexpr double kMoved_m = 1e-4;
  for (const bool is_link : {false, true}) {
    for (const double step_s : {2.5e-4, 1e-3, 4e-3}) {
      for (const double ratio : {1e-3, 1.0, 100.0, 1000.0}) {
        CAPTURE(is_link);
        CAPTURE(step_s);
        CAPTURE(ratio);
        CHECK(stack_moves_m(2, ratio, step_s, is_link, 2000 * step_s) < kMoved_m);
      }
    }
    CAPTURE(is_link);
    CHECK(stack_moves_m(10, 1, kStep_s, is_link, 2) < kMoved_m);
    CHECK(stack_moves_m(4, 10, kStep_s, is_link, 2) < kMoved_m);
    CHECK(stack_moves_m(3, 100, kStep_s, is_link, 2) < kMoved_m);
    CHECK(stack_moves_m(3, 100, 4 * kStep_s, is_link, 8) < kMoved_m);
  }
}

TEST_CASE("bodies slide down a slope as friction says, on each floor, at steps of any length") {
  // Within the time, the rear legs of what has legs slide over the seam of two hulls.
  constexpr double kTime_s = 0.5, kShare = 1e-3;
  const double angle = std::atan(0.5) + glm::radians(2.0);
  const glm::dvec3 gravity = kGravity_m_s2 * glm::dvec3(std::sin(angle), 0, -std::cos(angle));
  for (const double step_s : {1e-3, 4e-3}) {
    const double exact = (gravity.x + 0.5 * gravity.z) * kTime_s * (kTime_s + step_s) / 2;
    for_each_pair([&](const ContactBody& body, const ContactFloor& floor, bool is_link) {
      if (body.rolls) return;
      CAPTURE(step_s);
      ContactWorld world(body, floor, {.step_s = step_s, .gravity = gravity, .is_link = is_link});
      const glm::dvec3 from = world.state().center_m;
      world.run(kTime_s, [](const BodyState&) {});
      const glm::dvec3 moved = world.state().center_m - from;
      CHECK(std::abs(moved.x / exact - 1) < kShare);
      CHECK(std::abs(moved.y) < kShare * exact);
      CHECK(std::abs(moved.z) < kShare * exact);
    });
  }
}

TEST_CASE("no bounce creates energy, at any orientation, with and without friction, at steps of any length") {
  constexpr double kFall_s = 0.452;
  const std::vector<ContactBody> bodies = contact_bodies();
  const std::vector<ContactFloor> floors = contact_floors();
  for (const double step_s : {2.5e-4, 1e-3, 4e-3}) {
    for (const bool is_link : {false, true}) {
      for (const std::size_t shape : {0, 2, 4, 5, 6, 7}) {
        for (const std::size_t floor : {0, 1, 2}) {
          if (step_s < kStep_s && floor != 2) continue;  // which takes long
          for (const glm::dvec2& lean_deg : {glm::dvec2(1, 2), glm::dvec2(30, 20), glm::dvec2(45, 35.264)}) {
            for (const glm::dvec2& surface : {glm::dvec2(1, 0.7), glm::dvec2(1, 0), glm::dvec2(0.5, 0.7)}) {
              const double restitution = surface.x, friction = surface.y;
              CAPTURE(step_s);
              CAPTURE(is_link);
              CAPTURE(bodies[shape].name);
              CAPTURE(floors[floor].name);
              CAPTURE(lean_deg.x);
              CAPTURE(restitution);
              CAPTURE(friction);
              const glm::dmat4 turn =
                  glm::rotate(glm::rotate(glm::dmat4(1), glm::radians(lean_deg.x), glm::dvec3(1, 0, 0)),
                              glm::radians(lean_deg.y), glm::dvec3(0, 1, 0));
              ContactWorld world(bodies[shape], floors[floor],
                                 {.step_s = step_s,
                                  .friction = friction,
                                  .restitution = restitution,
                                  .height_m = 1,
                                  .turn = turn,
                                  .is_link = is_link});
              const double start = world.energy_j();
              double most = 0;
              world.run(std::max(kFall_s + 0.2, 1000 * step_s),
                        [&](const BodyState&) { most = std::max(most, world.energy_j()); });
              CHECK(most < start * (1 + kPassEnergy));
            }
          }
        }
      }
    }
  }
}

TEST_CASE("a ball with restitution 1 comes back to its height each time, at steps of any length") {
  for (const double step_s : {2.5e-4, 1e-3, 4e-3}) {
    for (const bool is_link : {false, true}) {
      CAPTURE(step_s);
      CAPTURE(is_link);
      ContactWorld world(contact_bodies()[1], contact_floors()[0],
                         {.step_s = step_s, .restitution = 1, .height_m = 1, .is_link = is_link});
      double late = 0;
      int steps = 0;
      world.run(20, [&](const BodyState& now) {
        if (++steps * step_s > 18) late = std::max(late, now.center_m.z - kHalf_m);
      });
      // Flights in steps reach their height but for g h^2 / 8; the highest step is up to h / 2 beside it.
      CHECK(std::abs(late - 1) < kGravity_m_s2 * step_s * step_s);
    }
  }
}

TEST_CASE("a box that falls from 5 m on the default floor stays where it falls") {
  MovingScene scene(
      kPhysics + body("GROUND", "shape='box' size='40 40 1' pose_offset='0 0 -0.5 0 0 0'", "kind='static'") +
      body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 5.1 0 0 0'", "shape='box' mass='0.5'"));
  scene.go_to(1.1);  // it hits after 1.01 s
  double highest = 0;
  for (int i = 1; i <= 1000; ++i) {
    scene.go_to(1.1 + i * kStep_s);
    highest = std::max(highest, scene.position("BOX").z);
  }
  CHECK(highest < 0.101);
  CHECK(glm::length(scene.position("BOX") - glm::dvec3(0, 0, 0.1)) < 1e-3);
  CHECK(scene.pose("BOX")[2].z > 1 - 1e-9);
}

TEST_CASE("a ball that is set down on a mesh of two triangles rests") {
  MovingScene scene(
      kPhysics + body("GROUND", "shape='box' size='40 40 1' pose_offset='0 0 -0.5 0 0 0'", "kind='static'") +
      body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 0.1 0 0 0'", "shape='sphere' mass='0.5'"));
  scene.go_to(10);
  CHECK(glm::length(scene.position("BALL") - glm::dvec3(0, 0, 0.1)) < 1e-4);
}

TEST_CASE("a hull of 1 cm has its own size") {
  MovingScene scene(kPhysics + ground() +
                    body("CUBE", "shape='box' size='0.01 0.01 0.01' pose_offset='0 0 0.005 0 0 0'", "mass='0.001'"));
  scene.go_to(1);
  CHECK(std::abs(scene.position("CUBE").z - 0.005) < 1e-6);
}

TEST_CASE("a ball that moves by more than a wall's thickness in a step stops at the wall") {
  for (const char* const wall : {"", "shape='box'"}) {
    CAPTURE(wall);
    MovingScene scene(physics("gravity='0 0 0'") +
                      body("WALL", "shape='box' size='0.02 4 4'", std::string("kind='static' ") + wall) +
                      body("BALL", "shape='sphere' radius='0.02' pose_offset='-2 0.3 0.2 0 0 0'",
                           "shape='sphere' mass='0.1' velocity='50 0 0'"));
    scene.go_to(0.1);
    CHECK(std::abs(scene.position("BALL").x + 0.03) < 1e-3);
  }
}

TEST_CASE("a fast ball passes by the edge of a wall that it does not hit") {
  MovingScene scene(physics("gravity='0 0 0'") +
                    body("WALL", "shape='box' size='0.02 4 4'", "kind='static' shape='box'") +
                    body("BALL", "shape='sphere' radius='0.02' pose_offset='-2.01 2.025 0 0 0 0'",
                         "shape='sphere' mass='0.1' velocity='50 0 0'"));
  scene.go_to(0.1);
  CHECK(std::abs(scene.position("BALL").x - 2.99) < 1e-9);
  CHECK(std::abs(scene.position("BALL").y - 2.025) < 1e-12);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
