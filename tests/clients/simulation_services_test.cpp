// The services of simulation_interfaces, without a network: each of them, in each state of the run, with each kind of
// entity, resource, pose and frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "exchange/messages/cdr.h"
#include "simvis/sharing/simulation_services.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("clients");

namespace simvis {
namespace {

using Result = ros::SimulationResult;
using Spawned = ros::SpawnResult;
using Features = std::set<std::uint16_t>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr ros::RequestHeader kOwnHeader{.client = 3, .sequence = 8};
constexpr double kServedRate_hz = 10;

// A ball that falls from 1 km, a cart behind a turned and scaled mount, and a wall without an element of its own.
constexpr std::string_view kServedScene = R"(
    <element type="physics" name="PHYSICS" insert_at="ROOT" step="10"/>
    <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.5" pose_offset="0 0 1000 0 0 0"/>
    <element type="body" name="BALL_BODY" insert_at="BALL" shape="sphere" mass="2"/>
    <part name="MOUNT" insert_at="ROOT" pose_offset="1 2 3 10 20 30"/>
    <element type="scale" name="LARGE" insert_at="MOUNT" x="2" y="2" z="2"/>
    <part name="CART" insert_at="MOUNT" shape="box" size="1 1 1" pose_offset="0.5 0 0 0 0 90"/>
    <element type="pose" name="CART_POSE" insert_at="CART" x="0.25" roll="15"/>
    <element type="frame" name="CART_FRAME" insert_at="CART" frame="cart_link"/>
    <part name="WALL" insert_at="ROOT" shape="box" size="1 8 2" pose_offset="6 0 0 0 0 0"/>
    <sensor type="laser_scanner" name="EYE" insert_at="ROOT" samples="3" min_angle="-1" max_angle="1"/>)";
constexpr std::string_view kChair =
    R"(<robot name="c"><link name="seat"><visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>)";

struct ServedRun {
  explicit ServedRun(bool changes = true, bool resets = true, std::string_view scene = kServedScene)
      : simulation(Simulation::from_string(scene, simulation_desc(), folder.path())),
        services(
            simulation, control,
            {.changes = changes, .resets = resets, .folders = {folder / "open"}, .quit = [this] { quit = true; }}) {}
  static SimulationDesc simulation_desc() {
    SimulationDesc desc;
    desc.rate_hz = kServedRate_hz;
    return desc;
  }

  template <ros::Message Reply, ros::Message Request>
  std::optional<Reply> ask_later(const std::string& service, Request request) {
    request.header = kOwnHeader;
    const std::optional<std::string> bytes = services.answer(service, ros::encode(request));
    if (!bytes) return std::nullopt;
    auto reply = ros::decode<Reply>(*bytes);
    CHECK(reply.header.client == kOwnHeader.client);
    CHECK(reply.header.sequence == kOwnHeader.sequence);
    return reply;
  }
  template <ros::Message Reply, ros::Message Request>
  Reply ask(const std::string& service, const Request& request) {
    const std::optional<Reply> reply = ask_later<Reply>(service, request);
    REQUIRE(reply.has_value());
    return *reply;
  }
  ros::GetEntityStateReply state(const std::string& entity) {
    return ask<ros::GetEntityStateReply>("get_entity_state", ros::EntityRequest{{}, entity});
  }
  std::vector<std::string> entities(const std::string& filter = "") {
    ros::EntitiesRequest request;
    request.filters.filter = filter;
    return ask<ros::GetEntitiesReply>("get_entities", request).entities;
  }
  std::uint8_t run_state() {
    return ask<ros::GetSimulationStateReply>("get_simulation_state", ros::EmptyRequest{}).state.state;
  }
  Result set_run(std::uint8_t state) {
    return ask<ros::ResultReply>("set_simulation_state", ros::SetSimulationStateRequest{{}, {state}}).result;
  }
  Result reset(std::uint8_t scope = 0) {
    return ask<ros::ResultReply>("reset_simulation", ros::ResetSimulationRequest{{}, scope}).result;
  }
  Result place(const std::string& entity, const ros::Pose& pose, const std::string& frame = "") {
    ros::SetEntityStateRequest request;
    request.entity = entity;
    request.set_pose = true;
    request.state.header.frame_id = frame;
    request.state.pose = pose;
    return ask<ros::ResultReply>("set_entity_state", request).result;
  }
  Result remove(const std::string& entity) {
    return ask<ros::ResultReply>("delete_entity", ros::EntityRequest{{}, entity}).result;
  }
  ros::SpawnEntityReply spawn(const ros::EntitySpawn& entity) {
    return ask<ros::SpawnEntityReply>("spawn_entity", ros::SpawnEntityRequest{{}, entity});
  }
  std::optional<ros::ResultReply> step_reply() {
    const std::optional<std::string> bytes = services.take_step_reply();
    return bytes ? std::optional(ros::decode<ros::ResultReply>(*bytes)) : std::nullopt;
  }
  /// The frames that a run makes, as program/cli/run.cpp makes them, of at most `most`. Returns their number.
  int run(int most) {
    int made = 0;
    for (; made < most && control.makes_frame(); ++made) {
      control.begin_frame();
      simulation.step();
      services.follow_frame();
    }
    return made;
  }

