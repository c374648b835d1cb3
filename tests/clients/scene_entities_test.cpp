// The entities of simulation_interfaces: spawned, put elsewhere, filtered and removed, with each kind of entity,
// resource, pose and frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <string>
#include <vector>

#include "tests/clients/controlled_run.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("clients");

namespace simvis {
namespace {

using Result = ros::SimulationResult;
using Spawned = ros::SpawnResult;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

glm::dmat4 matrix_of(const ros::Pose& pose) {
  const ros::Quaternion& q = pose.orientation;
  glm::dmat4 matrix = glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
  matrix[3] = {pose.position.x, pose.position.y, pose.position.z, 1};
  return matrix;
}

double distance(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0;
  for (int i = 0; i < 4; ++i) largest = std::max(largest, glm::length(a[i] - b[i]));
  return largest;
}

// Some ten products of doubles, of coordinates of at most 1e3 m.
constexpr double kServedRounding_m = 1e-11;

TEST_CASE("an entity is spawned, or it is said why not") {
  struct Case {
    ros::EntitySpawn spawn;
    std::uint8_t result;
    std::string name = "";
  };
  ControlledRun run;
  const std::string inside = (run.folder / "open/chair.urdf").string(), outside = (run.folder / "chair.urdf").string();
  const auto with = [](ros::EntitySpawn spawn, const std::function<void(ros::EntitySpawn&)>& change) {
    change(spawn);
    return spawn;
  };
  const ros::EntitySpawn chair = spawn_of("", "chair.urdf"), named = spawn_of("N", "chair.urdf");
  const auto renaming = [&](ros::EntitySpawn spawn) {
    return with(std::move(spawn), [](ros::EntitySpawn& each) { each.allow_renaming = true; });
  };
  const auto posed = [&](const ros::Pose& pose) {
    return with(named, [&](ros::EntitySpawn& each) { each.initial_pose.pose = pose; });
  };
  const Case cases[] = {
      {spawn_of("A", "chair.urdf"), Result::kOk, "A"},
      {spawn_of("A", "chair.urdf"), Spawned::kNameNotUnique},
      {spawn_of("CART", "chair.urdf"), Spawned::kNameNotUnique},
      {spawn_of("EYE", "chair.urdf"), Spawned::kNameNotUnique},
      {spawn_of("ROOT", "chair.urdf"), Spawned::kNameNotUnique},
      {renaming(spawn_of("A", "chair.urdf")), Result::kOk, "A_2"},
      {renaming(spawn_of("A", "chair.urdf")), Result::kOk, "A_3"},
      {renaming(chair), Result::kOk, "chair"},
      {renaming(spawn_of("", "file://" + (run.folder / "open/a%20b.urdf").string())), Result::kOk, "a_b"},
      {chair, Spawned::kNameInvalid},
      {spawn_of("a/b", "chair.urdf"), Spawned::kNameInvalid},
      {spawn_of("a\"/><remove name=\"CART", "chair.urdf"), Spawned::kNameInvalid},
      {spawn_of(std::string(201, 'a'), "chair.urdf"), Spawned::kNameInvalid},
      {renaming(spawn_of(std::string("a\0b", 3), "chair.urdf")), Spawned::kNameInvalid},
      {spawn_of("B", inside), Result::kOk, "B"},
      {spawn_of("C", "file://" + inside), Result::kOk, "C"},
      {spawn_of("N", outside), Result::kFailed},
      {spawn_of("N", "../chair.urdf"), Result::kFailed},
      {spawn_of("N", "file://" + outside), Result::kFailed},
      {spawn_of("N", (run.folder / "none.urdf").string()), Result::kFailed},  // as one that is there
      {spawn_of("N", "none.urdf"), Result::kNotFound},
      {spawn_of("N", std::string(300, 'a') + ".urdf"), Result::kNotFound},  // longer than a name of a file may be
      {spawn_of("N", "http://host/chair.urdf"), Result::kNotFound},
      {spawn_of("N", "${1}.urdf"), Result::kNotFound},
      {spawn_of("N", "a\nb.urdf"), Result::kNotFound},
      {spawn_of("N", "chair.urdf\" shape=\"box"), Spawned::kUnsupportedFormat},
      {spawn_of("N", "notes.txt"), Spawned::kUnsupportedFormat},
      {spawn_of("N", "broken.urdf"), Spawned::kResourceParseError},
      {spawn_of("N", ""), Spawned::kNoResource},
      {with(spawn_of("N", ""), [](ros::EntitySpawn& each) { each.entity_resource.resource_string = kChair; }),
       Result::kUnsupported},
      {with(named, [](ros::EntitySpawn& each) { each.entity_namespace = "robot"; }), Result::kUnsupported},
      {with(named, [](ros::EntitySpawn& each) { each.entity_namespace = "no such"; }), Spawned::kNamespaceInvalid},
      {posed(pose_at(kNan, 0, 0)), Spawned::kInvalidPose},
      {posed(pose_at(0, INFINITY, 0)), Spawned::kInvalidPose},
      {posed(pose_at(0, 0, 1e16)), Spawned::kInvalidPose},
      {posed(pose_at(0, 0, 0, {0, 0, 0, 0})), Spawned::kInvalidPose},
      {posed(pose_at(0, 0, 0, {kNan, 0, 0, 0})), Spawned::kInvalidPose},
      {posed(pose_at(0, 0, 0, {2, 0, 0, 0})), Spawned::kInvalidPose},
      {with(named, [](ros::EntitySpawn& each) { each.initial_pose.header.frame_id = "nowhere"; }), Result::kNotFound}};
  for (const Case& each : cases) {
    CAPTURE(each.spawn.name);
    CAPTURE(each.spawn.entity_resource.uri);
    const std::vector<std::string> before = run.entities();
    const ros::SpawnEntityReply reply = run.spawn(each.spawn);
    CHECK_MESSAGE(reply.result.result == each.result, reply.result.error_message);
    CHECK(reply.entity_name == each.name);
    CHECK(reply.result.error_message.empty() == (each.result == Result::kOk));
    CHECK(run.entities().size() == before.size() + (each.result == Result::kOk ? 1 : 0));
  }
  CHECK(run.run(1) == 1);  // the scene can be drawn
  ros::SpawnEntitiesRequest many;
  many.spawn_requests.resize(257, named);
  CHECK(run.ask<ros::SpawnEntitiesReply>("spawn_entities", many).result.result == Result::kFailed);
  CHECK(run.entities("^N$").empty());
}

TEST_CASE("a pose of which one coordinate is beyond the limits is not set at all") {
  constexpr double kFar_m = 9e14;  // twice that is more than a coordinate may have
  ControlledRun run;
  CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf", pose_at(0, kFar_m, 0))).result.result == Result::kOk);
  CHECK(run.place("WALL", pose_at(1, kFar_m, 0), "CHAIR").result == Result::kFailed);
  CHECK(distance(matrix_of(run.state("WALL").state.pose), matrix_of(pose_at(6, 0, 0))) <= kServedRounding_m);
}

TEST_CASE("an entity stands where it was put, in any frame, and so do the parts that track it") {
  ControlledRun run;
  run.control.pause();
  const glm::dquat turn = glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2));
  const ros::Pose pose = pose_at(3, -2, 1, turn);
  for (const char* const entity : {"BALL", "CART", "WALL", "MOUNT", "CHAIR"}) {
    for (const char* const frame : {"", "map", "WALL", "cart_link", "CART", "BALL"}) {
      CAPTURE(entity);
      CAPTURE(frame);
      if (std::string(entity) == "CHAIR" && run.entities("^CHAIR$").empty()) {
        CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf")).result.result == Result::kOk);
      }
      const std::string base = std::string(frame) == "cart_link" ? "CART" : frame;
      const bool in_world = base.empty() || base == "map";
      const glm::dmat4 expected = (in_world ? glm::dmat4(1) : matrix_of(run.state(base).state.pose)) * matrix_of(pose);
      const Result result = run.place(entity, pose, frame);
      REQUIRE_MESSAGE(result.result == Result::kOk, result.error_message);
      const ros::EntityState state = run.state(entity).state;
      CHECK(state.header.frame_id == "map");
      CHECK(distance(matrix_of(state.pose), expected) <= kServedRounding_m);
    }
    run.simulation.track_part(entity);
    const glm::dmat4 before = matrix_of(run.state(entity).state.pose);
    if (std::string(entity) == "BALL") continue;  // it falls
    run.control.step(1);
    CHECK(run.run(2) == 1);
    glm::dmat4 world_from_part;
    REQUIRE(run.simulation.part_pose(entity, world_from_part));
    CHECK(distance(world_from_part, before) <= kServedRounding_m);
  }
}

