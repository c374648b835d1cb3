// Ids, ranges, normals and coordinates of pixels, and columns of scanners, against exact rays through the centres of
// the pixels.
#include "sensors/camera/pixel_truth.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include <simvis/diagnostics.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include <simvis/surface_point.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// Vertices are snapped to 1/256 of a pixel: each moves by at most half of that along each axis, so an edge moves by at
// most as much. Twice that leaves room for the rounding of positions to float32.
constexpr double kEdge_px = 1.0 / 256;

// Two float32 roundings, of a depth and of a range or of a coordinate.
constexpr double kStoredTwice = 0x1p-23;

constexpr int kWidth = 96, kHeight = 72;

// Closed shapes, so that no ray from outside meets a back face: a floor, a wall, things before it, one that moves.
const std::string kThings = R"(
  <part name="FLOOR" insert_at="ROOT" shape="box" size="20 20 0.2" pose_offset="0 0 -0.6 0 0 0"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.2 9 3" pose_offset="6 0 1 0 0 10"/>
  <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.5" pose_offset="3 0.4 0 0 0 0"/>
  <part name="ROD" insert_at="ROOT" shape="cylinder" radius="0.02" length="2" pose_offset="2.5 -0.6 0.3 20 0 0"/>
  <part name="FRAME" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="FRAME"/>
  <part name="CRATE" insert_at="FRAME" shape="box" size="0.6 0.6 0.6" pose_offset="4 -0.8 0 0 0 30"/>
  <part name="CAR" insert_at="ROOT"/>
  <element type="pose" name="DRIVE" insert_at="CAR"/>
  <element type="label" name="L1" insert_at="ROOT" part="BALL" class="ball" class_id="3"/>
  <element type="label" name="L2" insert_at="ROOT" parts="*R*A*" class="box" class_id="5"/>
  <element type="label" name="L3" insert_at="ROOT" part="FLOOR" class="ground" class_id="1"/>
)";
const std::string kDrawn = "instance semantic range object_coordinates depth depth_error_bound",
                  kCast = "normal " + kDrawn;

std::string camera(const std::string& outputs, const std::string& more = "", const char* type = "camera") {
  return "<sensor type='" + std::string(type) + "' name='CAM' insert_at='CAR' width='" + std::to_string(kWidth) +
         "' height='" + std::to_string(kHeight) + "' hfov='70' outputs='" + outputs + "' " + more + "/>";
}
Simulation simulation_of(const std::string& commands) {
  return Simulation::from_string("<simvis>" + kThings + commands + "</simvis>");
}

/// The numbers of an output, which it must have.
std::vector<double> numbers(const Measurement& measurement, const std::string& name) {
  const MeasuredArray* const array = measurement.find(name);
  REQUIRE_MESSAGE(array != nullptr, name);
  std::vector<double> all;
  for (std::size_t i = 0; i < array->count(); ++i) all.push_back(array->number(i));
  return all;
}

struct SeenByRay {
  RayHit hit;
  std::uint32_t instance = 0, semantic = 0;
  glm::dvec3 normal{0}, in_mesh{0};
};

/// What rays of a view meet in a list.
class RayReference {
 public:
  RayReference(const Simulation& simulation, DrawList list)
      : items_(simulation.items()), list_(std::move(list)), caster_(make_host_ray_caster()) {
    caster_->set_world(list_);
  }

  std::vector<SeenByRay> cast(const glm::dmat4& world_from_view, const std::vector<glm::dvec3>& directions) {
    std::vector<RayHit> hits(directions.size());
    caster_->cast(world_from_view, directions, hits);
    std::vector<SeenByRay> seen;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      SeenByRay& each = seen.emplace_back(SeenByRay{.hit = hits[i]});
      if (std::isinf(hits[i].range_m)) continue;
      each.instance = items_[hits[i].item].instance;
      each.semantic = items_[hits[i].item].semantic;
      each.normal = surface_point(list_, world_from_view, directions[i], hits[i]).normal;
      const glm::dmat4& world_from_mesh = list_.world_from_node[list_.items[hits[i].item].transform];
      each.in_mesh =
          glm::dvec3(glm::inverse(world_from_mesh) * world_from_view * glm::dvec4(hits[i].range_m * directions[i], 1));
    }
    return seen;
  }

 private:
  std::vector<SceneItem> items_;
  DrawList list_;
  std::unique_ptr<RayCaster> caster_;
};

