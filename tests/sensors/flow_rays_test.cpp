// Flow, scene flow and occlusion against depths, poses, motions of things and rays of the other image, on all pixels of
// moving scenes.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include <simvis/diagnostics.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include <simvis/surface_point.h>
#include "tests/sensors/flow_scene.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// A flow is stored as float32, and so is the depth that the test projects again.
constexpr double kFlowStored = 0x1p-21;
// Ranges of double beyond which two surfaces of the scene are apart.
constexpr double kApart_m = 1e-9;

constexpr double kFisheyeFocal_px = 30;

// A lens: the ray of a pixel, and the pixel of a direction.
struct TestLens {
  std::function<glm::dvec3(const glm::dvec2&)> ray;
  std::function<std::optional<glm::dvec2>(const glm::dvec3&)> pixel;
};

TestLens test_pinhole() {
  return {[](const glm::dvec2& at) { return glm::normalize(glm::dvec3((at - kFlowMiddle) / kFlowFocal_px, 1)); },
          [](const glm::dvec3& to) {
            return to.z > 0 ? std::optional(kFlowMiddle + kFlowFocal_px * glm::dvec2(to) / to.z) : std::nullopt;
          }};
}

// Equidistant: the angle from the axis is the distance from the middle over the focal length; up to 110 degrees.
TestLens test_fisheye() {
  constexpr double kLimit_rad = 110 * std::numbers::pi / 180;
  return {[](const glm::dvec2& at) {
            const glm::dvec2 off = (at - kFlowMiddle) / kFisheyeFocal_px;
            const double angle = glm::length(off);
            if (angle > kLimit_rad) return glm::dvec3(0);
            if (angle == 0) return glm::dvec3(0, 0, 1);
            return glm::dvec3(std::sin(angle) / angle * off, std::cos(angle));
          },
          [](const glm::dvec3& to) -> std::optional<glm::dvec2> {
            const double across = glm::length(glm::dvec2(to)), angle = std::atan2(across, to.z);
            if (angle >= kLimit_rad) return std::nullopt;
            return across == 0 ? kFlowMiddle : kFlowMiddle + kFisheyeFocal_px * angle / across * glm::dvec2(to);
          }};
}

// Rows of an image that have one pose, and the world at their time.
struct TakenRows {
  int first = 0, end = kFlowHeight;
  glm::dmat4 world_from_view{1.0};
  DrawList list;
};

// One image: what it measured, and the rows of one of its views.
struct Taken {
  Measurement measurement;
  std::vector<SceneItem> items;
  std::vector<TakenRows> rows;

  const TakenRows& rows_of(int pixel) const {
    return *std::ranges::find_if(rows, [&](const TakenRows& each) { return pixel / kFlowWidth < each.end; });
  }
};

Taken take(const Simulation& simulation, double right_m = 0) {
  glm::dmat4 world_from_sensor;
  simulation.sensor_pose("CAM", world_from_sensor);
  TakenRows rows{.world_from_view = glm::translate(world_from_sensor * sensor_from_view(), glm::dvec3(right_m, 0, 0)),
                 .list = simulation.diagnostics().draw_list()};
  return {simulation.measurement("CAM"), simulation.items(), {std::move(rows)}};
}

std::size_t item_of(const Taken& taken, double instance) {
  return static_cast<std::size_t>(
      std::ranges::find(taken.items, static_cast<std::uint32_t>(instance), &SceneItem::instance) - taken.items.begin());
}
glm::dmat4 place_of(const DrawList& list, std::size_t item) { return list.world_from_node[list.items[item].transform]; }

struct Expected {
  std::optional<glm::dvec2> pixel;
  glm::dvec3 way_m{0};                     // in the world
  bool is_seen = false, is_close = false;  // in the other image; whether that changes within the rounding of the range
};

struct Images {
  const Taken &from, &to;
  const TestLens& lens;
  std::string prefix;
};

// The rays of the other image, group of rows by group of rows.
class OtherImage {
 public:
  OtherImage(const Images& images) : images_(images) {
    for (const TakenRows& rows : images.to.rows) {
      casters_.push_back(make_host_ray_caster());
      casters_.back()->set_world(rows.list);
    }
  }

