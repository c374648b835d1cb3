// Forces and attachments that a scene does not use cost nothing in a step, counted at the world of physics. With belts
// that stand they change no byte.
#include <doctest/doctest.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elements/dynamics/attachments.h"
#include "elements/dynamics/wrench_sources.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

/// A world in which nothing happens. It counts the calls.
class CountingWorld : public DynamicsWorld {
 public:
  std::size_t add_body(const BodyDesc&) override { return ++calls; }
  std::size_t add_articulation(const ArticulationDesc&) override { return ++calls; }
  void remove(std::size_t) override { ++calls; }
  std::size_t add_constraint(const ConstraintDesc&) override { return ++calls; }
  void remove_constraint(std::size_t) override { ++calls; }
  void keep_apart(const WorldPart&, const WorldPart&) override { ++calls; }
  void move_surface(const WorldPart&, const SurfaceMotion&) override { ++calls; }
  void move(std::size_t, const glm::dmat4&) override { ++calls; }
  void drive(std::size_t, std::size_t, const JointDrive&) override { ++calls; }
  void place_joint(std::size_t, std::size_t, double) override { ++calls; }
  void place_ball(std::size_t, std::size_t, const glm::dquat&) override { ++calls; }
  void push(const WorldLink&, const Wrench&) override { ++calls; }
  std::optional<std::size_t> step() override { return std::nullopt; }
  BodyState state(const WorldLink&) const override {
    ++calls;
    return {};
  }
  JointState joint(std::size_t, std::size_t) const override { return {}; }
  glm::dquat ball(std::size_t, std::size_t) const override { return {1, 0, 0, 0}; }
  void measure_load(std::size_t, std::size_t, bool) override { ++calls; }
  LinkLoad load(std::size_t, std::size_t) const override { return {}; }
  std::vector<WorldContact> contacts() const override { return {}; }
  std::vector<WorldContact> touching() override { return {}; }
  void number_from(std::size_t) override { ++calls; }
  void archive(StateArchive&) override { ++calls; }
  std::size_t awake() const override { return 0; }

  mutable std::size_t calls = 0;
};

/// A body at a point. It counts how often it is looked for.
class CountingBody : public DynamicObject {
 public:
  CountingBody(const std::string& at, std::size_t number) {
    name = point = at;
    id = number;
  }
  std::size_t enter(DynamicsWorld&, const glm::dmat4&) override { return *id; }
  void begin_steps(DynamicsWorld&, const glm::dmat4&) override {}
  DynamicParts parts() const override { return {.mass = &mass_, .shapes = {}}; }
  std::optional<int> link_at(std::string_view insertion_point) const override {
    ++searches;
    return DynamicObject::link_at(insertion_point);
  }
  mutable std::size_t searches = 0;

 private:
  MassProperties mass_{.mass_kg = 1};
};

class CountingSource : public WrenchSource {
 public:
  using WrenchSource::WrenchSource;
  Wrench wrench(const PushedBody&, const PhysicsStep&) override {
    ++evaluated;
    return {};
  }
  std::size_t evaluated = 0;
};

TEST_CASE("without forces and attachments, a step looks for no body and calls nothing of the world") {
  CountingWorld world;
  CountingBody body("A", 1);
  DynamicObject* const objects[] = {&body};
  WrenchSources wrenches;
  Attachments attachments;
  for (int frame = 0; frame < 3; ++frame) {
    wrenches.find_bodies(objects);
    attachments.act(world, objects);
    for (int step = 0; step < 10; ++step) wrenches.act(world, {});
  }
  CHECK(world.calls == 0);
  CHECK(body.searches == 0);
}

TEST_CASE("bodies of forces and attachments are looked for once, until bodies or elements come or go") {
  CountingWorld world;
  CountingBody a("A", 1), b("B", 2);
  DynamicObject* const objects[] = {&a, &b};
  WrenchSources wrenches;
  Attachments attachments;
  CountingSource source("F", "A"), homeless("G", "C");
  Attachment grip{.name = "GRIP", .a = "A", .b = "B"};
  const auto frames = [&] {
    for (int frame = 0; frame < 5; ++frame) {
      wrenches.find_bodies(objects);
      attachments.act(world, objects);
      for (int step = 0; step < 10; ++step) wrenches.act(world, {});
    }
  };
  wrenches.add(source);
  wrenches.add(homeless);
  attachments.add(grip);
  frames();
  const std::size_t searches = a.searches;
  CHECK(searches > 0);
  CHECK(source.evaluated == 50);
  CHECK(homeless.evaluated == 0);
  // In each step the state of the body and a push; once two states and the constraint of the attachment.
  CHECK(world.calls == 2 * 50 + 3);
  frames();
  CHECK(a.searches == searches);
  CHECK(world.calls == 2 * 100 + 3);
  wrenches.forget_bodies();
  attachments.forget_bodies();
  frames();
  CHECK(a.searches == 2 * searches);
  CHECK(world.calls == 2 * 150 + 3);
  grip.is_wanted = false;
  frames();
  CHECK(world.calls == 2 * 200 + 4);
  CHECK(a.searches == 2 * searches);
}

TEST_CASE("elements that push and hold nothing change no byte of the motion") {
  const std::string falling = body("A", "shape='box' size='0.4 0.3 0.2' pose_offset='0 0 0.5 10 20 30'", "mass='1'") +
                              body("B", "shape='sphere' radius='0.1' pose_offset='0.1 0 1 0 0 0'",
                                   "shape='sphere' mass='1' velocity='0.3 0 0'");
  const std::string idle = falling +
                           "<element type='wind' name='WIND' insert_at='ROOT' x='9' gust='3'/>"
                           "<element type='force' name='FORCE' insert_at='A'/>"
                           "<element type='thruster' name='THRUSTER' insert_at='A'/>"
                           "<element type='rotor' name='ROTOR' insert_at='B' thrust_constant='1'/>"
                           "<element type='attachment' name='GRIP' insert_at='A' to='B' attached='0'/>";
  MovingScene plain(kPhysics + ground() + falling), with(kPhysics + ground("belt='1 0 0'") + idle);
  std::size_t compared = 0;
  for (int frame = 1; frame <= 40; ++frame) {
    plain.go_to(0.1 * frame);
    with.go_to(0.1 * frame);
    for (const char* const part : {"A", "B"}) {
      CHECK(plain.pose(part) == with.pose(part));
      ++compared;
    }
  }
  CHECK(compared == 80);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