/// Rays through points of the image of a pinhole camera with hfov="70".
glm::dvec3 pinhole_ray(double x_px, double y_px) {
  const double f_px = kWidth / 2.0 / std::tan(35 * std::numbers::pi / 180);
  return glm::normalize(glm::dvec3((x_px - kWidth / 2.0) / f_px, (y_px - kHeight / 2.0) / f_px, 1));
}

struct Image2 {
  int first_row = 0, rows = kHeight;
};

struct Comparison {
  int pixels = 0, edges = 0, sky = 0, narrow = 0;
};

// Compares the pixels of some rows. `prefix` as in the names of outputs. If pixels are `drawn`, one whose instance is
// not that of the ray counts as an edge, and the instance must be met within kEdge_px of its centre.
template <typename RayOf>
void compare(const Measurement& measurement, const std::string& prefix, const RayOf& ray_of, RayReference& reference,
             const glm::dmat4& world_from_view, const Image2& part, bool drawn, Comparison& compared) {
  const std::vector<double> instance = numbers(measurement, prefix + "instance"),
                            semantic = numbers(measurement, prefix + "semantic"),
                            range = numbers(measurement, prefix + "range"),
                            in_mesh = numbers(measurement, prefix + "object_coordinates"),
                            depth = numbers(measurement, prefix + "depth"),
                            bound = numbers(measurement, prefix + "depth_error_bound");
  const std::vector<double> normal = drawn ? std::vector<double>() : numbers(measurement, prefix + "normal");
  const std::size_t first = std::size_t(part.first_row) * kWidth, end = first + std::size_t(part.rows) * kWidth;
  const auto at = [&](std::size_t pixel, double dx, double dy) {
    return ray_of(static_cast<double>(pixel % kWidth) + 0.5 + dx, static_cast<double>(pixel / kWidth) + 0.5 + dy);
  };
  std::vector<glm::dvec3> directions;
  for (std::size_t pixel = first; pixel < end; ++pixel) directions.push_back(at(pixel, 0, 0));
  const std::vector<SeenByRay> seen = reference.cast(world_from_view, directions);
  REQUIRE(instance.size() == std::size_t{kWidth} * kHeight);
  for (std::size_t pixel = first; pixel < end; ++pixel) {
    const SeenByRay& expected = seen[pixel - first];
    const glm::dvec3& direction = directions[pixel - first];
    ++compared.pixels;
    const auto around = [&] {
      std::vector<glm::dvec3> all;
      for (int k = 0; k < 8; ++k) {
        const double angle = k * std::numbers::pi / 4, reach_px = kEdge_px * std::numbers::sqrt2;
        all.push_back(at(pixel, reach_px * std::cos(angle), reach_px * std::sin(angle)));
      }
      return reference.cast(world_from_view, all);
    };
    if (drawn && instance[pixel] != expected.instance) {
      CHECK(std::ranges::any_of(around(), [&](const SeenByRay& each) { return each.instance == instance[pixel]; }));
      ++compared.edges;
      continue;
    }
    CHECK(instance[pixel] == expected.instance);
    CHECK(semantic[pixel] == expected.semantic);
    if (expected.instance == 0) {
      ++compared.sky;
      CHECK(std::isinf(range[pixel]));
      CHECK(std::isinf(bound[pixel]));
      for (std::size_t c = 0; c < 3; ++c) CHECK(std::isnan(in_mesh[3 * pixel + c]));
      for (std::size_t c = 0; c < 3 && !drawn; ++c) CHECK(std::isnan(normal[3 * pixel + c]));
      continue;
    }
    // Drawn ranges follow from depths within their bound; cast ones are rounded once.
    const double along = expected.hit.range_m, from_depth = bound[pixel] / std::abs(direction.z);
    if (drawn && std::isinf(from_depth)) continue;
    const double tolerance_m = drawn ? from_depth + kStoredTwice * along : 0;
    // The bound holds for surfaces that are flat over three pixels, which the rod and the facets of the ball are not.
    // There the drawn surface is displaced by at most the snapping.
    if (drawn && std::abs(range[pixel] - along) > tolerance_m) {
      double spread_m = 0;
      for (const SeenByRay& each : around()) {
        if (each.instance == instance[pixel]) spread_m = std::max(spread_m, std::abs(each.hit.range_m - along));
      }
      CHECK(std::abs(range[pixel] - along) <= tolerance_m + spread_m);
      ++compared.narrow;
      continue;
    }
    if (drawn) CHECK(std::abs(range[pixel] - along) <= tolerance_m);
    if (!drawn) CHECK(range[pixel] == static_cast<float>(along));
    CHECK(std::abs(depth[pixel] - along * direction.z) <= bound[pixel]);
    for (int c = 0; c < 3; ++c) {
      const std::size_t number = 3 * pixel + static_cast<std::size_t>(c);
      CHECK(std::abs(in_mesh[number] - expected.in_mesh[c]) <= tolerance_m + kStoredTwice * (along + 20));
      if (!drawn) CHECK(std::abs(normal[number] - expected.normal[c]) <= kStoredTwice);
    }
  }
}

