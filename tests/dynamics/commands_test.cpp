// Vehicles and robots that messages of ROS 2 command: what they do, what is refused, and when they stop.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <limits>

#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/trajectory_types.h"
#include "tests/support/error_of.h"
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kWheel_m = 0.1, kTrack_m = 0.4, kFrame_s = 0.05, kTimeout_s = 0.5;
const double kNan = std::numeric_limits<double>::quiet_NaN();

std::string commanded_vehicle(const std::string& drive = "", const std::string& command = "topic='/cmd_vel'") {
  return kPhysics +
         "<part name='FLOOR' insert_at='ROOT' shape='box' size='100 100 1' pose_offset='0 0 -0.5 0 0 0'/>\n"
         "<element type='body' name='FLOOR_BODY' insert_at='FLOOR' kind='static' friction='1'/>\n"
         "<part name='CAR' insert_at='ROOT' shape='box' size='0.6 0.3 0.2'/>\n"
         "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='10' clearance='0.05' center='-0.05 0 0.1' " +
         drive + "/>\n<element type='velocity_command' name='COMMAND' insert_at='CAR' vehicle='DRIVE' " + command +
         "/>\n";
}

template <ros::Message M>
CommandInput input_of(const std::string& topic) {
  return {topic, &ros::describe<M>()};
}

void command_twist(MovingScene& scene, double forward_m_s, double turn_rad_s) {
  scene.command(input_of<ros::Twist>("/cmd_vel"), ros::encode(ros::Twist{{forward_m_s, 0, 0}, {0, 0, turn_rad_s}}));
}

TEST_CASE("a Twist sets the wheels so that the vehicle moves as it says") {
  MovingScene scene(commanded_vehicle());
  constexpr double kForward_m_s = 0.3, kTurn_rad_s = 0.4;
  double time_s = 0;
  const auto drive = [&](double seconds) {
    for (const double end_s = time_s + seconds; time_s < end_s - kFrame_s / 2;) {
      command_twist(scene, kForward_m_s, kTurn_rad_s);
      scene.go_to(time_s += kFrame_s);
    }
  };
  drive(1);  // it has its speed
  // v = r (left + right) / 2, w = r (right - left) / track.
  const double left = glm::radians(scene.get("DRIVE", "left")), right = glm::radians(scene.get("DRIVE", "right"));
  constexpr double kRounding = 1e-12;
  CHECK(std::abs(kWheel_m * (left + right) / 2 - kForward_m_s) < kRounding);
  CHECK(std::abs(kWheel_m * (right - left) / kTrack_m - kTurn_rad_s) < kRounding);
  const glm::dmat4 start = scene.pose("CAR");
  constexpr double kDrive_s = 4;
  drive(kDrive_s);
  const double angle = kTurn_rad_s * kDrive_s, radius = kForward_m_s / kTurn_rad_s;
  const glm::dvec3 expected(start * glm::dvec4(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0, 1));
  // Wheels slip by what one step of friction leaves: some 1e-3 of the way, as docs/dynamics.md says.
  CHECK(glm::length(glm::dvec2(scene.position("CAR") - expected)) < 2e-3 * kForward_m_s * kDrive_s + 1e-4);
}

TEST_CASE("a vehicle whose commands end stops after the timeout, and not before") {
  MovingScene scene(commanded_vehicle());
  command_twist(scene, 1, 0);
  double time_s = 0;
  int held = 0;
  for (; time_s < 2; ++held) {
    scene.go_to(time_s += kFrame_s);
    if (scene.get("DRIVE", "left") == 0) break;
  }
  // The command holds in the frames that begin before the timeout is over.
  CHECK(held == std::lround(kTimeout_s / kFrame_s));
  CHECK(scene.get("DRIVE", "right") == 0);
  scene.go_to(time_s += 1);
  const glm::dvec3 stopped = scene.position("CAR");
  scene.go_to(time_s += 1);
  CHECK(glm::distance(scene.position("CAR"), stopped) < 1e-3);
}