  // `range_m`: of the pixel, infinite for the sky.
  Expected expect(int pixel, double instance, double range_m) {
    const TakenRows& from = images_.from.rows_of(pixel);
    const bool sky = instance == 0;
    const glm::dvec3 ray = images_.lens.ray(flow_centre(pixel));
    const glm::dvec4 world = from.world_from_view * (sky ? glm::dvec4(ray, 0) : glm::dvec4(range_m * ray, 1));
    Expected expected;
    std::optional<glm::dvec2> some;
    int seen_by = 0;
    for (std::size_t r = 0; r < images_.to.rows.size(); ++r) {
      const TakenRows& to = images_.to.rows[r];
      const glm::dvec4 moved = sky ? world : moved_to(from.list, to.list, instance) * world;
      if (from.first == to.first) expected.way_m = glm::dvec3(moved - world);
      const glm::dvec3 view(glm::inverse(to.world_from_view) * moved);
      const std::optional<glm::dvec2> at = images_.lens.pixel(view);
      if (!at) continue;
      some = at;
      const bool above = to.first == 0, below = to.end == kFlowHeight;
      if ((at->y < to.first && !above) || (at->y >= to.end && !below)) continue;
      ++seen_by;
      expected.pixel = at;
      const bool inside = at->x >= 0 && at->y >= 0 && at->x < kFlowWidth && at->y < kFlowHeight;
      if (!inside) continue;
      const glm::dvec2 pixel_centre = glm::floor(*at) + 0.5;
      if (images_.lens.ray(pixel_centre) == glm::dvec3(0)) continue;  // the pixel sees nothing
      const glm::dvec3 direction = glm::normalize(view);
      const double length_m = sky ? INFINITY : glm::length(view);
      expected.is_seen = sees(r, direction, length_m, instance);
      expected.is_close = false;
      for (int k = 0; k < 4 && !expected.is_close; ++k) {
        const glm::dvec3 across = k < 2 ? glm::dvec3(k == 0 ? 1 : -1, 0, 0) : glm::dvec3(0, k == 2 ? 1 : -1, 0);
        const glm::dvec3 beside = glm::normalize(direction + kFlowStored * across);
        expected.is_close = sees(r, beside, length_m, instance) != expected.is_seen;
      }
    }
    // Between the rows, or in several of them: there is more than one answer.
    between_ += seen_by == 0 && some;
    several_ += seen_by > 1;
    if (seen_by != 1) expected.pixel.reset();
    return expected;
  }
  int between() const { return between_; }
  int several() const { return several_; }

 private:
  glm::dmat4 moved_to(const DrawList& from, const DrawList& to, double instance) const {
    return place_of(to, item_of(images_.to, instance)) * glm::inverse(place_of(from, item_of(images_.from, instance)));
  }
  // The range is that of float32, so a slanted surface is met farther from it, and an edge may lie in between.
  bool sees(std::size_t r, const glm::dvec3& direction, double range_m, double instance) {
    const TakenRows& rows = images_.to.rows[r];
    RayHit hit;
    casters_[r]->cast(rows.world_from_view, {&direction, 1}, {&hit, 1});
    if (std::isinf(range_m) || std::isinf(hit.range_m)) return std::isinf(range_m) && std::isinf(hit.range_m);
    if (images_.to.items[hit.item].instance != instance) return false;
    const glm::dvec3 normal = surface_point(rows.list, rows.world_from_view, direction, hit).normal;
    const double cosine = std::abs(glm::dot(normal, direction));
    return std::abs(hit.range_m - range_m) <= (kApart_m + range_m * kFlowStored) / cosine;
  }

  Images images_;
  std::vector<std::unique_ptr<RayCaster>> casters_;
  int between_ = 0, several_ = 0;
};

struct FlowCount {
  int pixels = 0, sky = 0, moving = 0, hidden = 0, seen = 0, disagree = 0, close = 0;
  double largest_px = 0;
};