glm::dmat4 world_from_camera(const Simulation& simulation) {
  glm::dmat4 world_from_sensor;
  simulation.sensor_pose("CAM", world_from_sensor);
  return world_from_sensor * sensor_from_view();
}

/// One image whose pixels all see one moment.
Comparison compare_whole(Simulation& simulation, bool drawn) {
  RayReference reference(simulation, simulation.diagnostics().draw_list());
  Comparison compared;
  compare(simulation.measurement("CAM"), "", pinhole_ray, reference, world_from_camera(simulation), {}, drawn,
          compared);
  CHECK(simulation.diagnostics().validation_messages() == 0);
  return compared;
}

void require_edges_are_few(const Comparison& compared) {
  CHECK(compared.pixels == kWidth * kHeight);
  CHECK(compared.sky > 0);
  CHECK(compared.sky < compared.pixels / 2);
  MESSAGE(compared.edges << " of " << compared.pixels << " pixels lie on edges");
  CHECK(compared.edges <= compared.pixels / 256);  // as if every pixel had an edge
  CHECK(compared.narrow <= compared.pixels / 256);
}

TEST_CASE("the truth of a pinhole camera is what rays through the pixels' centres meet") {
  for (const bool drawn : {true, false}) {
    Simulation simulation = simulation_of(camera("color " + (drawn ? kDrawn : kCast)));
    for (const double yaw_deg : {0.0, 7.3, -11.9}) {
      simulation.set("DRIVE", "yaw", yaw_deg);
      simulation.step();
      const Comparison compared = compare_whole(simulation, drawn);
      require_edges_are_few(compared);
      if (!drawn) CHECK(compared.edges == 0);
    }
  }
}

TEST_CASE("samples of colour and coarser levels change no truth") {
  const auto truth = [](const std::string& more) {
    Simulation simulation = simulation_of(camera("color " + kDrawn, more));
    simulation.step();
    std::vector<double> all;
    for (const char* const name : {"instance", "semantic", "range", "depth"}) {
      for (const double number : numbers(simulation.measurement("CAM"), name)) all.push_back(number);
    }
    return all;
  };
  const std::vector<double> plain = truth("");
  CHECK(plain.size() == 4 * kWidth * kHeight);
  CHECK(truth("supersampling='16'") == plain);
  CHECK(truth("msaa='4'") == plain);
  CHECK(truth("max_error_px='1'") == plain);
}