TEST_CASE("a client commands by parameters: command is what begins one") {
  MovingScene scene(commanded_vehicle());
  scene.set("COMMAND", "forward", 0.5);
  scene.go_to(kFrame_s);
  CHECK(scene.get("DRIVE", "left") == 0);
  scene.set("COMMAND", "command", 7);
  scene.go_to(2 * kFrame_s);
  CHECK(scene.get("DRIVE", "left") == doctest::Approx(glm::degrees(0.5 / kWheel_m)).epsilon(1e-12));
  // The value of the scene file is no command.
  MovingScene still(commanded_vehicle("", "command='3' forward='1'"));
  still.go_to(kFrame_s);
  CHECK(still.get("DRIVE", "left") == 0);
}

TEST_CASE("an ackermann drive steers by the curvature, and only while it drives") {
  MovingScene scene(commanded_vehicle("drive='ackermann' wheelbase='0.5' axle='-0.25'"));
  command_twist(scene, 0.5, 0.2);
  scene.go_to(kFrame_s);
  constexpr double kRounding = 1e-12;
  CHECK(std::abs(std::tan(glm::radians(scene.get("DRIVE", "steer"))) - 0.5 * 0.2 / 0.5) < kRounding);
  CHECK(std::abs(glm::radians(scene.get("DRIVE", "speed")) * kWheel_m - 0.5) < kRounding);
  const double steer = scene.get("DRIVE", "steer");
  command_twist(scene, 0, 0.2);
  scene.go_to(2 * kFrame_s);
  CHECK(scene.get("DRIVE", "speed") == 0);
  CHECK(scene.get("DRIVE", "steer") == steer);
  command_twist(scene, 0.01, 50);
  scene.go_to(3 * kFrame_s);
  CHECK(scene.get("DRIVE", "steer") == 60);  // as far as wheels steer
}

TEST_CASE("wheels that would be too fast are slowed down together") {
  MovingScene scene(commanded_vehicle("wheel_radius='0.001'"));
  command_twist(scene, 100, 100);
  scene.go_to(kFrame_s);
  CHECK(scene.get("DRIVE", "right") == 1e5);
  // left / right = (v - w track / 2) / (v + w track / 2).
  CHECK(scene.get("DRIVE", "left") == doctest::Approx(1e5 * 80 / 120).epsilon(1e-12));
}

