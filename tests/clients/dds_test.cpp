// A simulation on DDS, seen by another vendor's implementation and by strangers.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <set>
#include <thread>

#include <simvis/simulation.h>
#include "exchange/messages/dds/dds_node.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/system_types.h"
#include "simvis/ros/node_name.h"
#include "tests/messages/pip_packages.h"
#include "tests/support/error_of.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr const char* kSentScene = R"(
    <part name="CART" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="CART"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="CART" samples="21" min_angle="-20" max_angle="20"/>)";
constexpr double kSentWall_m = 4;

// A vehicle that takes commands.
constexpr std::string_view kDriven = R"(
    <element type="physics" name="PHYSICS" insert_at="ROOT"/>
    <part name="FLOOR" insert_at="ROOT" shape="box" size="50 50 1" pose_offset="0 0 -0.5 0 0 0"/>
    <element type="body" name="FLOOR_BODY" insert_at="FLOOR" kind="static"/>
    <part name="CAR" insert_at="ROOT" shape="box" size="0.6 0.3 0.2"/>
    <element type="vehicle" name="DRIVE" insert_at="CAR" mass="10" clearance="0.05" center="-0.05 0 0.1"/>
    <element type="velocity_command" name="COMMAND" insert_at="CAR" vehicle="DRIVE" topic="/cmd_vel"/>
    <sensor type="imu" name="IMU" insert_at="CAR"/>)";

struct Sent {
  explicit Sent(DdsDesc desc = {}) : domain(own_domain()) {
    desc.domain = domain;
    desc.folders.push_back(folder.path());
    simulation.join_dds(desc);
  }
  /// Steps until `done`.
  template <typename Done>
  void step_until(const Done& done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!done()) {
      REQUIRE(std::chrono::steady_clock::now() < end);
      simulation.step();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  ProcessResult step_beside(const std::vector<std::string>& arguments) {
    std::atomic<bool> done = false;
    ProcessResult result;
    std::thread runner([&] {
      result = Process(arguments).wait(std::chrono::seconds(90));
      done = true;
    });
    while (!done) {
      simulation.step();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    runner.join();
    return result;
  }
  TemporaryFolder folder;
  std::uint32_t domain;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), kSentScene));
};

/// The messages of this topic as long as the node lives.
template <ros::Message M>
std::vector<M> taken(ros::DdsNode& node, const std::string& topic) {
  std::vector<M> messages;
  for (const std::string& bytes : node.take(topic)) messages.push_back(ros::decode<M>(bytes));
  return messages;
}

ros::ParameterEvent event_of(const std::string& name, double value) {
  ros::ParameterEvent event;
  event.changed_parameters.emplace_back();
  event.changed_parameters[0].name = name;
  event.changed_parameters[0].value.type = 3;
  event.changed_parameters[0].value.double_value = value;
  return event;
}

}  // namespace

