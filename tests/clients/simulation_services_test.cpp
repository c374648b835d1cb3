// The services of simulation_interfaces that control a run: who may do what, steps, states and resets.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/clients/controlled_run.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("clients");

namespace simvis {
namespace {

using Result = ros::SimulationResult;
using Spawned = ros::SpawnResult;
using Features = std::set<std::uint16_t>;

TEST_CASE("each service answers in each state of the run; those that change something need the permission") {
  for (const bool changes : {false, true}) {
    for (const bool plays : {true, false}) {
      CAPTURE(changes);
      CAPTURE(plays);
      ControlledRun run(changes);
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
  const auto features = [](ControlledRun&& run) {
    const auto reply = run.ask<ros::GetSimulatorFeaturesReply>("get_simulator_features", ros::EmptyRequest{}).features;
    CHECK(std::ranges::count(reply.spawn_formats, "urdf") == std::ranges::count(reply.features, 0));
    return Features(reply.features.begin(), reply.features.end());
  };
  CHECK(features(ControlledRun(false, true)) == Features{10, 24});
  CHECK(features(ControlledRun(true, false)) == Features{0, 1, 10, 11, 23, 24, 25, 26, 31, 32, 50});
  CHECK(features(ControlledRun(true, true)) == Features{0, 1, 10, 11, 20, 23, 24, 25, 26, 31, 32, 50});
}

TEST_CASE("steps are counted, answered at the last one, and ended by who pauses or plays") {
  ControlledRun run;
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
  ControlledRun run;
  CHECK(run.set_run(2).result == Result::kOk);
  run.services.end();
  CHECK(run.set_run(ros::SimulationState::kQuitting).result == Result::kIncorrectState);
  CHECK_FALSE(run.quit);
  const auto stepped = run.ask_later<ros::ResultReply>("step_simulation", ros::StepSimulationRequest{{}, 1});
  REQUIRE(stepped.has_value());
  CHECK(stepped->result.result == Result::kIncorrectState);
  CHECK(contains(stepped->result.error_message, "the run has ended"));
  CHECK(run.remove("WALL").result == Result::kIncorrectState);
  CHECK(run.entities() == std::vector<std::string>{"BALL", "MOUNT", "CART", "WALL"});
}

TEST_CASE("only a request that changes the scene makes an error of a step that of a client") {
  ControlledRun run;
  CHECK(run.spawn(spawn_of("N", "none.urdf")).result.result == Result::kNotFound);
  CHECK(run.remove("NONE").result == Result::kNotFound);
  CHECK(run.place("CART", pose_at(std::nan(""), 2, 3)).result != Result::kOk);
  CHECK_FALSE(run.services.is_changed());
  CHECK(run.remove("WALL").result == Result::kOk);
  CHECK(run.services.is_changed());
}

TEST_CASE("the states of a run, and the changes between them") {
  using Set = ros::SetSimulationStateRequest;
  ControlledRun run;
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

  ControlledRun fixed(true, false);
  CHECK(fixed.set_run(0).result == Result::kUnsupported);
  CHECK(fixed.reset().result == Result::kUnsupported);
  CHECK(fixed.reset(4).result == Result::kOk);  // what was spawned goes without going back in time
  CHECK(fixed.control.is_playing());
}

TEST_CASE("after a reset come the frames of the start, whatever was spawned, put elsewhere and removed") {
  ControlledRun run;
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
  CHECK(contains(result.error_message, "part WALL was removed, expected all that the scene had at the start"));
  CHECK(run.set_run(0).result == ros::SetSimulationStateRequest::kTransitionError);
  CHECK(run.control.is_playing());
  CHECK(run.entities("CHAIR").size() == 1);
  CHECK(run.run(1) == 1);
}

std::vector<double> next_frames(ControlledRun& run) {
  std::vector<double> values;
  for (int i = 0; i < 5; ++i) {
    CHECK(run.run(1) == 1);
    for (const float range_m : run.simulation.scan("EYE").range_m) values.push_back(static_cast<double>(range_m));
    values.push_back(run.state("BALL").state.pose.position.z);
  }
  return values;
}

TEST_CASE("a reset removes what other requests have added, and fails if they have removed something of the start") {
  const std::string added[] = {
      R"(<part name="NEW" insert_at="ROOT" shape="box" size="1 1 1" pose_offset="3 0 0 0 0 0"/>)",
      R"(<part name="NEW" insert_at="CHAIR" shape="box" size="1 1 1"/>)",
      R"(<part name="NEW" insert_at="ROOT" shape="sphere" radius="0.5" pose_offset="0 0 998.5 0 0 0"/>
         <element type="body" name="NEW_BODY" insert_at="NEW" shape="sphere" mass="2"/>)",
      R"(<element type="pose" name="NEW" insert_at="WALL" x="-2" moves="all"/>)",
      R"(<sensor type="laser_scanner" name="NEW" insert_at="WALL" samples="2"/>)",
      // Here what comes first refers to what follows, so the last one can't be removed first.
      R"(<element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="NEW"/>
         <sensor type="laser_scanner" name="NEW" insert_at="ROOT" samples="2"/>)"};
  for (const std::string& request : added) {
    for (const bool spawned_first : {false, true}) {
      CAPTURE(request);
      CAPTURE(spawned_first);
      ControlledRun run;
      const std::vector<double> first = next_frames(run);
      const auto spawn = [&] {
        CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf", pose_at(2, 0, 0))).result.result == Result::kOk);
      };
      const bool needs_chair = request.find("CHAIR") != std::string::npos;
      if (needs_chair || spawned_first) spawn();
      run.simulation.execute(request, run.folder.path(), "another request");
      if (!needs_chair && !spawned_first) spawn();
      CHECK(next_frames(run) != first);
      CHECK(run.reset().result == Result::kOk);
      CHECK(run.entities() == std::vector<std::string>{"BALL", "MOUNT", "CART", "WALL"});
      CHECK(run.simulation.sensors().size() == 1);
      CHECK(next_frames(run) == first);
    }
  }
  for (const std::string request :
       {R"(<remove name="WALL"/>)", R"(<remove name="CART_FRAME"/>)", R"(<remove name="EYE"/>)"}) {
    CAPTURE(request);
    ControlledRun run;
    CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf")).result.result == Result::kOk);
    run.simulation.execute(request, run.folder.path(), "another request");
    CHECK(run.reset().result == Result::kFailed);
    CHECK(run.entities("CHAIR").size() == 1);
  }
}

TEST_CASE("a reset of what was spawned leaves what another request has given the same name") {
  ControlledRun run;
  CHECK(run.spawn(spawn_of("CHAIR", "chair.urdf")).result.result == Result::kOk);
  run.simulation.execute(R"(<remove name="CHAIR"/>)", run.folder.path(), "another request");
  run.simulation.execute(R"(<part name="CHAIR" insert_at="ROOT"/>)", run.folder.path(), "another request");
  CHECK(run.reset(4).result == Result::kOk);
  CHECK(run.entities("CHAIR").size() == 1);
  CHECK(run.reset().result == Result::kOk);
  CHECK(run.entities("CHAIR").empty());
}

TEST_CASE("bytes that are no request of a service are refused") {
  ControlledRun run;
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
