// The effect `sweep_motion`: ranges of a scanner that moves past walls or towards them and turns, compared with the
// closed form, and the times of its beams in memory and in the CSV file.
#include "effects/scanner/sweep_motion.h"

#include <doctest/doctest.h>

#include <fstream>
#include <random>

#include "program/output/output_writer.h"
#include "tests/support/element_scene.h"
#include "tests/support/reference_directions.h"
#include "tests/support/traced_beams.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr std::uint32_t kSweepBeams = 181;
constexpr double kSweep_s = 0.05, kInterval_s = 0.0625;

std::vector<glm::dvec3> fan(std::uint32_t rings = 1) {
  std::vector<glm::dvec3> directions;
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t beam = 0; beam < kSweepBeams; ++beam) {
      const double a = glm::radians(static_cast<double>(beam) - 90), e = 0.1 * ring;
      directions.push_back(reference::beam_direction(a, e));
    }
  }
  return directions;
}

ScanContext moment_from(const glm::dmat4& before, const glm::dmat4& now, std::uint32_t rings = 1) {
  ScanContext moment = moment_of(kSweepBeams);
  moment.rings = rings;
  moment.time.time_ns = 1'000'000'000;
  moment.world_from_sensor = now;
  moment.before = PastPose{1'000'000'000 - 62'500'000, before};
  return moment;
}

/// Age of a beam's pose as a share of the interval.
double share_back(std::uint32_t beam, bool clockwise, double sweep_s = kSweep_s) {
  const std::uint32_t after = clockwise ? beam : kSweepBeams - 1 - beam;
  return sweep_s * after / (kSweepBeams - 1) / kInterval_s;
}

/// Rodrigues' formula: a rotation about a unit axis.
glm::dmat3 turned(const glm::dvec3& axis, double angle) {
  glm::dmat3 m;
  for (int c = 0; c < 3; ++c) {
    glm::dvec3 e(0);
    e[c] = 1;
    m[c] = e * std::cos(angle) + glm::cross(axis, e) * std::sin(angle) +
           axis * (glm::dot(axis, e) * (1 - std::cos(angle)));
  }
  return m;
}

glm::dmat4 pose(const glm::dmat3& turn, const glm::dvec3& place) {
  glm::dmat4 m(turn);
  m[3] = glm::dvec4(place, 1);
  return m;
}

/// A square with this normal, large enough to all sides, at a distance from `centre`.
DrawList wall(const glm::dvec3& normal, double distance_m, const glm::dvec3& centre) {
  const glm::dvec3 up = glm::normalize(glm::cross(normal, glm::dvec3(0.3, -0.5, 0.8))), side = glm::cross(normal, up);
  DrawList list;
  add_item(list, plate_mesh(0, {-200, -200}, {200, 200}),
           pose(glm::dmat3(normal, side, up), centre + distance_m * normal));
  return list;
}

std::shared_ptr<RayCaster> a_caster() { return make_host_ray_caster(); }

/// A constant motion in the frame of the sensor.
struct Motion {
  std::string what;
  glm::dvec3 velocity_m_s, turn_axis;
  double turn_rad_s;

  /// The way of the last seconds with the axes of the sensor at their end: the integral of the velocity, turned back by
  /// Rodrigues' formula, over these seconds.
  glm::dvec3 way_m(double seconds) const {
    if (turn_rad_s == 0) return seconds * velocity_m_s;
    const glm::dvec3 along = turn_axis * glm::dot(turn_axis, velocity_m_s), across = velocity_m_s - along;
    const double angle = turn_rad_s * seconds;
    return seconds * along +
           (std::sin(angle) * across - (1 - std::cos(angle)) * glm::cross(turn_axis, velocity_m_s)) / turn_rad_s;
  }
};

TEST_CASE("ranges of a scanner that drives and turns in front of a wall have the closed form within their bounds") {
  const Motion motions[] = {{"stands", {0, 0, 0}, {0, 0, 1}, 0},
                            {"towards", {20, 0, 0}, {0, 0, 1}, 0},
                            {"past", {0, -15, 0.5}, {0, 0, 1}, 0},
                            {"turns", {0, 0, 0}, {0, 0, 1}, 3},
                            {"all", {12, 5, -1}, glm::normalize(glm::dvec3(0.2, -0.4, 0.9)), -4}};
  const std::shared_ptr<RayCaster> caster = a_caster();
  const std::vector<glm::dvec3> directions = fan();
  double worst_use = 0;
  for (const double offset_m : {0.0, 1e3, 1e6}) {
    for (const Motion& motion : motions) {
      for (const bool clockwise : {false, true}) {
        // The last period is longer than the interval between two measurements.
        for (const double sweep_s : {kSweep_s, 1.5 * kInterval_s}) {
          CAPTURE(offset_m);
          CAPTURE(motion.what);
          CAPTURE(clockwise);
          const glm::dvec3 place = offset_m * glm::dvec3(0.6, -0.8, 0.01);
          const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 0.3, 0.05));
          const DrawList list = wall(normal, 7, place);
          const glm::dmat3 turn = turned(glm::normalize(glm::dvec3(1, 2, 3)), 0.2);
          const auto pose_back = [&](double share) {
            return pose(turn * turned(motion.turn_axis, -motion.turn_rad_s * kInterval_s * share),
                        place - turn * motion.way_m(share * kInterval_s));
          };
          const ScanContext moment = moment_from(pose_back(1), pose_back(0));
          const std::vector<Echo> echoes = trace(
              list, directions, {std::make_shared<SweepMotion>(FiringTimes(sweep_s, clockwise))}, moment, *caster);
          std::size_t met = 0;
          for (std::uint32_t beam = 0; beam < kSweepBeams; ++beam) {
            const double back = share_back(beam, clockwise, sweep_s);
            const glm::dmat4 then = pose_back(back);
            const double cosine = glm::dot(normal, glm::dmat3(then) * directions[beam]);
            if (cosine < 0.05) continue;  // the wall has a limited size
            // From places relative to the sensor, which have no rounding of 10^6 m.
            const double expected_m = (7 + glm::dot(normal, turn * motion.way_m(back * kInterval_s))) / cosine;
            // Rounding of the test's own places and rotations, which the sensor gets as doubles.
            const double given_m = (8 * 0x1p-53 * offset_m + 64 * 0x1p-53 * expected_m) / cosine;
            const double error_m = std::abs(echoes[beam].range_m - expected_m);
            worst_use = std::max(worst_use, error_m / (echoes[beam].error_bound_m + given_m));
            REQUIRE(error_m <= echoes[beam].error_bound_m + given_m);
            // The bound is not needlessly large: 42 u of the offset in the caster, 12 u for origins, and the need of
            // 200 m of wall.
            REQUIRE(echoes[beam].error_bound_m <= 64 * 0x1p-53 * (offset_m + 500) / cosine);
            ++met;
          }
          CHECK(met > 100);
        }
      }
    }
  }
  MESSAGE("error at most " << worst_use << " of the bound and the test's rounding");
}