TEST_CASE("DDS: scans go out; values and requests come in, each as a whole or not at all") {
  if (!has_dds()) return test::skip("this build has no DDS");
  Sent sent({.requests = true});
  ros::DdsNode node(sent.domain);
  node.subscribe("/simvis/log", ros::describe<ros::String>());
  node.subscribe("/clock", ros::describe<ros::Clock>());
  const auto sink = node.sink(ros::SensorQos::reliable);
  std::size_t clocks = 0;
  sent.step_until([&] { return (clocks += taken<ros::Clock>(node, "/clock").size()) > 0; });
  // Until the host has found the writers, nothing arrives.
  const auto say = [&](const auto& message, const std::string& topic, const auto& done) {
    sent.step_until([&] {
      if (!done()) sink->write(topic, 0, message);
      return done();
    });
  };
  say(event_of("MOVE.x", 1.5), "/simvis/set", [&] { return sent.simulation.get("MOVE", "x") == 1.5; });
  sent.simulation.step();
  constexpr double kRounding = 0x1p-22;  // of a float
  CHECK(sent.simulation.scan("SCAN").range_m[10] == doctest::Approx(kSentWall_m - 1.5).epsilon(kRounding));

  std::vector<std::string> log;
  const auto logged = [&](const std::string& what) {
    return [&log, &node, what] {
      for (const ros::String& text : taken<ros::String>(node, "/simvis/log")) log.push_back(text.data);
      return std::ranges::any_of(log, [&](const std::string& text) { return text.find(what) != std::string::npos; });
    };
  };
  ros::ParameterEvent half = event_of("MOVE.x", 2.5);
  half.changed_parameters.push_back(event_of("MOVE.y", NAN).changed_parameters[0]);
  say(half, "/simvis/set", logged("MOVE.y: nan"));
  CHECK(sent.simulation.get("MOVE", "x") == 1.5);
  say(event_of("MOVE.w", 1), "/simvis/set", logged("expected one of: x, y, z"));
  say(ros::String{"<element type='pose' name='MORE' insert_at='ROOT' x='1'/>"}, "/simvis/request", logged(": done"));
  CHECK(sent.simulation.get("MORE", "x") == 1);
  say(ros::String{"<part file='/etc/passwd' name='P' insert_at='ROOT'/>"}, "/simvis/request",
      logged("a request may not use"));
  const DdsReport report = sent.simulation.leave_dds();
  CHECK(report.received > report.refused);
  CHECK(report.refused >= 3);
  CHECK(report.messages > 0);
  CHECK(report.dropped == 0);
  CHECK(error_of([&] { sent.simulation.leave_dds(); }).find("expected join_dds()") != std::string::npos);
}

TEST_CASE("DDS: another vendor's program receives a scan and the fixed transforms, and sets a value") {
  const std::string peer = tested_build() + "/bin/fast_dds_peer";
  if (!has_dds()) return test::skip("this build has no DDS");
  if (!std::filesystem::exists(peer))
    return test::skip("Fast DDS (libfastrtps-dev) was not installed when this was built");
  Sent sent;
  {
    const Process sender({peer, "send", std::to_string(sent.domain), "MOVE.x", "0.5"});
    sent.step_until([&] { return sent.simulation.get("MOVE", "x") == 0.5; });
  }
  sent.simulation.step();
  const ProcessResult received = sent.step_beside({peer, "receive", std::to_string(sent.domain), "SCAN"});
  REQUIRE_MESSAGE(received.exit_code == 0, received.err);
  std::istringstream lines(received.out);
  std::string stamp, limits, ranges, intensities, transforms;
  std::getline(lines, stamp);
  CHECK(stamp.ends_with(" SCAN"));
  const auto hex = [](float number) {
    char text[32];
    std::snprintf(text, sizeof text, "%a", static_cast<double>(number));
    return std::string(text);
  };
  std::getline(lines, limits);
  const Scan& scan = sent.simulation.scan("SCAN");
  CHECK(limits.starts_with(hex(static_cast<float>(scan.azimuth_rad.front())) + " " +
                           hex(static_cast<float>(scan.azimuth_rad.back())) + " "));
  std::getline(lines, ranges);
  std::string expected = "21:";
  for (const float range : scan.range_m) expected += " " + hex(range);
  CHECK(ranges == expected);
  std::getline(lines, intensities);
  CHECK(intensities == "0:");
  std::getline(lines, transforms);
  CHECK(transforms == "1 transforms");
  CHECK(received.out.find(" CART\nSCAN ") != std::string::npos);
}