TEST_CASE("what can't be set is refused, and nothing is set") {
  ControlledRun run;
  const glm::dmat4 before = matrix_of(run.state("CART").state.pose);
  using Set = ros::SetEntityStateRequest;
  CHECK(run.place("NONE", pose_at(1, 2, 3)).result == Result::kNotFound);
  CHECK(contains(run.place("CRAT", pose_at(1, 2, 3)).error_message, "did you mean \"CART\""));
  CHECK(run.place("EYE", pose_at(1, 2, 3)).result == Result::kNotFound);
  CHECK(run.place("ROOT", pose_at(1, 2, 3)).result == Result::kNotFound);
  CHECK(run.state("NONE").result.result == Result::kNotFound);
  CHECK(run.place("CART", pose_at(kNan, 2, 3)).result == Set::kInvalidPose);
  CHECK(run.place("CART", pose_at(1, 2, 3, {0, 0, 0, 0})).result == Set::kInvalidPose);
  CHECK(run.place("CART", pose_at(1, 2, 3), "nowhere").result == Result::kNotFound);
  Set request;
  request.entity = "CART";
  request.set_twist = true;
  const auto set = [&] { return run.ask<ros::ResultReply>("set_entity_state", request).result.result; };
  request.state.pose = pose_at(1, 2, 3);
  CHECK(set() == Result::kFailed);
  request.set_pose = true;
  request.state.twist.angular.z = 1;
  CHECK(set() == Result::kFailed);
  request.state.twist.angular.z = kNan;
  CHECK(set() == Result::kFailed);
  request.set_twist = false;
  request.set_acceleration = true;
  request.state.acceleration.linear.x = 1;
  CHECK(set() == Result::kFailed);
  CHECK(distance(matrix_of(run.state("CART").state.pose), before) == 0);
  request.set_pose = request.set_acceleration = false;  // nothing is to be set
  CHECK(set() == Result::kOk);
  request.entity = "NONE";
  CHECK(set() == Result::kNotFound);
}