// Compares the flow of each pixel with the projection of its range. `flow` is the array of that name of `measurement`,
// and `occlusion` that of its occlusion; empty: it has none.
FlowCount compare_flow(const Images& images, const Measurement& measurement, const std::string& flow_name,
                       const std::string& occlusion_name, OtherImage& other) {
  const std::vector<double> flow = flow_numbers(measurement, images.prefix + flow_name),
                            instance = flow_numbers(images.from.measurement, images.prefix + "instance"),
                            range = flow_numbers(images.from.measurement, images.prefix + "range");
  const std::vector<double> occlusion =
      occlusion_name.empty() ? std::vector<double>() : flow_numbers(measurement, images.prefix + occlusion_name);
  FlowCount count;
  REQUIRE(flow.size() == 2 * kFlowPixels);
  for (int pixel = 0; pixel < kFlowPixels; ++pixel) {
    const auto i = static_cast<std::size_t>(pixel);
    const glm::dvec2 seen(flow[2 * i], flow[2 * i + 1]);
    if (images.lens.ray(flow_centre(pixel)) == glm::dvec3(0)) {
      CHECK(std::isnan(seen.x));
      continue;
    }
    const Expected expected = other.expect(pixel, instance[i], range[i]);
    if (!expected.pixel) continue;
    const glm::dvec2 wanted = *expected.pixel - flow_centre(pixel);
    for (int c = 0; c < 2; ++c) {
      CHECK(std::abs(seen[c] - wanted[c]) <= kFlow_px + kFlowStored * std::abs(wanted[c]));
    }
    ++count.pixels;
    count.sky += instance[i] == 0;
    count.moving += glm::length(expected.way_m) > 1e-3;
    count.largest_px = std::max(count.largest_px, glm::length(wanted));
    if (occlusion.empty()) continue;
    count.close += expected.is_close;
    count.disagree += (occlusion[i] == 0) != expected.is_seen && !expected.is_close;
    ++(expected.is_seen ? count.seen : count.hidden);
  }
  return count;
}

void require_variety(const FlowCount& count) {
  CHECK(count.close <= count.pixels / 200);
  CHECK(count.sky > 100);
  CHECK(count.moving > 10);
  CHECK(count.largest_px > 3);
}

struct FlowMode {
  const char *name, *attributes;
  bool cast, fisheye, stereo;  // cast: with occlusion
};
constexpr FlowMode kModes[] = {{"drawn", "", false, false, false},
                               {"cast", "", true, false, false},
                               {"supersampled", "supersampling='16'", false, false, false},
                               {"fisheye", "distortion='kannala_brandt' fx='30'", true, true, false},
                               {"drawn stereo", "baseline='0.3'", false, false, true},
                               {"cast stereo", "baseline='0.3'", true, false, true}};

TEST_CASE("flow is the projection of depth, poses and motions, and occlusion is a ray, on every pixel") {
  for (const FlowMode& mode : kModes) {
    CAPTURE(mode.name);
    const std::string outputs =
        std::string("color instance range flow_backward flow_forward scene_flow") + (mode.cast ? " occlusion" : "");
    Simulation simulation = Simulation::from_string(
        "<simvis>" + kMovingThings + flow_camera(outputs, mode.attributes, mode.stereo ? "stereo_camera" : "camera") +
        "</simvis>");
    const TestLens lens = mode.fisheye ? test_fisheye() : test_pinhole();
    std::map<bool, Taken> before;
    for (int frame = 0; frame < 3; ++frame) {
      move_flow_scene(simulation, frame);
      for (const bool right : {false, true}) {
        if (right && !mode.stereo) continue;
        Taken now = take(simulation, right ? 0.3 : 0);
        const std::string prefix = !mode.stereo ? "" : right ? "right_" : "left_";
        if (frame > 0) {
          const Taken& then = before.at(right);
          const Images back{now, then, lens, prefix};
          OtherImage other(back);
          const FlowCount count =
              compare_flow(back, now.measurement, "flow_backward", mode.cast ? "occlusion_backward" : "", other);
          require_variety(count);
          CHECK(count.disagree == 0);
          const Images ahead{then, now, lens, prefix};
          OtherImage next(ahead);
          const FlowCount forward =
              compare_flow(ahead, now.measurement, "flow_forward", mode.cast ? "occlusion_forward" : "", next);
          require_variety(forward);
          CHECK(forward.disagree == 0);
          if (mode.cast) {
            CHECK(count.hidden > 50);
            CHECK(count.seen > kFlowPixels / 2);
            CHECK(forward.hidden > 50);
          }
        } else {
          for (const double number : flow_numbers(now.measurement, prefix + "flow_backward")) {
            CHECK(std::isnan(number));  // there is no previous image
          }
        }
        before.insert_or_assign(right, std::move(now));
      }
    }
  }
}