TEST_CASE("commands that are no good are refused as a whole") {
  MovingScene scene(commanded_vehicle());
  scene.go_to(10);
  const std::vector<double> before = scene.values();
  const auto refused = [&](const CommandInput& input, const std::string& bytes) {
    const std::string why = error_of([&] { scene.command(input, bytes); });
    CHECK(scene.values() == before);
    return why;
  };
  const auto twist = input_of<ros::Twist>("/cmd_vel");
  for (const ros::Twist& wrong : {ros::Twist{{kNan, 0, 0}, {}}, ros::Twist{{1, 0, 0}, {0, 0, kNan}},
                                  ros::Twist{{1, kNan, 0}, {}}, ros::Twist{{HUGE_VAL, 0, 0}, {}}}) {
    CHECK(contains(refused(twist, ros::encode(wrong)), "/cmd_vel: a number is not finite"));
  }
  CHECK(contains(refused(twist, ros::encode(ros::Twist{{1e9, 0, 0}, {}})), "COMMAND.forward: "));
  CHECK(contains(refused(twist, ros::encode(ros::Twist{{1, 0, 0}, {0, 0, -1e9}})), "COMMAND.turn"));
  CHECK(contains(refused(twist, "\x00\x01"), "geometry_msgs/msg/Twist"));
  CHECK(contains(refused(twist, ros::encode(ros::String{"go"})), "geometry_msgs/msg/Twist"));
  CHECK(contains(refused(input_of<ros::Twist>("/other"), ros::encode(ros::Twist{})), "no element takes commands"));
  CHECK(contains(refused(input_of<ros::JointState>("/cmd_vel"), ros::encode(ros::JointState{})),
                 "no element takes commands"));
  const auto stamped = input_of<ros::TwistStamped>("/cmd_vel");
  const auto at = [](std::int32_t seconds, std::uint32_t nanoseconds) {
    ros::TwistStamped message;
    message.header.stamp = {seconds, nanoseconds};
    message.twist.linear.x = 1;
    return ros::encode(message);
  };
  CHECK(contains(refused(stamped, at(9, 400'000'000)), "0.6 s before the simulated time"));
  CHECK(contains(refused(stamped, at(1'700'000'000, 0)), "after the simulated time"));  // of the wall clock
  CHECK(contains(refused(stamped, at(-5, 0)), "15 s before"));
  scene.command(stamped, at(9, 600'000'000));
  scene.command(stamped, at(0, 0));
  CHECK(scene.get("COMMAND", "command") == 1);
}

TEST_CASE("of two writers the last one counts, and each starts the time again") {
  MovingScene scene(commanded_vehicle());
  command_twist(scene, 1, 0);
  command_twist(scene, -1, 0);
  scene.go_to(kFrame_s);
  CHECK(scene.get("DRIVE", "left") == doctest::Approx(-glm::degrees(1 / kWheel_m)).epsilon(1e-12));
  scene.go_to(kTimeout_s);
  command_twist(scene, 1, 0);
  scene.go_to(kTimeout_s + kFrame_s);
  scene.go_to(kTimeout_s + 2 * kFrame_s);
  CHECK(scene.get("DRIVE", "left") > 0);
}

TEST_CASE("mistakes in the scene") {
  const auto wrong = [](const std::string& command) {
    return error_of([&] { MovingScene scene(commanded_vehicle("", command)); });
  };
  CHECK(contains(wrong("topic='cmd_vel'"), "attribute \"topic\": \"cmd_vel\" is not allowed"));
  CHECK(contains(wrong("timeout='0'"), "timeout"));
  CHECK(contains(error_of([] {
                   MovingScene scene(
                       "<element type='pose' name='P' insert_at='ROOT'/><element type='velocity_command' "
                       "name='C' insert_at='ROOT' vehicle='P'/>");
                 }),
                 "\"P\" is not allowed, expected the name of an element of type vehicle"));
}

MovingScene commanded_arm(const std::string& control) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "robot.urdf") << kArm;
  return MovingScene(physics("gravity='0 0 0'") +
                         "<part name='R' insert_at='ROOT' file='robot.urdf'/>\n<element type='robot' name='ROBOT' "
                         "insert_at='R' " +
                         control +
                         "/>\n<element type='joint_command' name='COMMAND' insert_at='R' robot='ROBOT' "
                         "topic='/targets' trajectory_topic='/path'/>",
                     folder.path());
}

ros::JointState targets(std::vector<std::string> names, std::vector<double> position, std::vector<double> velocity) {
  return {{}, std::move(names), std::move(position), std::move(velocity), {}};
}

TEST_CASE("a JointState sets targets: positions hold, velocities end with the timeout") {
  MovingScene scene = commanded_arm("velocity_joints='elbow'");
  const auto input = input_of<ros::JointState>("/targets");
  scene.command(input, ros::encode(targets({"elbow", "shoulder"}, {0, 0.5}, {1, 0})));
  double time_s = 0;
  int held = 0;
  for (; time_s < 2; ++held) {
    scene.go_to(time_s += kFrame_s);
    if (scene.get("ROBOT", "target_elbow") == 0) break;
  }
  CHECK(held == std::lround(kTimeout_s / kFrame_s));
  CHECK(scene.get("ROBOT", "target_shoulder") == doctest::Approx(glm::degrees(0.5)).epsilon(1e-12));
}

TEST_CASE("joints that are not there, lists that do not fit and targets beyond limits are refused") {
  MovingScene scene = commanded_arm("velocity_joints='elbow'");
  const std::vector<double> before = scene.values();
  const auto refused = [&](const ros::JointState& state) {
    const std::string why = error_of([&] { scene.command(input_of<ros::JointState>("/targets"), ros::encode(state)); });
    CHECK(scene.values() == before);
    return why;
  };
  CHECK(contains(refused(targets({"elbo"}, {}, {1})), "there is no driven joint \"elbo\""));
  CHECK(contains(refused(targets({"elbow", "elbow"}, {}, {1, 1})), "comes twice"));
  CHECK(contains(refused(targets({"elbow", "shoulder"}, {0, 0, 0}, {1, 1})), "3 values for 2 joints"));
  CHECK(contains(refused(targets({"elbow"}, {1}, {})), "is driven by velocity"));
  CHECK(contains(refused(targets({"shoulder"}, {1.6}, {})), "out of range"));  // its limit is 1.5
  CHECK(contains(refused(targets({"shoulder"}, {kNan}, {})), "not finite"));
}

ros::JointTrajectory path(const std::vector<std::pair<std::int32_t, double>>& points) {
  ros::JointTrajectory message;
  message.joint_names = {"shoulder"};
  for (const auto& [seconds, position] : points) {
    ros::JointTrajectoryPoint& point = message.points.emplace_back();
    point.positions = {position};
    point.time_from_start.sec = seconds;
  }
  return message;
}

TEST_CASE("a trajectory is followed on lines from where the joint stands, and on curves with velocities") {
  const auto input = input_of<ros::JointTrajectory>("/path");
  MovingScene scene = commanded_arm("");
  scene.command(input, ros::encode(path({{1, 0.4}, {3, -0.4}})));
  const auto target = [&] { return glm::radians(scene.get("ROBOT", "target_shoulder")); };
  constexpr double kRounding = 1e-12;
  for (const auto& [time_s, expected] :
       {std::pair{0.5, 0.2}, std::pair{1.0, 0.4}, std::pair{2.0, 0.0}, std::pair{3.0, -0.4}, std::pair{9.0, -0.4}}) {
    scene.go_to(time_s);
    CHECK(std::abs(target() - expected) < kRounding);
  }
  ros::JointTrajectory curved = path({{0, -0.4}, {1, 0.4}});
  curved.points[0].velocities = {0};
  curved.points[1].velocities = {0};
  scene.command(input, ros::encode(curved));
  scene.go_to(9.25);
  // A cubic curve with both ends at rest: 3 s^2 - 2 s^3 of the way.
  CHECK(std::abs(target() - (-0.4 + 0.8 * (3.0 / 16 - 2.0 / 64))) < kRounding);
  scene.command(input, ros::encode(path({})));  // stop
  const double stands = glm::radians(scene.get("shoulder", "value"));
  scene.go_to(9.5);
  CHECK(std::abs(target() - stands) < kRounding);
}

TEST_CASE("trajectories that are no good are refused, and the one under way goes on") {
  const auto input = input_of<ros::JointTrajectory>("/path");
  MovingScene scene = commanded_arm("");
  scene.command(input, ros::encode(path({{2, 0.4}})));
  const auto refused = [&](const ros::JointTrajectory& message) {
    return error_of([&] { scene.command(input, ros::encode(message)); });
  };
  CHECK(contains(refused(path({{2, 0.1}, {1, 0.2}})), "not ascending"));
  CHECK(contains(refused(path({{-1, 0.1}})), "not ascending"));
  CHECK(contains(refused(path({{1, 0.1}, {2, 1.6}})), "out of range"));
  CHECK(contains(refused(path({{1, kNan}})), "not finite"));
  ros::JointTrajectory without = path({{1, 0}});
  without.points[0].positions.clear();
  CHECK(contains(refused(without), "expected values of that kind"));
  scene.go_to(1);
  CHECK(glm::radians(scene.get("ROBOT", "target_shoulder")) == doctest::Approx(0.2).epsilon(1e-12));
}

TEST_CASE("a trajectory whose curve cannot be computed is refused, and frames go on") {
  const auto input = input_of<ros::JointTrajectory>("/path");
  MovingScene scene = commanded_arm("");
  const auto refused = [&](double velocity, std::int32_t seconds) {
    ros::JointTrajectory message = path({{seconds, 0}, {seconds + 10, 0.1}});
    for (ros::JointTrajectoryPoint& point : message.points) point.velocities = {velocity};
    return error_of([&] { scene.command(input, ros::encode(message)); });
  };
  // Each is a finite number; 1e308 /s over 10 s is none.
  CHECK(contains(refused(1e308, 0), "joint \"shoulder\": the velocity 1e+308 over 10 s"));
  CHECK(contains(refused(-1e300, 1), "is out of range, expected a way of at most 1e+15"));
  scene.go_to(1);
  CHECK(refused(1e6, 0) == "nothing was thrown");
  // A curve that is steep is cut off at the joint's limits.
  scene.go_to(2);
  CHECK(glm::radians(scene.get("ROBOT", "target_shoulder")) == doctest::Approx(1.5).epsilon(1e-12));
}

TEST_CASE("an element whose settings are refused gives up, and the others go on") {
  class Failing : public CommandSource {
   public:
    std::vector<CommandTopic> command_topics() const override { return {}; }
    std::int64_t timeout_ns() const override { return 0; }
    std::vector<ParameterSetting> before_frame(std::int64_t, std::int64_t) override {
      if (gave_up) return {};
      return {{"MOVE", "x", 7}, {"MOVE", "y", kNan}};
    }
    void give_up() override { gave_up = true; }
    bool gave_up = false;
  };
  class Working : public Failing {
    std::vector<ParameterSetting> before_frame(std::int64_t, std::int64_t) override { return {{"MOVE", "z", 3}}; }
  };
  MovingScene scene("<element type='pose' name='MOVE' insert_at='ROOT'/>");
  Failing failing;
  Working working;
  CommandSource* const sources[] = {&failing, &working};
  follow_commands(sources, *scene, 0, 1);
  CHECK(failing.gave_up);
  CHECK(scene.get("MOVE", "x") == 0);
  CHECK(scene.get("MOVE", "z") == 3);
  REQUIRE((*scene).scene.warnings().size() == 1);
  CHECK(contains((*scene).scene.warnings()[0], "a command was given up: MOVE.y: nan"));
  follow_commands(sources, *scene, 1, 2);
  CHECK((*scene).scene.warnings().size() == 1);
}

TEST_CASE("joints that a replaced trajectory turns stop, unless the new one turns them") {
  const auto input = input_of<ros::JointTrajectory>("/path");
  const auto turn = [](std::int32_t stamp_s) {
    ros::JointTrajectory message;
    message.header.stamp.sec = stamp_s;
    message.joint_names = {"elbow"};
    for (const std::int32_t seconds : {0, 100}) {
      ros::JointTrajectoryPoint& point = message.points.emplace_back();
      point.velocities = {1};
      point.time_from_start.sec = seconds;
    }
    return ros::encode(message);
  };
  const auto start_turning = [&](MovingScene& scene) {
    scene.command(input, turn(0));
    scene.go_to(kFrame_s);
    REQUIRE(glm::radians(scene.get("ROBOT", "target_elbow")) == doctest::Approx(1).epsilon(1e-12));
  };
  const auto elbow = [](const MovingScene& scene) { return scene.get("ROBOT", "target_elbow"); };
  {
    MovingScene scene = commanded_arm("velocity_joints='elbow'");
    start_turning(scene);
    scene.command(input, ros::encode(path({{1, 0.4}})));  // of the shoulder alone
    scene.go_to(2 * kFrame_s);
    CHECK(elbow(scene) == 0);
    CHECK(scene.get("ROBOT", "target_shoulder") > 0);
  }
  {
    MovingScene scene = commanded_arm("velocity_joints='elbow'");
    start_turning(scene);
    scene.command(input_of<ros::JointState>("/targets"), ros::encode(targets({"shoulder"}, {0.5}, {})));
    scene.go_to(2 * kFrame_s);
    CHECK(elbow(scene) == 0);
  }
  {
    MovingScene scene = commanded_arm("velocity_joints='elbow'");
    start_turning(scene);
    scene.command(input_of<ros::JointState>("/targets"), ros::encode(targets({"elbow"}, {}, {-1})));
    scene.go_to(2 * kFrame_s);
    CHECK(glm::radians(elbow(scene)) == doctest::Approx(-1).epsilon(1e-12));
  }
  {
    MovingScene scene = commanded_arm("velocity_joints='elbow'");
    start_turning(scene);
    scene.go_to(0.9);
    scene.command(input, turn(1));  // it begins later
    scene.go_to(0.95);
    CHECK(elbow(scene) == 0);
    scene.go_to(1.1);
    CHECK(glm::radians(elbow(scene)) == doctest::Approx(1).epsilon(1e-12));
  }
}

/// Two arms that take targets on one topic, and trajectories on one each and on a common one. The elbow of A is driven
/// by velocity. The joints of B have B_ in front.
MovingScene two_arms() {
  const TemporaryFolder folder;
  std::string other = kArm;
  for (const std::string joint : {"name='shoulder'", "name='elbow'"}) other.replace(other.find(joint) + 6, 0, "B_");
  std::ofstream(folder.path() / "a.urdf") << kArm;
  std::ofstream(folder.path() / "b.urdf") << other;
  std::ofstream(folder.path() / "c.urdf") << kArm;
  std::string commands = physics("gravity='0 0 0'");
  const auto add = [&](const std::string& name, const std::string& offset, const std::string& file,
                       const std::string& control, const std::string& path_topic) {
    commands += "<part name='" + name + "' insert_at='ROOT' pose_offset='" + offset + "' file='" + file +
                "'/>\n<element type='robot' name='" + name + "_ROBOT' insert_at='" + name + "' " + control +
                "/>\n<element type='joint_command' name='" + name + "_COMMAND' insert_at='" + name + "' robot='" +
                name + "_ROBOT' topic='/targets' trajectory_topic='" + path_topic + "'/>\n";
  };
  add("A", "0 0 0 0 0 0", "a.urdf", "velocity_joints='elbow'", "/path");
  add("B", "0 2 0 0 0 0", "b.urdf", "", "/path");
  add("C", "0 4 0 0 0 0", "c.urdf", "", "/c_path");
  return MovingScene(commands, folder.path());
}

TEST_CASE("of several robots on a topic, those that have the joints take a message, all of them or none") {
  MovingScene scene = two_arms();
  scene.command(input_of<ros::JointTrajectory>("/path"), ros::encode(path({{2, 0.4}})));  // B has no such joint
  const std::vector<double> before = scene.values();
  // The elbow of A takes velocities, that of C positions.
  const auto state = input_of<ros::JointState>("/targets");
  CHECK(contains(error_of([&] { scene.command(state, ros::encode(targets({"elbow"}, {}, {1}))); }),
                 "joint \"elbow\" is driven by position"));
  CHECK(scene.values() == before);
  scene.go_to(1);
  CHECK(glm::radians(scene.get("A_ROBOT", "target_shoulder")) == doctest::Approx(0.2).epsilon(1e-12));
  CHECK(scene.get("B_ROBOT", "target_B_shoulder") == 0);
  scene.command(state, ros::encode(targets({"shoulder"}, {0.5}, {})));
  CHECK(glm::radians(scene.get("A_ROBOT", "target_shoulder")) == doctest::Approx(0.5).epsilon(1e-12));
  CHECK(glm::radians(scene.get("C_ROBOT", "target_shoulder")) == doctest::Approx(0.5).epsilon(1e-12));
  CHECK(scene.get("B_ROBOT", "target_B_shoulder") == 0);
  // Nobody has this one.
  CHECK(contains(error_of([&] { scene.command(state, ros::encode(targets({"hip"}, {0}, {}))); }),
                 "there is no driven joint \"hip\""));
  // A name that one robot lacks is a mistake for it.
  CHECK(contains(error_of([&] {
                   scene.command(state, ros::encode(targets({"shoulder", "hip"}, {0, 0}, {})));
                 }),
                 "there is no driven joint \"hip\""));
}

TEST_CASE("a message may exceed a joint's limit as far as the parameter may") {
  MovingScene scene = commanded_arm("");
  const auto limit_by = [&](double beyond_deg) {
    const double position = 1.5 + glm::radians(beyond_deg);
    return error_of([&] {
      scene.command(input_of<ros::JointState>("/targets"), ros::encode(targets({"shoulder"}, {position}, {})));
    });
  };
  constexpr double kAllowed_deg = 0.5e-3;  // the rounding of angles in a file, elements/joint.cpp
  CHECK(limit_by(kAllowed_deg * 0.9) == "nothing was thrown");
  CHECK(scene.get("ROBOT", "target_shoulder") == glm::degrees(1.5));
  CHECK(contains(limit_by(kAllowed_deg * 1.1), "out of range"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
