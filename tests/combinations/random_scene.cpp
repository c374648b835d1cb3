#include "tests/combinations/random_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tests/combinations/exact_world.h"
#include "tests/support/random_numbers.h"

namespace simvis::combined {
namespace {

constexpr const char* kWideBeams =
    "type='laser_scanner' samples='31' divergence='0.5' divergence_samples='8' intensity='on' return='dual' "
    "range_noise='0.01'";
/// The event camera is the last one.
const char* const kOtherSensors[] = {"type='sonar' rays='64'",
                                     "type='radar' angle_step='5'",
                                     "type='psd'",
                                     "type='rgbd_camera' width='16' height='12' outputs='color depth'",
                                     "type='tof_camera' width='16' height='12'",
                                     "type='thermal_camera' width='16' height='12'",
                                     "type='imu' gyroscope_stddev='0.01'",
                                     "type='gnss' horizontal_stddev='1'",
                                     "type='odometry' kind='wheel' wheel_separation='0.4' slip_stddev='0.05'",
                                     kWideBeams,
                                     "type='event_camera' width='12' height='9'"};

/// Draws the numbers of a scene.
class SceneDraw {
 public:
  explicit SceneDraw(std::uint64_t seed) : random_(seed) {}

  double between(double low, double high) {
    constexpr std::uint64_t kSteps = std::uint64_t{1} << 40;
    return low + (high - low) * static_cast<double>(random_.below(kSteps)) / static_cast<double>(kSteps);
  }
  double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool one_in(std::uint64_t number) { return random_.below(number) == 0; }
  std::size_t below(std::size_t end) { return random_.below(end); }
  template <class T, std::size_t N>
  const T& one_of(const T (&all)[N]) {
    return all[below(N)];
  }

  Place place(double reach_m, double turn_deg) {
    Place place;
    for (std::size_t i = 0; i < 6; ++i) {
      const double reach = i < 3 ? reach_m : turn_deg;
      place.number[i] = between(-reach, reach);
    }
    return place;
  }

  CombinedScene scene(std::uint64_t seed) {
    CombinedScene scene{.seed = seed};
    if (one_in(2)) scene.frame = place(log_between(0.1, 1e4), 180);
    const bool moving = one_in(2);
    const std::size_t bodies = 1 + below(6);
    while (scene.bodies.size() < bodies) add_body(scene, moving);
    if (one_in(2)) add_wall(scene);
    scene.relation = static_cast<Relation>(below(kRelations));
    const std::size_t sensors = 1 + below(3);
    while (scene.sensors.size() < sensors) add_sensor(scene, moving);
    return scene;
  }

 private:
  /// A place in the parent's frame whose origin is this point of FRAME in the
  /// first frame.
  Place place_at(const CombinedScene& scene, int parent, const glm::dvec3& point_m) {
    CombinedScene alone = scene;
    alone.frame = {};
    const Frame parent_from_frame = inverse(world_from_body(alone, parent, 0));
    const Vector at = parent_from_frame.turn * Vector(point_m) + parent_from_frame.at;
    Place at_point = place(0, 180);
    for (int i = 0; i < 3; ++i) at_point.number[static_cast<std::size_t>(i)] = static_cast<double>(at[i]);
    return at_point;
  }

  void add_body(CombinedScene& scene, bool moving) {
    Body body;
    const double azimuth = between(-0.6, 0.6), elevation = between(-0.4, 0.4), away_m = log_between(0.8, 9);
    if (!scene.bodies.empty() && one_in(3)) body.parent = static_cast<int>(below(scene.bodies.size()));
    body.offset = place_at(scene, body.parent,
                           away_m * glm::dvec3(std::cos(elevation) * std::cos(azimuth),
                                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation)));
    if (moving && one_in(2)) {
      body.moves = true;
      body.move[1] = place(0.3, 25);
    }
    if (moving && one_in(3)) {
      body.has_joint = true;
      body.slides = one_in(3);
      body.axis = {between(-1, 1), between(-1, 1), between(0.1, 1)};
      body.joint[1] = body.slides ? between(-0.3, 0.3) : between(-30, 30);
    }
    body.kind = static_cast<ShapeKind>(below(kShapeKinds));
    // From a fraction of a pixel to what fills the view.
    const double size_m = away_m * log_between(0.01, 0.5);
    body.size_m = {size_m * between(0.3, 2), size_m * between(0.3, 2), size_m * between(0.3, 2)};
    body.radius_m = size_m * between(0.3, 1);
    body.length_m = size_m * between(0.3, 3);
    if (body.kind == ShapeKind::triangles) {
      body.single_sided = one_in(2);
      body.triangles = random_triangles(size_m);
    }
    if (body.kind == ShapeKind::heights) {
      body.heights = random_heights(size_m);
      body.size_m *= 3;
    }
    if (body.kind == ShapeKind::balls || body.kind == ShapeKind::discs) {
      body.points.resize(1 + below(20));
      for (CloudPoint& point : body.points) {
        point = {floats(size_m), floats(1)};
      }
      body.radius_m = size_m * between(0.05, 0.3);
    }
    if (body.kind == ShapeKind::splats) {
      body.splats.resize(1 + below(10));
      for (test::FileSplat& splat : body.splats) splat = random_splat(size_m);
    }
    if (one_in(4)) body.scale = {between(0.5, 2), between(0.5, 2), between(0.5, 2)};
    if (one_in(2)) body.opacity = one_of<double>({0.25, 0.75});
    body.has_class = one_in(3);
    scene.bodies.push_back(std::move(body));
  }