TEST_CASE(
    "the first scan is static; the last beam leaves at the pose of the frame; beams of one azimuth leave together") {
  const std::vector<glm::dvec3> directions = fan(2);
  const DrawList list = wall({1, 0, 0}, 7, {0, 0, 0});
  const std::shared_ptr<RayCaster> caster = a_caster();
  const glm::dmat4 before = pose(glm::dmat3(1), {-1, 0, 0});
  ScanContext moment = moment_from(before, glm::dmat4(1), 2);
  const std::vector<Echo> still = trace(list, directions, {std::make_shared<Probe>()}, moment, *caster);
  const auto probe = std::make_shared<Probe>();
  const std::vector<Echo> moving =
      trace(list, directions, {std::make_shared<SweepMotion>(FiringTimes(kSweep_s, false)), probe}, moment, *caster);
  CHECK(moving[kSweepBeams - 1].range_m == still[kSweepBeams - 1].range_m);
  CHECK(moving[kSweepBeams / 2].range_m > still[kSweepBeams / 2].range_m + 0.3);
  REQUIRE(probe->rays.size() == directions.size());
  for (std::size_t i = 0; i < probe->rays.size(); i += 2) {
    CHECK(probe->rays[i].beam + kSweepBeams == probe->rays[i + 1].beam);
    CHECK(probe->rays[i].origin_m == probe->rays[i + 1].origin_m);
  }
  moment.before.reset();
  const std::vector<Echo> first =
      trace(list, directions, {std::make_shared<SweepMotion>(FiringTimes(kSweep_s, false))}, moment, *caster);
  for (std::size_t i = 0; i < first.size(); ++i) REQUIRE(first[i].range_m == still[i].range_m);
}

std::string slurp(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_CASE("in a simulation: ranges of a robot that drives towards a wall, and the time of each beam in the CSV file") {
  test::GltfBuilder file;
  test::add_plate(file, {}, file.append("materials", test::unlit("Wall", {1, 1, 1, 1})));
  test::World world({{"wall.gltf", file}}, R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>
    <element type="pose" name="P" insert_at="ROOT"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" min_angle="-40" max_angle="40"
            sweep="0.04" sweep_direction="cw"/>
    <sensor type="laser_scanner" name="STILL" insert_at="ROOT" samples="5" min_angle="-40" max_angle="40"
            method="raycast"/>)");
  TemporaryFolder folder;
  const std::vector<std::string> names{"SCAN", "STILL"};
  OutputWriter writer({.folder = folder.path(), .sensors = names});
  for (int frame = 0; frame < 2; ++frame) {
    const FrameTime time = world->next_frame();
    world->set("P", "x", frame);
    world->step();
    for (const std::string& name : names) writer.write(name, time, glm::dmat4(1), world->measurement(name));
    const Scan &scan = world->scan("SCAN"), &still = world->scan("STILL");
    const SharedNumbers<double> times = scan.channel("time_s");
    REQUIRE(times.size() == 5);
    for (std::size_t beam = 0; beam < 5; ++beam) {
      // 15 frames per second. With a clockwise sweep the last beam leaves first.
      const double age_s = 0.04 * static_cast<double>(beam) / 4, end_s = frame / 15.0;
      CHECK(std::abs(times[beam] - (end_s - age_s)) <= 1e-9);  // frames have times of whole nanoseconds
      const double cosine = std::cos(glm::radians(-40 + 20.0 * static_cast<double>(beam)));
      const double expected_m = (4 - frame + (frame == 0 ? 0 : age_s * 15)) / cosine;
      // A period of 1/15 s in whole nanoseconds: 10^-8 of it. Then the resolution of float32.
      CHECK(std::abs(scan.range_m[beam] - expected_m) <= scan.error_bound_m[beam] + 1e-8);
      if (frame == 0) CHECK(scan.range_m[beam] == still.range_m[beam]);
    }
  }
  writer.finish();
  const std::string csv = slurp(folder / "SCAN.csv"), plain = slurp(folder / "STILL.csv");
  CHECK(csv.substr(0, csv.find('\n')) == plain.substr(0, plain.find('\n')));
  CHECK(contains(csv, "\n1,0.066666667,0,0,"));
  CHECK(contains(csv, "\n1,0.056666667,0,1,"));
  CHECK(contains(csv, "\n1,0.026666667,0,4,"));
  CHECK(contains(csv, "\n0,-0.040000000,0,4,"));
  CHECK(contains(plain, "\n1,0.066666667,0,4,"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