TEST_CASE("DDS: the package cyclonedds of PyPI receives a scan and the fixed transforms") {
  if (!has_dds()) return test::skip("this build has no DDS");
  Sent sent;
  const auto packages = test::pip_packages({"cyclonedds"});
  if (!packages) return;
  ::setenv("PYTHONPATH", packages->c_str(), 1);
  const ProcessResult received = sent.step_beside(
      {"python3", SIMVIS_SOURCE_DIR "/tests/clients/read_dds.py", std::to_string(sent.domain), "SCAN"});
  ::unsetenv("PYTHONPATH");
  REQUIRE_MESSAGE(received.exit_code == 0, received.err);
  const auto hex = [](double number) {  // as Python prints it
    char text[40];
    std::snprintf(text, sizeof text, "%s0x1.%013llxp%+d", number < 0 ? "-" : "",
                  static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(number) & 0xfffffffffffffu),
                  std::ilogb(number));
    return std::string(text);
  };
  const Scan& scan = sent.simulation.scan("SCAN");
  std::string expected = "SCAN\n" + hex(static_cast<float>(scan.azimuth_rad.front())) + " " +
                         hex(static_cast<float>(scan.azimuth_rad.back())) + "\n21";
  for (const float range : scan.range_m) expected += " " + hex(range);
  CHECK(received.out == expected + "\nCART>SCAN\n");
}

TEST_CASE("DDS: change requests are refused unless they are asked for; values of parameters are taken") {
  if (!has_dds()) return test::skip("this build has no DDS");
  Sent sent;
  ros::DdsNode node(sent.domain);
  node.subscribe("/simvis/log", ros::describe<ros::String>());
  const auto sink = node.sink(ros::SensorQos::reliable);
  std::string log;
  for (const char* const request : {"<element type='pose' name='MORE' insert_at='ROOT'/>", "<remove name='SCAN'/>"}) {
    log.clear();
    sent.step_until([&] {
      sink->write("/simvis/request", 0, ros::String{request});
      for (const ros::String& text : taken<ros::String>(node, "/simvis/log")) log += text.data;
      return log.find("executes no change requests by DDS, expected one with --dds-requests") != std::string::npos;
    });
  }
  sent.step_until([&] {
    sink->write("/simvis/set", 0, event_of("MOVE.x", 1.5));
    return sent.simulation.get("MOVE", "x") == 1.5;
  });
  CHECK(log.find(": done") == std::string::npos);
  CHECK(sent.simulation.sensors().size() == 1);
  CHECK_THROWS_AS(sent.simulation.get("MORE", "x"), InputError);
  CHECK(sent.simulation.leave_dds().refused >= 2);
}

TEST_CASE("DDS: a request after which frames have no messages is refused, and the host goes on") {
  if (!has_dds()) return test::skip("this build has no DDS");
  Sent sent({.requests = true});
  ros::DdsNode node(sent.domain);
  node.subscribe("/simvis/log", ros::describe<ros::String>());
  const auto sink = node.sink(ros::SensorQos::reliable);
  std::string log;
  const auto say_until = [&](const std::string& request, const std::string& answer) {
    log.clear();
    sent.step_until([&] {
      sink->write("/simvis/request", 0, ros::String{request});
      for (const ros::String& text : taken<ros::String>(node, "/simvis/log")) log += text.data;
      return log.find(answer) != std::string::npos;
    });
  };
  say_until(R"(<sensor type="camera" name="X" insert_at="ROOT" frame="map"/>)", "would have the same frame \"map\"");
  say_until(R"(<sensor type="psd" name="P" insert_at="CART" topics="range:=/tf"/>)", "belongs to the simulation");
  CHECK(sent.simulation.sensors().size() == 1);
  sent.simulation.step();
  CHECK(sent.simulation.leave_dds().refused >= 2);
}

TEST_CASE("DDS: two simulations of a domain warn of each other") {
  if (!has_dds()) return test::skip("this build has no DDS");
  Sent one;
  const auto warnings = [](const Simulation& simulation) {
    return std::ranges::count_if(simulation.warnings(), [](const std::string& each) {
      return each.find("the domain has another node /simvis") != std::string::npos;
    });
  };
  one.simulation.step();
  CHECK(warnings(one.simulation) == 0);
  Simulation two = Simulation::from_string("<simvis></simvis>");
  two.join_dds({.domain = one.domain});
  one.step_until([&] {
    two.step();
    return warnings(one.simulation) == 1 && warnings(two) == 1;
  });
}