  glm::dvec3 floats(double reach) {
    const auto number = [&] { return static_cast<double>(static_cast<float>(between(-reach, reach))); };
    const double x = number(), y = number();
    return {x, y, number()};
  }

  // Few heights have a tree, many are a grid of their own: see kMinGridCells.
  Heights random_heights(double size_m) {
    Heights heights;
    const bool many = one_in(40);
    heights.columns = many ? kManyHeights : 2 + static_cast<int>(below(9));
    heights.rows = many ? kManyHeights : 2 + static_cast<int>(below(9));
    heights.low_m = between(-size_m, size_m);
    heights.high_m = heights.low_m + between(-size_m, size_m);
    const std::size_t rough = many ? 3000 : 65536;
    for (int i = 0; i < heights.columns * heights.rows; ++i) {
      heights.codes.push_back(static_cast<std::uint16_t>(below(rough)));
    }
    return heights;
  }

  test::FileSplat random_splat(double size_m) {
    test::FileSplat splat;
    splat.center_m = floats(size_m);
    const double sigma_m = size_m * log_between(0.05, 0.5);
    splat.sigma_m = {sigma_m * between(0.1, 1), sigma_m * between(0.1, 1), sigma_m * between(0.1, 1)};
    splat.rotation = {between(-1, 1), between(-1, 1), between(-1, 1), between(0.1, 1)};
    splat.opacity = between(0.05, 0.999);
    return splat;
  }

  // Faces that lie on others, from another corner on or the other way round,
  // stand for walls with two sides.
  std::vector<Triangle> random_triangles(double size_m) {
    std::vector<Triangle> all(1 + below(20));
    const auto coordinate = [&] { return static_cast<double>(static_cast<float>(between(-size_m, size_m))); };
    for (Triangle& triangle : all) {
      for (glm::dvec3& corner : triangle) corner = {coordinate(), coordinate(), coordinate()};
    }
    const std::size_t doubled = one_in(2) ? 0 : below(all.size() + 1);
    for (std::size_t i = 0; i < doubled; ++i) {
      const auto [a, b, c] = all[i];
      all.push_back(one_in(2) ? Triangle{b, c, a} : one_in(2) ? Triangle{a, c, b} : Triangle{c, b, a});
    }
    return all;
  }

  void add_wall(CombinedScene& scene) {
    Body wall{.kind = one_in(2) ? ShapeKind::box : ShapeKind::plane, .size_m = {0.1, 60, 60}};
    wall.offset = place(0.5, 20);
    wall.offset.number[0] = 10;
    if (wall.kind == ShapeKind::plane) {
      wall.size_m = {60, 60, 1};
      wall.offset.number[4] += 90;
    }
    scene.bodies.push_back(wall);
  }

  void add_sensor(CombinedScene& scene, bool moving) {
    SensorDesc sensor;
    if (one_in(2)) sensor.parent = static_cast<int>(below(scene.bodies.size()));
    sensor.kind =
        one_of<SensorKind>({SensorKind::scanner, SensorKind::scanner, SensorKind::scanner, SensorKind::camera,
                            SensorKind::camera, SensorKind::camera, SensorKind::stereo_camera, SensorKind::range,
                            SensorKind::keypoints, SensorKind::imu, SensorKind::odometry, SensorKind::other});
    // It looks along x of FRAME, more or less.
    const Place look = place(0.2, 15);
    sensor.offset = place_in(scene, sensor.parent, look);
    if (sensor.kind == SensorKind::scanner) draw_scanner(sensor, moving);
    if (sensor.kind == SensorKind::camera || sensor.kind == SensorKind::stereo_camera) {
      const bool has_cloud = std::ranges::any_of(scene.bodies, [](const Body& body) { return !body.points.empty(); });
      draw_camera(sensor, moving, has_cloud);
    }
    // An event camera sees how things have moved from frame to frame.
    const bool frames_differ = moving && scene.relation == Relation::own_rates;
    const std::size_t others = std::size(kOtherSensors) - (frames_differ || has_many_heights(scene) ? 1 : 0);
    if (sensor.kind == SensorKind::other) sensor.other = kOtherSensors[below(others)];
    if (sensor.kind == SensorKind::range) sensor.range_max_m = 30;
    if (sensor.kind == SensorKind::keypoints) {
      draw_image(sensor, moving);
      if (one_in(2)) draw_lens(sensor);
      if (one_in(2)) sensor.radius_m = between(0, 3);
    }
    scene.sensors.push_back(std::move(sensor));
  }