  TemporaryFolder folder;
  bool has_folder = std::filesystem::create_directory(folder / "open");
  bool has_files = write("open/chair.urdf", kChair) && write("open/broken.urdf", "<robot") &&
                   write("open/a b.urdf", kChair) && write("open/notes.txt", "no part") && write("chair.urdf", kChair);
  bool quit = false;
  RunControl control{0};
  Simulation simulation;
  SimulationServices services;

 private:
  bool write(const std::string& name, std::string_view text) const {
    std::ofstream(folder / name) << text;
    return true;
  }
};

ros::Pose pose_at(double x, double y, double z, const glm::dquat& turn = {1, 0, 0, 0}) {
  return {.position = {x, y, z}, .orientation = {turn.x, turn.y, turn.z, turn.w}};
}

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

ros::EntitySpawn spawn_of(const std::string& name, const std::string& uri, const ros::Pose& pose = pose_at(0, 0, 0)) {
  ros::EntitySpawn spawn;
  spawn.name = name;
  spawn.entity_resource.uri = uri;
  spawn.initial_pose.pose = pose;
  return spawn;
}

TEST_CASE("each service answers in each state of the run; those that change something need the permission") {
  for (const bool changes : {false, true}) {
    for (const bool plays : {true, false}) {
      CAPTURE(changes);
      CAPTURE(plays);
      ServedRun run(changes);
      if (!plays) run.control.pause();
      const auto expected = [&](std::uint8_t with_permission) {
        return changes ? with_permission : Result::kUnsupported;
      };
      const std::uint8_t ok = Result::kOk;
      CHECK(run.run_state() == (plays ? 1 : 2));
      CHECK(run.entities() == std::vector<std::string>{"BALL", "MOUNT", "CART", "WALL"});
      CHECK(run.state("CART").result.result == ok);
      const auto states = run.ask<ros::GetEntitiesStatesReply>("get_entities_states", ros::EntitiesRequest{});
      for (std::size_t i = 0; i < std::min(states.states.size(), states.entities.size()); ++i) {
        CHECK(ros::encode(states.states[i]) == ros::encode(run.state(states.entities[i]).state));
      }
      CHECK(states.entities == std::vector<std::string>{"BALL", "MOUNT", "CART", "WALL"});
      CHECK(states.states.size() == 4);
      CHECK(run.place("CART", pose_at(1, 2, 3)).result == expected(ok));
      CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf")).result.result == expected(ok));
      const auto all = run.ask<ros::SpawnEntitiesReply>(
          "spawn_entities",
          ros::SpawnEntitiesRequest{{}, {spawn_of("SEAT", "chair.urdf"), spawn_of("SEAT", "chair.urdf")}});
      CHECK(all.result.result == expected(ros::SpawnEntitiesReply::kSpawnFailed));
      if (changes) {
        REQUIRE(all.results.size() == 2);
        CHECK(all.results[0].result.result == ok);
        CHECK(all.results[1].result.result == Spawned::kNameNotUnique);
      }
      CHECK(run.remove("CHAIR").result == (changes ? ok : Result::kUnsupported));
      CHECK(run.reset().result == expected(ok));
      const auto stepped = run.ask_later<ros::ResultReply>("step_simulation", ros::StepSimulationRequest{{}, 2});
      CHECK(stepped.has_value() == (plays || !changes));
      if (stepped) CHECK(stepped->result.result == expected(Result::kFailed));
      CHECK(run.set_run(2).result == expected(ok));
      CHECK(run.set_run(3).result == expected(ok));
      CHECK(run.quit == changes);
    }
  }
}

TEST_CASE("the features are those services that are executed") {
  const auto features = [](ServedRun&& run) {
    const auto reply = run.ask<ros::GetSimulatorFeaturesReply>("get_simulator_features", ros::EmptyRequest{}).features;
    CHECK(std::ranges::count(reply.spawn_formats, "urdf") == std::ranges::count(reply.features, 0));
    return Features(reply.features.begin(), reply.features.end());
  };
  CHECK(features(ServedRun(false, true)) == Features{10, 24});
  CHECK(features(ServedRun(true, false)) == Features{0, 1, 10, 11, 23, 24, 25, 26, 31, 32, 50});
  CHECK(features(ServedRun(true, true)) == Features{0, 1, 10, 11, 20, 23, 24, 25, 26, 31, 32, 50});
}

TEST_CASE("an entity is spawned, or it is said why not") {
  struct Case {
    ros::EntitySpawn spawn;
    std::uint8_t result;
    std::string name = "";
  };
  ServedRun run;
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
  ServedRun run;
  CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf", pose_at(0, kFar_m, 0))).result.result == Result::kOk);
  CHECK(run.place("WALL", pose_at(1, kFar_m, 0), "CHAIR").result == Result::kFailed);
  CHECK(distance(matrix_of(run.state("WALL").state.pose), matrix_of(pose_at(6, 0, 0))) <= kServedRounding_m);
}

TEST_CASE("an entity stands where it was put, in any frame, and so do the parts that track it") {
  ServedRun run;
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
  ServedRun run;
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
  ServedRun run;
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

TEST_CASE("steps are counted, answered at the last one, and ended by who pauses or plays") {
  ServedRun run;
  const auto step = [&](std::uint64_t steps) {
    return run.ask_later<ros::ResultReply>("step_simulation", ros::StepSimulationRequest{{}, steps});
  };
  CHECK(step(1)->result.result == Result::kFailed);  // it plays
  CHECK(run.set_run(2).result == Result::kOk);
  CHECK(run.set_run(2).result == ros::SetSimulationStateRequest::kAlreadyInTargetState);
  CHECK(step(0)->result.result == Result::kFailed);
  for (const int steps : {1, 3, 100}) {
    CAPTURE(steps);
    CHECK_FALSE(step(static_cast<std::uint64_t>(steps)).has_value());
    CHECK(run.run_state() == 1);
    CHECK(step(1)->result.result == Result::kFailed);  // another client's
    CHECK(run.run(steps - 1) == steps - 1);
    CHECK_FALSE(run.step_reply().has_value());
    CHECK(run.run(1000) == 1);
    CHECK(run.step_reply()->result.result == Result::kOk);
    CHECK(run.run_state() == 2);
  }
  CHECK_FALSE(step(std::numeric_limits<std::uint64_t>::max()).has_value());
  CHECK(run.run(2) == 2);
  run.control.step(1);  // a click on the page
  CHECK(run.set_run(2).result == Result::kOk);
  run.services.end_steps("end");
  CHECK(contains(run.step_reply()->result.error_message, "2 of 18446744073709551615 steps were made: end"));
  CHECK(run.run(1000) == 0);
  CHECK_FALSE(step(5).has_value());
  CHECK(run.set_run(1).result == Result::kOk);
  CHECK(run.control.is_playing());
  CHECK(run.control.steps() == 0);
}

TEST_CASE("when the run has ended, services answer, and change nothing") {
  ServedRun run;
  CHECK(run.set_run(2).result == Result::kOk);
  run.services.end();
  const auto stepped = run.ask_later<ros::ResultReply>("step_simulation", ros::StepSimulationRequest{{}, 1});
  REQUIRE(stepped.has_value());
  CHECK(stepped->result.result == Result::kIncorrectState);
  CHECK(contains(stepped->result.error_message, "the run has ended"));
  CHECK(run.remove("WALL").result == Result::kIncorrectState);
  CHECK(run.entities() == std::vector<std::string>{"BALL", "MOUNT", "CART", "WALL"});
}

TEST_CASE("only a request that changes the scene makes an error of a step that of a client") {
  ServedRun run;
  CHECK(run.spawn(spawn_of("N", "none.urdf")).result.result == Result::kNotFound);
  CHECK(run.remove("NONE").result == Result::kNotFound);
  CHECK(run.place("CART", pose_at(kNan, 2, 3)).result != Result::kOk);
  CHECK_FALSE(run.services.is_changed());
  CHECK(run.remove("WALL").result == Result::kOk);
  CHECK(run.services.is_changed());
}

TEST_CASE("the states of a run, and the changes between them") {
  using Set = ros::SetSimulationStateRequest;
  ServedRun run;
  CHECK(run.run(3) == 3);
  CHECK(run.set_run(1).result == Set::kAlreadyInTargetState);
  for (const std::uint8_t state : {4, 5, 77, 255}) CHECK(run.set_run(state).result == Set::kIncorrectTransition);
  CHECK(run.set_run(0).result == Result::kOk);
  CHECK(run.run_state() == 0);
  CHECK(run.simulation.next_frame().index == 0);
  CHECK(run.set_run(0).result == Set::kAlreadyInTargetState);
  CHECK(run.set_run(2).result == Result::kOk);
  CHECK(run.run_state() == 2);
  CHECK(run.set_run(0).result == Result::kOk);
  CHECK(run.set_run(1).result == Result::kOk);
  CHECK(run.run(2) == 2);
  CHECK(run.run_state() == 1);
  CHECK(run.set_run(3).result == Result::kOk);
  CHECK(run.run_state() == 3);
  CHECK(run.set_run(1).result == Set::kIncorrectTransition);
  CHECK(run.set_run(3).result == Set::kIncorrectTransition);
  CHECK(run.run(2) == 0);

  ServedRun fixed(true, false);
  CHECK(fixed.set_run(0).result == Result::kUnsupported);
  CHECK(fixed.reset().result == Result::kUnsupported);
  CHECK(fixed.reset(4).result == Result::kOk);  // what was spawned goes without going back in time
  CHECK(fixed.control.is_playing());
}

TEST_CASE("after a reset come the frames of the start, whatever was spawned, put elsewhere and removed") {
  ServedRun run;
  const auto frames = [&] {
    std::vector<double> values;
    for (int i = 0; i < 5; ++i) {
      CHECK(run.run(1) == 1);
      values.push_back(static_cast<double>(run.simulation.scan("EYE").range_m[1]));
      values.push_back(run.state("BALL").state.pose.position.z);
    }
    return values;
  };
  const std::vector<double> first = frames();
  CHECK(first.front() == doctest::Approx(5.5));  // the wall
  CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf", pose_at(2, 0, 0))).result.result == Result::kOk);
  CHECK(run.spawn(spawn_of("SEAT", "chair.urdf", pose_at(0, 5, 0))).result.result == Result::kOk);
  CHECK(run.place("WALL", pose_at(9, 0, 0)).result == Result::kOk);
  CHECK(run.place("BALL", pose_at(0, 0, 7)).result == Result::kOk);
  CHECK(run.remove("SEAT").result == Result::kOk);
  const std::vector<double> changed = frames();
  CHECK(changed.front() == doctest::Approx(1.5));  // the chair
  CHECK(run.reset(4).result == Result::kOk);       // spawned entities alone
  CHECK(run.entities("CHAIR").empty());
  CHECK(run.simulation.next_frame().index == 10);
  CHECK(run.run(1) == 1);
  CHECK(static_cast<double>(run.simulation.scan("EYE").range_m[1]) == doctest::Approx(8.5));
  for (const std::uint8_t scope : {1, 2, 3, 5, 8, 12, 254}) CHECK(run.reset(scope).result == Result::kUnsupported);
  for (const std::uint8_t scope : {0, 7, 255}) {
    CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf", pose_at(2, 0, 0))).result.result == Result::kOk);
    CHECK(run.reset(scope).result == Result::kOk);
    CHECK(run.simulation.next_frame().index == 0);
    CHECK(frames() == first);
  }
  CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf")).result.result == Result::kOk);
  CHECK(run.remove("WALL").result == Result::kOk);
  const Result result = run.reset();  // what the scene had is not made again
  CHECK(result.result == Result::kFailed);
  CHECK(contains(result.error_message, "the state is of another scene"));
  CHECK(run.set_run(0).result == ros::SetSimulationStateRequest::kTransitionError);
  CHECK(run.control.is_playing());
  CHECK(run.entities("CHAIR").size() == 1);
  CHECK(run.run(1) == 1);
}

TEST_CASE("a removed entity is gone; one that others need stays") {
  ServedRun run(true, true, R"(
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
  ServedRun run;
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

TEST_CASE("bytes that are no request of a service are refused") {
  ServedRun run;
  const std::string header = std::string("\0\1\0\0", 4) + std::string(16, '\1');
  for (const char* const service :
       {"get_simulator_features", "get_entities", "get_entity_state", "get_entities_states", "set_entity_state",
        "spawn_entity", "spawn_entities", "delete_entity", "get_simulation_state", "set_simulation_state",
        "step_simulation", "reset_simulation"}) {
    CAPTURE(service);
    for (const std::string& bytes : {std::string(), header.substr(0, 4), header.substr(0, 11), header,
                                     header + "\xff\xff\xff\x7f" + std::string(9, '\0')}) {
      CHECK(contains(error_of([&] { run.services.answer(service, bytes); }), "simulation_interfaces/srv/"));
    }
  }
  CHECK(run.run(1) == 1);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