TEST_CASE("the truth through a lens is cast and exact") {
  // Equidistant: the angle from the axis is the distance from the middle over the focal length.
  constexpr double kFocal_px = 30;
  const auto ray = [](double x_px, double y_px) {
    const glm::dvec2 off((x_px - kWidth / 2.0) / kFocal_px, (y_px - kHeight / 2.0) / kFocal_px);
    const double angle = glm::length(off);
    if (angle == 0) return glm::dvec3(0, 0, 1);
    return glm::dvec3(std::sin(angle) / angle * off, std::cos(angle));
  };
  Simulation simulation = simulation_of(camera(kCast, "distortion='kannala_brandt' fx='30'"));
  simulation.step();
  const Measurement measurement = simulation.measurement("CAM");
  // The camera's own rays are those of the formula to 1e-9 pixels, so ranges differ by their slope over the image.
  RayReference reference(simulation, simulation.diagnostics().draw_list());
  const std::vector<double> instance = numbers(measurement, "instance"), range = numbers(measurement, "range"),
                            normal = numbers(measurement, "normal");
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < kWidth * kHeight; ++i) directions.push_back(ray(i % kWidth + 0.5, i / kWidth + 0.5));
  const std::vector<SeenByRay> seen = reference.cast(world_from_camera(simulation), directions);
  int met = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (std::acos(directions[i].z) > 110 * std::numbers::pi / 180) {  // beyond what a fisheye shows
      CHECK(instance[i] == 0);
      continue;
    }
    CHECK(instance[i] == seen[i].instance);
    if (seen[i].instance == 0) continue;
    ++met;
    const double cosine = -glm::dot(seen[i].normal, directions[i]);
    const double slope_m = 1e-9 / kFocal_px * seen[i].hit.range_m / cosine;
    CHECK(std::abs(range[i] - seen[i].hit.range_m) <= slope_m + kStoredTwice * seen[i].hit.range_m);
    for (int c = 0; c < 3; ++c) {
      CHECK(std::abs(normal[3 * i + static_cast<std::size_t>(c)] - seen[i].normal[c]) <= kStoredTwice);
    }
  }
  CHECK(met > kWidth * kHeight / 3);
  CHECK(met < kWidth * kHeight);
}

TEST_CASE("rows of a rolling shutter have the truth of their own time, of the camera and of things") {
  constexpr double kRowTime_s = 0.0005;
  constexpr int kRowsPerPose = 12;
  for (const bool drawn : {true, false}) {
    Simulation simulation = simulation_of(
        camera(drawn ? kDrawn : kCast, "row_time='0.0005' rows_per_pose='" + std::to_string(kRowsPerPose) + "'"));
    simulation.step(std::chrono::milliseconds(100));
    // From frame to frame the car drives 0.2 m ahead, and the crate's frame 0.5 m to the left.
    simulation.set("DRIVE", "x", 0.2);
    simulation.set("MOVE", "y", 0.5);
    simulation.step(std::chrono::milliseconds(100));
    const Measurement measurement = simulation.measurement("CAM");
    const std::vector<SceneItem> items = simulation.items();
    const auto crate = static_cast<std::size_t>(std::ranges::find(items, "CRATE", &SceneItem::part) - items.begin());
    Comparison compared;
    for (int first = 0; first < kHeight; first += kRowsPerPose) {
      const double time_s = (first + (kRowsPerPose - 1) / 2.0 - (kHeight - 1)) * kRowTime_s, share = time_s / 0.1;
      DrawList list = simulation.diagnostics().draw_list();
      list.items[crate].transform = static_cast<std::uint32_t>(list.world_from_node.size());
      list.world_from_node.push_back(glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0.5 * share, 0)) *
                                     simulation.diagnostics()
                                         .draw_list()
                                         .world_from_node[simulation.diagnostics().draw_list().items[crate].transform]);
      RayReference reference(simulation, std::move(list));
      const glm::dmat4 world_from_view =
          glm::translate(glm::dmat4(1.0), glm::dvec3(0.2 * share, 0, 0)) * world_from_camera(simulation);
      compare(measurement, "", pinhole_ray, reference, world_from_view, {first, kRowsPerPose}, drawn, compared);
    }
    require_edges_are_few(compared);
  }
}