TEST_CASE("a name of a node is one that ROS 2 takes") {
  CHECK(full_node_name("sim_2") == "/sim_2");
  CHECK(full_node_name("/robot/Sim") == "/robot/Sim");
  for (const char* const wrong :
       {"", "/", "2sim", "sim/", "robot/sim", "/robot//sim", "/robot/2", "a b", "a-b", "~/sim", "s\xc3\xafm"}) {
    CHECK_MESSAGE(error_of([&] { full_node_name(wrong); }).find("is no name of a node of ROS 2") != std::string::npos,
                  wrong);
  }
  // Of the 247 bytes of a topic in ROS 2, /set_parameters_atomically takes 26.
  constexpr std::size_t kMax = 247 - 26;
  CHECK(full_node_name(std::string(kMax - 1, 'a')).size() == kMax);
  CHECK(error_of([&] { full_node_name(std::string(kMax, 'a')); }).find("expected 221 or fewer") != std::string::npos);
  if (!has_dds()) return test::skip("this build has no DDS");
  TemporaryFolder folder;
  const ProcessResult run =
      Process({tested_build() + "/bin/simvis-run", "--dds", std::to_string(own_domain()), "--dds-node", "2sim", "--out",
               (folder.path() / "out").string(), write_wall_scene(folder.path(), kSentScene).string()})
          .wait();
  CHECK(run.exit_code == 2);
  CHECK(run.err.find("--dds-node: \"2sim\" is no name of a node of ROS 2, expected NAME") != std::string::npos);
}

TEST_CASE("DDS: a simulation with another name has its topics there, and lives beside one with the usual name") {
  if (!has_dds()) return test::skip("this build has no DDS");
  DdsDesc desc;
  desc.node = "/robot/sim";
  Sent sent(desc);
  Simulation usual = Simulation::from_string("<simvis><element type='pose' name='MOVE' insert_at='ROOT'/></simvis>");
  usual.join_dds({.domain = sent.domain});
  ros::DdsNode node(sent.domain);
  node.subscribe("/robot/sim/log", ros::describe<ros::String>());
  node.subscribe("/parameter_events", ros::describe<ros::ParameterEvent>());
  const auto sink = node.sink(ros::SensorQos::reliable);
  std::string log;
  std::set<std::string> senders;
  sent.step_until([&] {
    usual.step();
    sink->write("/robot/sim/set", 0, event_of("MOVE.x", 1.5));
    sink->write("/robot/sim/set", 0, event_of("MOVE.w", 1));
    sink->write("/simvis/set", 0, event_of("MOVE.x", 2.5));
    for (const ros::String& text : taken<ros::String>(node, "/robot/sim/log")) log += text.data;
    for (const auto& event : taken<ros::ParameterEvent>(node, "/parameter_events")) senders.insert(event.node);
    return log.find("expected one of: x, y, z") != std::string::npos && usual.get("MOVE", "x") == 2.5 &&
           senders.size() == 2;
  });
  CHECK(senders == std::set<std::string>{"/robot/sim", "/simvis"});
  CHECK(sent.simulation.get("MOVE", "x") == 1.5);
  for (const Simulation* const each : {&sent.simulation, &usual}) {
    for (const std::string& warning : each->warnings()) CHECK(warning.find("another node") == std::string::npos);
  }
  // A topic of the scene that the node has is refused, also that of a follower.
  for (const char* const topic : {"/robot/sim/set", "/simvis/set"}) {
    const std::string command =
        R"(<sensor type="psd" name="P" insert_at="CART" topics="range:=)" + std::string(topic) + R"("/>)";
    CHECK(error_of([&] { sent.simulation.execute(command); }).find("belongs to the simulation") != std::string::npos);
  }
  sent.simulation.execute(R"(<sensor type="psd" name="P" insert_at="CART" topics="range:=/robot/simulated"/>)");
}

