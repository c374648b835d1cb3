// Ids, ranges, normals and coordinates of pixels against exact rays through the centres of the pixels.
#include "sensors/camera/pixel_truth.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
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
#include "program/output/depth_png_file.h"
#include "tests/sensors/truth_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// Vertices are snapped to 1/256 of a pixel: each moves by at most half of that along each axis, so an edge moves by at
// most as much. Twice that leaves room for the rounding of positions to float32.
constexpr double kEdge_px = 1.0 / 256;

// Two float32 roundings, of a depth and of a range or of a coordinate.
constexpr double kStoredTwice = 0x1p-23;

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
      for (int axis = 0; axis < 3; ++axis) each.in_mesh[axis] *= glm::length(glm::dvec3(world_from_mesh[axis]));
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
  const double f_px = kTruthWidth / 2.0 / std::tan(35 * std::numbers::pi / 180);
  return glm::normalize(glm::dvec3((x_px - kTruthWidth / 2.0) / f_px, (y_px - kTruthHeight / 2.0) / f_px, 1));
}

struct Image2 {
  int first_row = 0, rows = kTruthHeight;
};

struct Comparison {
  int pixels = 0, edges = 0, sky = 0, narrow = 0;
};

// Compares the pixels of some rows. `prefix` as in the names of outputs. If pixels are `drawn`, one whose instance is
// not that of the ray counts as an edge, and the instance must be met within kEdge_px of its centre.
template <typename RayOf>
void compare(const Measurement& measurement, const std::string& prefix, const RayOf& ray_of, RayReference& reference,
             const glm::dmat4& world_from_view, const Image2& part, bool drawn, Comparison& compared) {
  const std::vector<double> instance = truth_numbers(measurement, prefix + "instance"),
                            semantic = truth_numbers(measurement, prefix + "semantic"),
                            range = truth_numbers(measurement, prefix + "range"),
                            in_mesh = truth_numbers(measurement, prefix + "object_coordinates"),
                            depth = truth_numbers(measurement, prefix + "depth"),
                            bound = truth_numbers(measurement, prefix + "depth_error_bound");
  const std::vector<double> normal = drawn ? std::vector<double>() : truth_numbers(measurement, prefix + "normal");
  const std::size_t first = std::size_t(part.first_row) * kTruthWidth,
                    end = first + std::size_t(part.rows) * kTruthWidth;
  const auto at = [&](std::size_t pixel, double dx, double dy) {
    return ray_of(static_cast<double>(pixel % kTruthWidth) + 0.5 + dx,
                  static_cast<double>(pixel / kTruthWidth) + 0.5 + dy);
  };
  std::vector<glm::dvec3> directions;
  for (std::size_t pixel = first; pixel < end; ++pixel) directions.push_back(at(pixel, 0, 0));
  const std::vector<SeenByRay> seen = reference.cast(world_from_view, directions);
  REQUIRE(instance.size() == std::size_t{kTruthWidth} * kTruthHeight);
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
  return compared;
}

void require_edges_are_few(const Comparison& compared) {
  CHECK(compared.pixels == kTruthWidth * kTruthHeight);
  CHECK(compared.sky > 0);
  CHECK(compared.sky < compared.pixels / 2);
  MESSAGE(compared.edges << " of " << compared.pixels << " pixels lie on edges");
  CHECK(compared.edges <= compared.pixels / 256);  // as if every pixel had an edge
  CHECK(compared.narrow <= compared.pixels / 256);
}

TEST_CASE("the truth of a pinhole camera is what rays through the pixels' centres meet") {
  for (const bool drawn : {true, false}) {
    Simulation simulation = truth_simulation(truth_camera("color " + (drawn ? kDrawnTruth : kCastTruth)));
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
    Simulation simulation = truth_simulation(truth_camera("color " + kDrawnTruth, more));
    simulation.step();
    std::vector<double> all;
    for (const char* const name : {"instance", "semantic", "range", "depth"}) {
      for (const double number : truth_numbers(simulation.measurement("CAM"), name)) all.push_back(number);
    }
    return all;
  };
  const std::vector<double> plain = truth("");
  CHECK(plain.size() == 4 * kTruthWidth * kTruthHeight);
  CHECK(truth("supersampling='16'") == plain);
  CHECK(truth("msaa='4'") == plain);
  CHECK(truth("max_error_px='1'") == plain);
}

TEST_CASE("the truth through a lens is cast and exact") {
  // Equidistant: the angle from the axis is the distance from the middle over the focal length.
  constexpr double kFocal_px = 30;
  const auto ray = [](double x_px, double y_px) {
    const glm::dvec2 off((x_px - kTruthWidth / 2.0) / kFocal_px, (y_px - kTruthHeight / 2.0) / kFocal_px);
    const double angle = glm::length(off);
    if (angle == 0) return glm::dvec3(0, 0, 1);
    return glm::dvec3(std::sin(angle) / angle * off, std::cos(angle));
  };
  Simulation simulation = truth_simulation(truth_camera(kCastTruth, "distortion='kannala_brandt' fx='30'"));
  simulation.step();
  const Measurement measurement = simulation.measurement("CAM");
  // The camera's own rays are those of the formula to 1e-9 pixels, so ranges differ by their slope over the image.
  RayReference reference(simulation, simulation.diagnostics().draw_list());
  const std::vector<double> instance = truth_numbers(measurement, "instance"),
                            range = truth_numbers(measurement, "range"), normal = truth_numbers(measurement, "normal");
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < kTruthWidth * kTruthHeight; ++i)
    directions.push_back(ray(i % kTruthWidth + 0.5, i / kTruthWidth + 0.5));
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
  CHECK(met > kTruthWidth * kTruthHeight / 3);
  CHECK(met < kTruthWidth * kTruthHeight);
}