// Rows of a rolling shutter whose camera and crate go straight on.
Taken take_rolling(const Simulation& simulation, double car_m, double crate_m, double row_s, int rows_per_pose) {
  Taken whole = take(simulation);
  Taken taken{whole.measurement, whole.items, {}};
  const auto crate =
      static_cast<std::size_t>(std::ranges::find(whole.items, "CRATE", &SceneItem::part) - whole.items.begin());
  for (int first = 0; first < kFlowHeight; first += rows_per_pose) {
    const double share = (first + (rows_per_pose - 1) / 2.0 - (kFlowHeight - 1)) * row_s / 0.1;
    TakenRows rows = whole.rows[0];
    rows.first = first;
    rows.end = first + rows_per_pose;
    rows.world_from_view =
        glm::translate(glm::dmat4(1.0), glm::dvec3(car_m * share, 0, 0)) * whole.rows[0].world_from_view;
    const glm::dmat4 place = place_of(rows.list, crate);
    rows.list.items[crate].transform = static_cast<std::uint32_t>(rows.list.world_from_node.size());
    rows.list.world_from_node.push_back(glm::translate(glm::dmat4(1.0), glm::dvec3(0, crate_m * share, 0)) * place);
    taken.rows.push_back(std::move(rows));
  }
  return taken;
}

TEST_CASE("rows of a rolling shutter have flow to the rows that see their points in the other image") {
  constexpr double kRow_s = 0.0005;
  constexpr int kRows = 12;
  for (const bool cast : {false, true}) {
    Simulation simulation = Simulation::from_string(
        "<simvis>" + kMovingThings +
        flow_camera(std::string("instance range flow_backward flow_forward scene_flow") + (cast ? " occlusion" : ""),
                    "row_time='0.0005' rows_per_pose='12'") +
        "</simvis>");
    const TestLens lens = test_pinhole();
    simulation.step(kFlowStep);
    std::optional<Taken> before;
    double car = 0, crate = 0;
    for (const auto& [car_m, crate_m] : {std::pair(0.1, 0.2), std::pair(0.2, -0.3)}) {
      simulation.set("DRIVE", "x", car += car_m);
      simulation.set("MOVE", "y", crate += crate_m);
      simulation.step(kFlowStep);
      Taken now = take_rolling(simulation, car_m, crate_m, kRow_s, kRows);
      if (before) {
        const Images back{now, *before, lens, ""};
        OtherImage other(back);
        const FlowCount count =
            compare_flow(back, now.measurement, "flow_backward", cast ? "occlusion_backward" : "", other);
        CHECK(count.pixels + other.between() + other.several() == kFlowPixels);
        CHECK(count.pixels > kFlowPixels * 0.97);
        require_variety(count);
        CHECK(count.disagree == 0);
        const Images ahead{*before, now, lens, ""};
        OtherImage next(ahead);
        const FlowCount forward =
            compare_flow(ahead, now.measurement, "flow_forward", cast ? "occlusion_forward" : "", next);
        CHECK(forward.pixels > kFlowPixels * 0.97);
        CHECK(forward.disagree == 0);
        // The crate has gone the mean of both ways at the time of the row, along y of the world, which is -x of the
        // view.
        const std::vector<double> scene = flow_numbers(now.measurement, "scene_flow"),
                                  instance = flow_numbers(now.measurement, "instance");
        const std::uint32_t id = std::ranges::find(now.items, "CRATE", &SceneItem::part)->instance;
        int on_crate = 0;
        for (int pixel = 0; pixel < kFlowPixels; ++pixel) {
          const auto i = static_cast<std::size_t>(pixel);
          if (instance[i] == 0) {
            CHECK(std::isnan(scene[3 * i]));
            continue;
          }
          const int first = pixel / kFlowWidth / kRows * kRows;
          const double share = (first + (kRows - 1) / 2.0 - (kFlowHeight - 1)) * kRow_s / 0.1;
          const double way_m = instance[i] == id ? -0.3 + share * (-0.3 - 0.2) : 0;
          on_crate += instance[i] == id;
          CHECK(std::abs(scene[3 * i] + way_m) <= 1e-6);
          CHECK(std::abs(scene[3 * i + 1]) <= 1e-6);
          CHECK(std::abs(scene[3 * i + 2]) <= 1e-6);
        }
        CHECK(on_crate > 50);
      }
      before = std::move(now);
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