TEST_CASE("DDS: a service says of a client of another implementation why it gets no answer") {
  const std::string peer = tested_build() + "/bin/fast_dds_peer";
  if (!has_dds()) return test::skip("this build has no DDS");
  if (!std::filesystem::exists(peer))
    return test::skip("Fast DDS (libfastrtps-dev) was not installed when this was built");
  Sent sent;
  ros::DdsNode node(sent.domain);
  node.subscribe("/simvis/log", ros::describe<ros::String>());
  const Process client({peer, "ask", std::to_string(sent.domain)});
  std::string log;
  sent.step_until([&] {
    for (const ros::String& text : taken<ros::String>(node, "/simvis/log")) log += text.data;
    return log.find("/simvis/list_parameters: ") != std::string::npos;
  });
  CHECK(log.find("expected a request of rmw_cyclonedds") != std::string::npos);
}

TEST_CASE("DDS: a vehicle is driven by Twist and TwistStamped on one topic") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const std::uint32_t domain = own_domain();
  Simulation simulation = Simulation::from_string(std::string("<simvis>") + std::string(kDriven) + "</simvis>");
  simulation.join_dds({.domain = domain});
  ros::DdsNode plain(domain), stamped(domain);
  plain.subscribe("/simvis/log", ros::describe<ros::String>());
  const auto plain_sink = plain.sink(ros::SensorQos::reliable), stamped_sink = stamped.sink(ros::SensorQos::reliable);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const auto step_until = [&](const auto& say, const auto& done) {
    while (!done()) {
      REQUIRE(std::chrono::steady_clock::now() < end);
      say();
      simulation.step();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  };
  const auto left = [&] { return simulation.get("DRIVE", "left"); };
  step_until([&] { plain_sink->write("/cmd_vel", 0, ros::Twist{{0.1, 0, 0}, {}}); }, [&] { return left() > 0; });
  ros::TwistStamped back;
  back.twist.linear.x = -0.1;
  step_until([&] { stamped_sink->write("/cmd_vel", 0, back); }, [&] { return left() < 0; });
  step_until([] {}, [&] { return left() == 0; });  // the writer is gone
  std::string log;
  back.header.stamp.sec = 1'000'000;
  step_until([&] { stamped_sink->write("/cmd_vel", 0, back); },
             [&] {
               for (const ros::String& text : taken<ros::String>(plain, "/simvis/log")) log += text.data;
               return log.find("after the simulated time") != std::string::npos;
             });
  CHECK(left() == 0);
  simulation.execute("<remove name='COMMAND'/>");
  simulation.step();
  CHECK(simulation.leave_dds().refused > 0);
}

TEST_CASE("DDS: strangers who send nonsense and much of it do not stop the host") {
  const std::string peer = tested_build() + "/bin/fast_dds_peer";
  if (!has_dds()) return test::skip("this build has no DDS");
  if (!std::filesystem::exists(peer))
    return test::skip("Fast DDS (libfastrtps-dev) was not installed when this was built");
  Sent sent;
  ros::DdsNode node(sent.domain);
  node.subscribe("/simvis/log", ros::describe<ros::String>());
  std::size_t refusals = 0;
  {
    constexpr std::size_t kRefusals = 500;
    const Process flood({peer, "flood", std::to_string(sent.domain)});
    sent.step_until([&] { return (refusals += node.take("/simvis/log").size()) > kRefusals; });
  }
  const DdsReport report = sent.simulation.leave_dds();
  CHECK(report.refused > 0);
  CHECK(report.received >= report.refused);
}

TEST_CASE("a build without DDS says so") {
  if (has_dds()) return test::skip("this build has DDS");
  TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), kSentScene));
  CHECK(error_of([&] { simulation.join_dds({}); }).find("this build has no DDS") != std::string::npos);
}

TEST_SUITE_END();