TEST_CASE("both views of a stereo camera have truth, drawn or cast, and the same disparity") {
  std::vector<double> disparities[2];
  for (const bool drawn : {true, false}) {
    Simulation simulation =
        simulation_of(camera("disparity " + (drawn ? kDrawn : kCast), "baseline='0.3'", "stereo_camera"));
    simulation.step();
    RayReference reference(simulation, simulation.diagnostics().draw_list());
    const Measurement measurement = simulation.measurement("CAM");
    for (const bool right : {false, true}) {
      Comparison compared;
      const glm::dmat4 world_from_view =
          glm::translate(world_from_camera(simulation), glm::dvec3(right ? 0.3 : 0, 0, 0));
      compare(measurement, right ? "right_" : "left_", pinhole_ray, reference, world_from_view, {}, drawn, compared);
      require_edges_are_few(compared);
    }
    disparities[drawn ? 0 : 1] = numbers(measurement, "disparity");
  }
  REQUIRE(disparities[0].size() == disparities[1].size());
  int differ = 0;
  for (std::size_t i = 0; i < disparities[0].size(); ++i) {
    // The drawn ball lies up to 0.28 % of its radius of 0.5 m inside the cast one, at 2.5 m or more: fx b / Z^2 dZ =
    // 68.6 * 0.3 / 2.5^2 * 0.0014 = 0.005 pixels.
    differ += std::abs(disparities[0][i] - disparities[1][i]) > 0.01;
  }
  CHECK(differ <= kWidth * kHeight / 256);
}

TEST_CASE("a scanner gives the ids of the camera, normals and velocities of what its beams meet") {
  Simulation simulation = simulation_of(
      camera(kDrawn) +
      "<sensor type='laser_scanner' name='SCAN' insert_at='CAR' samples='101' vertical_samples='3' min_angle='-30' "
      "max_angle='30' vertical_min_angle='-15' vertical_max_angle='10' "
      "truth='hit range instance semantic normal velocity'/>");
  simulation.step(std::chrono::milliseconds(100));
  simulation.set("MOVE", "y", 0.05);
  simulation.step(std::chrono::milliseconds(100));
  const Scan& scan = simulation.scan("SCAN");
  const std::vector<SceneItem> items = simulation.items();
  const DrawList& list = simulation.diagnostics().draw_list();
  const auto value = [&](const char* channel, std::size_t beam) {
    REQUIRE_MESSAGE(scan.channel(channel) != nullptr, channel);
    return scan.channel(channel)->values[beam];
  };
  std::set<double> ids;
  int met = 0, moving = 0;
  for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
    if (std::isinf(value("true_range_m", beam))) {
      CHECK(std::isnan(value("true_instance", beam)));
      CHECK(std::isnan(value("true_normal_x", beam)));
      continue;
    }
    ++met;
    const auto number = static_cast<std::uint32_t>(value("true_item", beam));
    const SceneItem& item = items.at(number);
    CHECK(value("true_instance", beam) == item.instance);
    CHECK(value("true_semantic", beam) == item.semantic);
    ids.insert(value("true_instance", beam));
    const glm::dvec3 direction =
        beam_direction(scan.azimuth_rad[beam % scan.beams], scan.elevation_rad[beam / scan.beams]);
    const RayHit hit{.range_m = value("true_range_m", beam),
                     .item = number,
                     .primitive = static_cast<std::uint32_t>(value("true_primitive", beam))};
    const glm::dvec3 normal = surface_point(list, scan.world_from_sensor, direction, hit).normal;
    CHECK(glm::dvec3(value("true_normal_x", beam), value("true_normal_y", beam), value("true_normal_z", beam)) ==
          normal);
    // The crate's frame has moved 0.05 m in 0.1 s, and nothing else has.
    const glm::dvec3 velocity(value("true_velocity_x_mps", beam), value("true_velocity_y_mps", beam),
                              value("true_velocity_z_mps", beam));
    const bool moves = item.part == "CRATE";
    moving += moves;
    constexpr double kVelocityRounding_mps = 10 * 0x1p-53 * 10 / 0.1;  // see scenegraph/motion.h: 10 m, 0.1 s
    CHECK(glm::distance(velocity, glm::dvec3(0, moves ? 0.5 : 0, 0)) <= kVelocityRounding_mps);
  }
  CHECK(met > 100);
  CHECK(moving > 0);
  const std::vector<double> pixels = numbers(simulation.measurement("CAM"), "instance");
  for (const double id : ids) CHECK(std::ranges::count(pixels, id) > 0);
  CHECK(ids.size() >= 3);
}