  Place place_in(const CombinedScene& scene, int parent, const Place& in_frame) {
    CombinedScene alone = scene;
    alone.frame = {};
    const Frame at = inverse(world_from_body(alone, parent, 0)) * frame_of(in_frame);
    Place place;
    for (int i = 0; i < 3; ++i) place.number[static_cast<std::size_t>(i)] = static_cast<double>(at.at[i]);
    const Matrix& r = at.turn;
    constexpr Real kDegree = 57.29577951308232087679815481410517L;
    place.number[3] = static_cast<double>(kDegree * std::atan2(r[1][2], r[2][2]));
    place.number[4] = static_cast<double>(kDegree * std::atan2(-r[0][2], std::hypot(r[0][0], r[0][1])));
    place.number[5] = static_cast<double>(kDegree * std::atan2(r[0][1], r[0][0]));
    return place;
  }

  void draw_scanner(SensorDesc& scanner, bool moving) {
    scanner.beams = 2 + static_cast<int>(below(80));
    scanner.rings = 1 + static_cast<int>(below(8));
    scanner.half_width_deg = between(2, 60);
    scanner.half_height_deg = between(1, 30);
    scanner.method = one_of<const char*>({"raycast", "raycast", "raycast", "hybrid", "planar", "nearest"});
    if (moving && scanner.method == "raycast" && !one_in(4)) scanner.sweep_s = between(0.001, 0.1);
    scanner.truth = one_in(2);
    if (one_in(4)) scanner.range_min_m = 2;
    if (one_in(4)) scanner.range_max_m = 6;
  }

  void draw_image(SensorDesc& camera, bool moving) {
    camera.width_px = 8 + static_cast<int>(below(33));
    camera.height_px = 4 + static_cast<int>(below(static_cast<std::size_t>(camera.width_px)));
    camera.hfov_deg = between(20, 100);
    if (one_in(4)) camera.near_m = 2;
    if (moving && one_in(2)) camera.row_time_s = 0.1 / camera.height_px * between(0.1, 1);
  }

  void draw_lens(SensorDesc& camera) {
    if (one_in(2)) {
      camera.lens = "brown_conrady";
      camera.hfov_deg = between(20, 70);
      camera.lens_k = {between(-0.1, 0.2), between(-0.02, 0.02), 0, between(-0.01, 0.01), between(-0.01, 0.01)};
    } else {
      camera.lens = "kannala_brandt";
      if (one_in(2)) camera.hfov_deg = between(100, 150);  // rays beside and behind it
      camera.lens_k = {between(-0.02, 0.02), between(-0.002, 0.002), 0, 0, 0};
    }
  }

  void draw_camera(SensorDesc& camera, bool moving, bool has_cloud) {
    draw_image(camera, moving);
    camera.outputs = one_in(4) ? "color depth" : "depth";
    if (camera.kind == SensorKind::stereo_camera) {
      camera.baseline_m = between(0.05, 0.3);
      if (one_in(2)) camera.outputs += " disparity";
    }
    for (const char* const output : {"instance", "depth_error_bound", "range", "shape", "semantic",
                                     "object_coordinates", "flow_backward", "flow_forward", "scene_flow"}) {
      if (one_in(2)) camera.outputs += std::string(" ") + output;
    }
    if (one_in(4)) {
      // Each pixel of a canvas of nine images is compared.
      camera.width_px = std::min(camera.width_px, 16);
      camera.height_px = std::min(camera.height_px, 12);
      camera.outputs += " boxes";
    }
    if (one_in(2)) {
      // Clouds are drawn as squares, and cast for all outputs but these.
      if (has_cloud) camera.outputs += " normal";
      return;
    }
    if (has_cloud || one_in(3)) camera.outputs += " normal";
    if (camera.outputs.find("flow_") != std::string::npos && one_in(2)) camera.outputs += " occlusion";
    if (one_in(2)) camera.outputs += " layers";
    // Depth alone is interpolated between rendered pixels where a lens is,
    // without a bound.
    if (one_in(2)) {
      if (camera.outputs.find("instance") == std::string::npos) camera.outputs += " instance";
      draw_lens(camera);
    }
    camera.layer = one_of<const char*>({"visible", "visible", "first", "first_opaque"});
  }

  test::Random random_;
};

}  // namespace

CombinedScene random_scene(std::uint64_t seed) { return SceneDraw(seed).scene(seed); }

}  // namespace simvis::combined