TEST_CASE("rows of a rolling shutter have the truth of their own time, of the camera and of things") {
  constexpr double kRowTime_s = 0.0005;
  constexpr int kRowsPerPose = 12;
  for (const bool drawn : {true, false}) {
    Simulation simulation = truth_simulation(truth_camera(
        drawn ? kDrawnTruth : kCastTruth, "row_time='0.0005' rows_per_pose='" + std::to_string(kRowsPerPose) + "'"));
    simulation.step(std::chrono::milliseconds(100));
    // From frame to frame the car drives 0.2 m ahead, and the crate's frame 0.5 m to the left.
    simulation.set("DRIVE", "x", 0.2);
    simulation.set("MOVE", "y", 0.5);
    simulation.step(std::chrono::milliseconds(100));
    const Measurement measurement = simulation.measurement("CAM");
    const std::vector<SceneItem> items = simulation.items();
    const auto crate = static_cast<std::size_t>(std::ranges::find(items, "CRATE", &SceneItem::part) - items.begin());
    Comparison compared;
    for (int first = 0; first < kTruthHeight; first += kRowsPerPose) {
      const double time_s = (first + (kRowsPerPose - 1) / 2.0 - (kTruthHeight - 1)) * kRowTime_s, share = time_s / 0.1;
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
    Simulation simulation = truth_simulation(
        truth_camera("disparity " + (drawn ? kDrawnTruth : kCastTruth), "baseline='0.3'", "stereo_camera"));
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
    disparities[drawn ? 0 : 1] = truth_numbers(measurement, "disparity");
  }
  REQUIRE(disparities[0].size() == disparities[1].size());
  int differ = 0;
  for (std::size_t i = 0; i < disparities[0].size(); ++i) {
    // The drawn ball appears less than 0.1 pixels inside the cast one, at 2.5 m or more: 0.1 b / Z = 0.012 pixels where
    // the ray meets it at right angles, and twice that at an incidence of 60 degrees.
    differ += std::abs(disparities[0][i] - disparities[1][i]) > 0.024;
  }
  CHECK(differ <= kTruthWidth * kTruthHeight / 256);
}

TEST_CASE("object coordinates are metres from the origin of the mesh, whatever its unit and scale are") {
  struct Thing {
    std::string attributes;
    glm::dvec3 origin_m;  // in the frame of the part
    std::string scale{};  // of an element at the part
  };
  const TemporaryFolder folder;
  // A slope: the picture has two columns of the codes 0 and 65535. The mesh of its heights is not in metres.
  write_text(folder / "slope.png", encode_depth_png({2, 2, 1, {0, 65535, 0, 65535}}, 1));
  for (const Thing& thing : {Thing{"shape='heightmap' size='3 5' heights='slope.png' z_range='0.3 1.7'", {0, 0, 0.3}},
                             Thing{"shape='box' size='10 8 5'", {0, 0, 0}, "x='0.1' y='0.2' z='0.3'"},
                             Thing{"shape='sphere' radius='100'", {0, 0, 0}, "x='0.01' y='0.01' z='0.01'"}}) {
    CAPTURE(thing.attributes);
    for (const char* const more : {"", " normal"}) {
      Simulation simulation = Simulation::from_string(
          "<part name='THING' insert_at='ROOT' pose_offset='4 0 -1 0 0 30' " + thing.attributes + "/>" +
              (thing.scale.empty() ? ""
                                   : "<element type='scale' name='SCALE' insert_at='THING' " + thing.scale + "/>") +
              "<sensor type='camera' name='CAM' insert_at='ROOT' pose_offset='0 0 1 0 25 0' width='24' height='18' "
              "outputs='range object_coordinates" +
              more + "'/>",
          {}, folder.path());
      simulation.step();
      const Measurement measurement = simulation.measurement("CAM");
      const std::vector<double> range_m = truth_numbers(measurement, "range"),
                                place = truth_numbers(measurement, "object_coordinates");
      const glm::dmat4 thing_from_camera =
          rigid_inverse(matrix_from_degrees({4, 0, -1}, 0, 0, 30)) * matrix_from_degrees({0, 0, 1}, 0, 25, 0);
      int compared = 0;
      for (std::size_t i = 0; i < range_m.size(); ++i) {
        if (std::isinf(range_m[i])) continue;
        ++compared;
        const glm::dvec3 coordinates(place[3 * i], place[3 * i + 1], place[3 * i + 2]);
        const double across = (static_cast<double>(i % 24) + 0.5 - 12) / (12 / std::tan(glm::radians(30.0))),
                     down = (static_cast<double>(i / 24) + 0.5 - 9) / (12 / std::tan(glm::radians(30.0)));
        const glm::dvec3 ray = glm::normalize(glm::dvec3(1, -across, -down));
        const glm::dvec3 expected = glm::dvec3(thing_from_camera * glm::dvec4(range_m[i] * ray, 1)) - thing.origin_m;
        // The range is a float within 6 m; drawn, the surface is within its bound, far below a micrometre here but for
        // the sphere, whose flat sides lie up to 0.1 pixels inside: the coordinates are those of the sphere.
        const double drawn_m = thing.attributes.find("sphere") == std::string::npos ? 1e-5 : 0.02;
        CHECK(glm::distance(coordinates, expected) <= 8 * kStoredTwice * 6 + drawn_m);
      }
      CHECK(compared > 20);
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