TEST_CASE("ids stay over frames, commands and other sensors") {
  Simulation simulation = simulation_of(camera("instance"));
  simulation.step();
  const std::vector<double> before = numbers(simulation.measurement("CAM"), "instance");
  CHECK(std::set<double>(before.begin(), before.end()).size() == 6);  // five things and the sky
  simulation.execute("<part name='A' insert_at='ROOT' shape='sphere' radius='1' pose_offset='-9 0 0 0 0 0'/>");
  simulation.execute("<remove kind='part' name='A'/>");
  simulation.step();
  CHECK(numbers(simulation.measurement("CAM"), "instance") == before);
  simulation.execute("<remove kind='element' name='L1'/><remove kind='part' name='BALL'/>");
  simulation.step();
  const std::vector<double> without = numbers(simulation.measurement("CAM"), "instance");
  int revealed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) revealed += without[i] != before[i];
  CHECK(revealed > 0);
  const std::set<double> now(without.begin(), without.end()), then(before.begin(), before.end());
  CHECK(std::ranges::includes(then, now));
  CHECK(now.size() == 5);
}

TEST_CASE("truth that is not asked for costs nothing, and labels alone change no byte") {
  const auto work = [](const std::string& commands) {
    Simulation simulation = Simulation::from_string("<simvis>" + commands + "</simvis>");
    simulation.step();
    simulation.step();
    const Diagnostics diagnostics = simulation.diagnostics();
    return std::tuple(diagnostics.counters(), diagnostics.ray_counters().rays, diagnostics.motions_followed(),
                      diagnostics.device_memory_bytes(), numbers(simulation.measurement("CAM"), "color"));
  };
  std::string unlabelled = kThings;
  for (std::size_t at = 0; (at = unlabelled.find("<element type=\"label\"")) != std::string::npos;) {
    unlabelled.erase(at, unlabelled.find("/>", at) + 2 - at);
  }
  CHECK(work(unlabelled + camera("color depth")) == work(kThings + camera("color depth")));
  // Ranges come with depth from the pass of colour: no pass, no pixel and no ray more.
  const auto depth = work(kThings + camera("color depth")), range = work(kThings + camera("color depth range"));
  CHECK(depth == range);
  // Ids come from it too. Only the outlines of the round shapes are cast.
  const auto ids = work(kThings + camera("color depth range instance semantic"));
  CHECK(std::get<0>(ids).passes == std::get<0>(depth).passes);
  CHECK(std::get<0>(ids).bytes_read_back == std::get<0>(depth).bytes_read_back);
  CHECK(std::get<1>(depth) == 0);
  CHECK(std::get<1>(ids) > 0);
  CHECK(std::get<1>(ids) < kWidth * kHeight / 4);
  std::string flat = kThings;
  for (const char* const name : {"BALL", "ROD"}) {
    const std::size_t at = flat.find("<part name=\"" + std::string(name));
    flat.erase(at, flat.find("/>", at) + 2 - at);
  }
  flat.erase(flat.find("<element type=\"label\" name=\"L1\""));
  CHECK(std::get<1>(work(flat + camera("color depth range instance semantic"))) == 0);
}

TEST_CASE("truth that a sensor cannot give is an error at its place") {
  const auto error = [](const std::string& command) {
    return error_of(
        [&] { Simulation::from_string("<simvis>" + kThings + "\n" + command + "</simvis>", {}, ".", "s"); });
  };
  CHECK(contains(error("<sensor type='camera' name='C' insert_at='CAR' view='visualization' outputs='instance'/>"),
                 ": error: attribute \"outputs\": a camera that sees what is drawn for people only gives color and "
                 "depth"));
  CHECK(contains(error("<sensor type='camera' name='C' insert_at='CAR' outputs='color depth_error_bound'/>"),
                 ": error: attribute \"outputs\": depth_error_bound needs depth, expected both"));
  CHECK(contains(error("<sensor type='camera' name='C' insert_at='CAR' outputs='instances'/>"), "instance"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
