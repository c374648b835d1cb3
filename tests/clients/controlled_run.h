// A run of which the services of simulation_interfaces are asked, without a network.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/simulation.h>
#include "exchange/messages/cdr.h"
#include "simvis/sharing/simulation_services.h"
#include "tests/support/temporary_folder.h"

namespace simvis {

inline constexpr ros::RequestHeader kOwnHeader{.client = 3, .sequence = 8};
inline constexpr double kServedRate_hz = 10;

// A ball that falls from 1 km, a cart behind a turned and scaled mount, and a wall without an element of its own.
inline constexpr std::string_view kServedScene = R"(
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
inline constexpr std::string_view kChair =
    R"(<robot name="c"><link name="seat"><visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>)";

struct ControlledRun {
  using Result = ros::SimulationResult;

  explicit ControlledRun(bool changes = true, bool resets = true, std::string_view scene = kServedScene)
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

inline ros::Pose pose_at(double x, double y, double z, const glm::dquat& turn = {1, 0, 0, 0}) {
  return {.position = {x, y, z}, .orientation = {turn.x, turn.y, turn.z, turn.w}};
}

inline ros::EntitySpawn spawn_of(const std::string& name, const std::string& uri,
                                 const ros::Pose& pose = pose_at(0, 0, 0)) {
  ros::EntitySpawn spawn;
  spawn.name = name;
  spawn.entity_resource.uri = uri;
  spawn.initial_pose.pose = pose;
  return spawn;
}

}  // namespace simvis