TEST_CASE("the twist is that of the body: the free fall, and rest after the body was put elsewhere") {
  constexpr double kGravity_m_s2 = 9.80665, kRelative = 1e-12;  // rounding of a hundred additions
  ControlledRun run;
  CHECK(run.state("BALL").state.twist.linear.z == 0);
  CHECK(run.run(11) == 11);  // the first frame is at 0 s
  const ros::EntityState state = run.state("BALL").state;
  CHECK(state.header.stamp.sec == 1);
  CHECK(state.twist.linear.z == doctest::Approx(-kGravity_m_s2).epsilon(kRelative));
  CHECK(state.twist.linear.x == 0);
  CHECK(run.state("CART").state.twist.linear.z == 0);
  CHECK(run.place("BALL", pose_at(0, 0, 500)).result == Result::kOk);
  CHECK(run.state("BALL").state.twist.linear.z == 0);
  CHECK(run.run(2) == 2);
  CHECK(run.state("BALL").state.twist.linear.z ==
        doctest::Approx(-2 * kGravity_m_s2 / kServedRate_hz).epsilon(kRelative));
}

TEST_CASE("a removed entity is gone; one that others need stays") {
  ControlledRun run(true, true, R"(
      <part name="A" insert_at="ROOT"/><part name="B" insert_at="A"/>
      <part name="C" insert_at="ROOT"/>
      <sensor type="laser_scanner" name="SEEN" insert_at="C"/>
      <element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="SEEN"/>)");
  CHECK(run.remove("A").result == Result::kOk);
  CHECK(run.entities() == std::vector<std::string>{"C"});
  CHECK(run.remove("A").result == Result::kNotFound);
  CHECK(run.remove("SEEN").result == Result::kNotFound);
  const Result refused = run.remove("C");
  CHECK(refused.result == Result::kFailed);
  CHECK(contains(refused.error_message, "expected it to be removed before"));
  CHECK(run.entities() == std::vector<std::string>{"C"});
  CHECK(run.remove("").result == Result::kNotFound);
}

// "+)+)+)": ends so many nested groups, each of which is repeated.
std::string plus_of_groups(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "+)";
  return text;
}

TEST_CASE("entities are filtered by names, and a pattern that could take all memory is refused") {
  ControlledRun run;
  CHECK(run.entities("^.A") == std::vector<std::string>{"BALL", "CART", "WALL"});
  CHECK(run.entities("ALL$") == std::vector<std::string>{"BALL", "WALL"});
  CHECK(run.entities("(CAR|MOUN)T") == std::vector<std::string>{"MOUNT", "CART"});
  CHECK(run.entities("none").empty());
  CHECK(run.entities("^" + std::string(6, '(') + "B" + plus_of_groups(6)) == std::vector<std::string>{"BALL"});
  const auto result_with = [&](const auto& change) {
    ros::EntitiesRequest request;
    change(request.filters);
    return run.ask<ros::GetEntitiesReply>("get_entities", request).result.result;
  };
  for (const std::string& pattern :
       {std::string("("), std::string("[a"), std::string("a{1,255}"), std::string("(a)\\1"), std::string(257, 'a'),
        std::string("a\0b", 3), "a" + std::string(7, '+'), std::string(7, '(') + "a" + plus_of_groups(7)}) {
    CAPTURE(pattern);
    CHECK(result_with([&](ros::EntityFilters& all) { all.filter = pattern; }) == Result::kFailed);
  }
  CHECK(result_with([](ros::EntityFilters& all) { all.categories.resize(1); }) == Result::kUnsupported);
  CHECK(result_with([](ros::EntityFilters& all) { all.tags.tags = {"a"}; }) == Result::kUnsupported);
  CHECK(result_with([](ros::EntityFilters& all) { all.bounds.type = 3; }) == Result::kUnsupported);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
