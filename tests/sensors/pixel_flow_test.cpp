// Optical flow, scene flow and occlusion: against geometry by hand, and against depths, poses, motions of things and
// rays of the other image on all pixels of moving scenes.
#include "sensors/camera/pixel_flow.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include <simvis/diagnostics.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include <simvis/surface_point.h>
#include "tests/support/error_of.h"
#include "tests/support/parts/animated_part.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// What the flow of a pixel may differ by from the projection of its depth.
constexpr double kFlow_px = 1e-4;
// A flow is stored as float32, and so is the depth that the test projects again.
constexpr double kFlowStored = 0x1p-21;
// Ranges of double beyond which two surfaces of the scene are apart.
constexpr double kApart_m = 1e-9;

constexpr int kFlowWidth = 96, kFlowHeight = 72, kFlowPixels = kFlowWidth * kFlowHeight;
constexpr double kFlowHfov_rad = 70 * std::numbers::pi / 180;
const double kFlowFocal_px = kFlowWidth / 2.0 / std::tan(kFlowHfov_rad / 2);
constexpr double kFisheyeFocal_px = 30;
constexpr auto kStep = std::chrono::milliseconds(100);

// Closed shapes, so that no ray from outside meets a back face; a crate that goes and turns, a camera that does.
const std::string kMovingThings = R"(
  <part name="FLOOR" insert_at="ROOT" shape="box" size="20 20 0.2" pose_offset="0 0 -0.6 0 0 0"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.2 9 3" pose_offset="6 0 1 0 0 10"/>
  <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.5" pose_offset="3 0.4 0 0 0 0"/>
  <part name="ROD" insert_at="ROOT" shape="cylinder" radius="0.05" length="2" pose_offset="2.5 -0.6 0.3 20 0 0"/>
  <part name="FRAME" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="FRAME"/>
  <part name="CRATE" insert_at="FRAME" shape="box" size="0.6 0.6 0.6" pose_offset="4 -0.8 0 0 0 30"/>
  <part name="CAR" insert_at="ROOT"/>
  <element type="pose" name="DRIVE" insert_at="CAR"/>
)";

std::string flow_camera(const std::string& outputs, const std::string& more = "", const char* type = "camera") {
  return "<sensor type='" + std::string(type) + "' name='CAM' insert_at='CAR' width='" + std::to_string(kFlowWidth) +
         "' height='" + std::to_string(kFlowHeight) + "' hfov='70' outputs='" + outputs + "' " + more + "/>";
}

std::vector<double> flow_numbers(const Measurement& measurement, const std::string& name) {
  const MeasuredArray* const array = measurement.find(name);
  REQUIRE_MESSAGE(array != nullptr, name);
  std::vector<double> all;
  for (std::size_t i = 0; i < array->count(); ++i) all.push_back(array->number(i));
  return all;
}

// The centre of each pixel.
glm::dvec2 centre_of(int pixel) { return {pixel % kFlowWidth + 0.5, pixel / kFlowWidth + 0.5}; }

// A lens: the ray of a pixel, and the pixel of a direction.
struct TestLens {
  std::function<glm::dvec3(const glm::dvec2&)> ray;
  std::function<std::optional<glm::dvec2>(const glm::dvec3&)> pixel;
};

const glm::dvec2 kMiddle(kFlowWidth / 2.0, kFlowHeight / 2.0);

TestLens test_pinhole() {
  return {[](const glm::dvec2& at) { return glm::normalize(glm::dvec3((at - kMiddle) / kFlowFocal_px, 1)); },
          [](const glm::dvec3& to) {
            return to.z > 0 ? std::optional(kMiddle + kFlowFocal_px * glm::dvec2(to) / to.z) : std::nullopt;
          }};
}

// Equidistant: the angle from the axis is the distance from the middle over the focal length; up to 110 degrees.
TestLens test_fisheye() {
  constexpr double kLimit_rad = 110 * std::numbers::pi / 180;
  return {[](const glm::dvec2& at) {
            const glm::dvec2 off = (at - kMiddle) / kFisheyeFocal_px;
            const double angle = glm::length(off);
            if (angle > kLimit_rad) return glm::dvec3(0);
            if (angle == 0) return glm::dvec3(0, 0, 1);
            return glm::dvec3(std::sin(angle) / angle * off, std::cos(angle));
          },
          [](const glm::dvec3& to) -> std::optional<glm::dvec2> {
            const double across = glm::length(glm::dvec2(to)), angle = std::atan2(across, to.z);
            if (angle >= kLimit_rad) return std::nullopt;
            return across == 0 ? kMiddle : kMiddle + kFisheyeFocal_px * angle / across * glm::dvec2(to);
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
    const glm::dvec3 ray = images_.lens.ray(centre_of(pixel));
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
    if (images.lens.ray(centre_of(pixel)) == glm::dvec3(0)) {
      CHECK(std::isnan(seen.x));
      continue;
    }
    const Expected expected = other.expect(pixel, instance[i], range[i]);
    if (!expected.pixel) continue;
    const glm::dvec2 wanted = *expected.pixel - centre_of(pixel);
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
  bool cast, fisheye, stereo;
};
constexpr FlowMode kModes[] = {{"drawn", "", false, false, false},
                               {"cast", "", true, false, false},
                               {"supersampled", "supersampling='16'", false, false, false},
                               {"fisheye", "distortion='kannala_brandt' fx='30'", true, true, false},
                               {"drawn stereo", "baseline='0.3'", false, false, true},
                               {"cast stereo", "baseline='0.3'", true, false, true}};

void move_on(Simulation& simulation, int frame) {
  simulation.set("DRIVE", "x", 0.15 * frame);
  simulation.set("DRIVE", "yaw", 2.5 * frame);
  simulation.set("DRIVE", "roll", 1.0 * frame);
  simulation.set("MOVE", "y", 0.1 * frame);
  simulation.set("MOVE", "yaw", 4.0 * frame);
  simulation.step(kStep);
}

TEST_CASE("flow is the projection of depth, poses and motions, and occlusion is a ray, on every pixel") {
  for (const FlowMode& mode : kModes) {
    CAPTURE(mode.name);
    const std::string outputs =
        std::string("color instance range flow_backward scene_flow") + (mode.cast ? " occlusion flow_forward" : "");
    Simulation simulation = Simulation::from_string(
        "<simvis>" + kMovingThings + flow_camera(outputs, mode.attributes, mode.stereo ? "stereo_camera" : "camera") +
        "</simvis>");
    const TestLens lens = mode.fisheye ? test_fisheye() : test_pinhole();
    std::map<bool, Taken> before;
    for (int frame = 0; frame < 3; ++frame) {
      move_on(simulation, frame);
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
          if (mode.cast) {
            CHECK(count.hidden > 50);
            CHECK(count.seen > kFlowPixels / 2);
            const Images ahead{then, now, lens, prefix};
            OtherImage next(ahead);
            const FlowCount forward = compare_flow(ahead, now.measurement, "flow_forward", "occlusion_forward", next);
            require_variety(forward);
            CHECK(forward.disagree == 0);
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
    CHECK(simulation.diagnostics().validation_messages() == 0);
  }
}

TEST_CASE("flow before a wall is that of a thin lens by hand") {
  // The camera goes 0.1 m to the left of a wall 5 m away, then turns by 3 degrees to the left.
  for (const std::string more : {"", " occlusion"}) {
    Simulation simulation = Simulation::from_string(
        "<simvis><part name='WALL' insert_at='ROOT' shape='box' size='0.2 20 2' pose_offset='5.1 0 0 0 0 0'/>"
        "<part name='CAR' insert_at='ROOT'/><element type='pose' name='DRIVE' insert_at='CAR'/>" +
        flow_camera("depth flow_backward" + more) + "</simvis>");
    simulation.step(kStep);
    simulation.set("DRIVE", "y", 0.1);
    simulation.step(kStep);
    const auto flow_at = [&](std::size_t pixel) {
      const MeasuredArray& flow = *simulation.measurement("CAM").find("flow_backward");
      return glm::dvec2(flow.number(2 * pixel), flow.number(2 * pixel + 1));
    };
    int wall = 0, sky = 0;
    std::vector<double> depth = flow_numbers(simulation.measurement("CAM"), "depth");
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const bool is_sky = std::isinf(depth[i]);
      ++(is_sky ? sky : wall);
      // What is 5 m away was further to the left by f 0.1 / 5 pixels; the sky was where it is.
      CHECK(std::abs(flow_at(i).x - (is_sky ? 0 : -kFlowFocal_px * 0.1 / 5)) <= kFlow_px);
      CHECK(std::abs(flow_at(i).y) <= kFlow_px);
    }
    CHECK(wall > 1000);
    CHECK(sky > 1000);
    simulation.set("DRIVE", "yaw", 3);
    simulation.step(kStep);
    const double turn = 3 * std::numbers::pi / 180;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      // A turn moves all directions alike, whatever their depth. To the left of the image by the angle before.
      const glm::dvec2 at = centre_of(static_cast<int>(i));
      const double x = (at.x - kMiddle.x) / kFlowFocal_px, y = (at.y - kMiddle.y) / kFlowFocal_px;
      const double z = std::cos(turn) + std::sin(turn) * x, then_x = (std::cos(turn) * x - std::sin(turn)) / z;
      CHECK(std::abs(flow_at(i).x - kFlowFocal_px * (then_x - x)) <= kFlow_px);
      CHECK(std::abs(flow_at(i).y - kFlowFocal_px * (y / z - y)) <= kFlow_px);
    }
  }
}

TEST_CASE("a band beside a near thing is hidden in the other image, as wide as the difference of the parallaxes") {
  // A post 2 m away before a wall 5 m away; the camera goes 0.2 m to the left.
  Simulation simulation = Simulation::from_string(
      "<simvis><part name='WALL' insert_at='ROOT' shape='box' size='0.2 20 20' pose_offset='5.1 0 0 0 0 0'/>"
      "<part name='POST' insert_at='ROOT' shape='box' size='0.2 0.4 20' pose_offset='2.1 0 0 0 0 0'/>"
      "<part name='CAR' insert_at='ROOT'/><element type='pose' name='DRIVE' insert_at='CAR'/>" +
      flow_camera("flow_backward flow_forward occlusion") + "</simvis>");
  simulation.step(kStep);
  for (const double number : flow_numbers(simulation.measurement("CAM"), "occlusion_backward")) CHECK(number == 1);
  simulation.set("DRIVE", "y", 0.2);
  simulation.step(kStep);
  const auto hidden_in_row = [&](const char* name) {
    const std::vector<double> all = flow_numbers(simulation.measurement("CAM"), name);
    return static_cast<double>(std::count(all.begin() + kFlowWidth * 36, all.begin() + kFlowWidth * 37, 1.0));
  };
  // The band, and what left the image at its side: f 0.2 / 5 pixels. Each edge is off by less than a pixel.
  const double band_px = kFlowFocal_px * 0.2 * (1 / 2.0 - 1 / 5.0), gone_px = kFlowFocal_px * 0.2 / 5;
  CHECK(std::abs(hidden_in_row("occlusion_backward") - (band_px + gone_px)) < 2);
  CHECK(std::abs(hidden_in_row("occlusion_forward") - (band_px + gone_px)) < 2);
}

TEST_CASE("an image that is warped by its flow is the other one where nothing is hidden") {
  Simulation simulation = Simulation::from_string(
      "<simvis>" + kMovingThings + flow_camera("instance object_coordinates flow_backward occlusion") + "</simvis>");
  move_on(simulation, 0);
  const Measurement then = simulation.measurement("CAM");
  move_on(simulation, 1);
  const Measurement now = simulation.measurement("CAM");
  const std::vector<double> flow = flow_numbers(now, "flow_backward"), hidden = flow_numbers(now, "occlusion_backward"),
                            instance = flow_numbers(now, "instance"), other = flow_numbers(then, "instance"),
                            place = flow_numbers(now, "object_coordinates"),
                            other_place = flow_numbers(then, "object_coordinates");
  int compared = 0, inside = 0, differ = 0;
  for (int pixel = 0; pixel < kFlowPixels; ++pixel) {
    const auto i = static_cast<std::size_t>(pixel);
    if (hidden[i] != 0) continue;
    ++compared;
    const glm::dvec2 at = centre_of(pixel) + glm::dvec2(flow[2 * i], flow[2 * i + 1]) - 0.5;
    const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
    if (x < 0 || y < 0 || x + 1 >= kFlowWidth || y + 1 >= kFlowHeight) continue;
    // Between four pixels of one thing its coordinates are those of the point, to within their spread.
    const std::size_t corners[] = {
        static_cast<std::size_t>(y * kFlowWidth + x), static_cast<std::size_t>(y * kFlowWidth + x + 1),
        static_cast<std::size_t>((y + 1) * kFlowWidth + x), static_cast<std::size_t>((y + 1) * kFlowWidth + x + 1)};
    const auto same = std::ranges::count_if(corners, [&](std::size_t c) { return other[c] == instance[i]; });
    if (same == 0) ++differ;
    if (same < 4 || instance[i] == 0) continue;
    ++inside;
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const std::size_t c : corners) {
      const glm::dvec3 each(other_place[3 * c], other_place[3 * c + 1], other_place[3 * c + 2]);
      low = glm::min(low, each);
      high = glm::max(high, each);
    }
    // A flat side is between its corners; a round one may stand out by no more than they are apart.
    const glm::dvec3 spread = high - low, point(place[3 * i], place[3 * i + 1], place[3 * i + 2]);
    const double most = std::max({spread.x, spread.y, spread.z}) + 1e-6;
    for (int c = 0; c < 3; ++c) {
      CHECK(point[c] >= low[c] - most);
      CHECK(point[c] <= high[c] + most);
    }
  }
  CHECK(compared > kFlowPixels / 2);
  CHECK(inside > kFlowPixels / 3);
  CHECK(differ == 0);
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
        flow_camera(std::string("instance range flow_backward scene_flow") + (cast ? " flow_forward occlusion" : ""),
                    "row_time='0.0005' rows_per_pose='12'") +
        "</simvis>");
    const TestLens lens = test_pinhole();
    simulation.step(kStep);
    std::optional<Taken> before;
    double car = 0, crate = 0;
    for (const auto& [car_m, crate_m] : {std::pair(0.1, 0.2), std::pair(0.2, -0.3)}) {
      simulation.set("DRIVE", "x", car += car_m);
      simulation.set("MOVE", "y", crate += crate_m);
      simulation.step(kStep);
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
        if (cast) {
          const Images ahead{*before, now, lens, ""};
          OtherImage next(ahead);
          const FlowCount forward = compare_flow(ahead, now.measurement, "flow_forward", "occlusion_forward", next);
          CHECK(forward.pixels > kFlowPixels * 0.97);
          CHECK(forward.disagree == 0);
        }
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

TEST_CASE("a mesh that bends has the flow of its vertices") {
  TemporaryFolder folder;
  write_text(folder / "strip.gltf", test::bending_strip().text());
  for (const std::string more : {"", " occlusion flow_forward"}) {
    Simulation simulation = Simulation::from_string(
        R"(<part file="strip.gltf" name="STRIP" insert_at="ROOT" up="z"/>
           <element type="animation" name="BEND" insert_at="ROOT" part="STRIP"/>
           <sensor type="camera" name="EYE" insert_at="ROOT" width="64" height="48" hfov="60" pose_offset="0 0 1 0 0 0"
                   outputs="range flow_backward scene_flow)" +
            more + R"("/>)",
        {}, folder.path());
    simulation.set("BEND", "time", 0);
    simulation.step(kStep);
    simulation.set("BEND", "time", 0.5);
    simulation.step(kStep);
    const Measurement measurement = simulation.measurement("EYE");
    const std::vector<double> range = flow_numbers(measurement, "range"),
                              flow = flow_numbers(measurement, "flow_backward"),
                              scene = flow_numbers(measurement, "scene_flow");
    const double f_px = 32 / std::tan(30 * std::numbers::pi / 180), angle = 0.5 * std::numbers::pi / 4;
    int bent = 0, straight = 0;
    for (int pixel = 0; pixel < 64 * 48; ++pixel) {
      const auto i = static_cast<std::size_t>(pixel);
      if (std::isinf(range[i])) continue;
      const double x = (pixel % 64 + 0.5 - 32) / f_px, y = (pixel / 64 + 0.5 - 24) / f_px;
      // Upper rows look above the hinge, which is at the height of the camera, 3 m before it; y is down. The point lies
      // h along the strip from the hinge: 3 + h sin a ahead and h cos a up; before it was 3 ahead and h up.
      const double h = -y * 3 / (std::cos(angle) + y * std::sin(angle));
      const bool above = y < 0;
      const double ahead = above ? 3 + h * std::sin(angle) : 3;
      const double then_x = above ? x * ahead / 3 : x, then_y = above ? -h / 3 : y;
      CHECK(std::abs(flow[2 * i] - f_px * (then_x - x)) <= kFlow_px);
      CHECK(std::abs(flow[2 * i + 1] - f_px * (then_y - y)) <= kFlow_px);
      CHECK(std::abs(scene[3 * i + 2] - (ahead - 3)) <= 1e-5);
      CHECK(std::abs(scene[3 * i + 1] - (above ? h - h * std::cos(angle) : 0)) <= 1e-5);
      ++(above ? bent : straight);
    }
    CHECK(bent > 500);
    CHECK(straight > 500);
  }
}

TEST_CASE("skipped frames, new things and other frames made again change no flow") {
  const std::string scene = "<simvis>" + kMovingThings +
                            flow_camera("color instance flow_backward flow_forward scene_flow occlusion") + "</simvis>";
  const auto all_of = [](const Simulation& simulation) {
    std::vector<std::uint64_t> bits;
    for (const char* const name :
         {"flow_backward", "flow_forward", "scene_flow", "occlusion_backward", "occlusion_forward"}) {
      for (const double number : flow_numbers(simulation.measurement("CAM"), name)) {
        bits.push_back(std::bit_cast<std::uint64_t>(number));
      }
    }
    return bits;
  };
  Simulation every = Simulation::from_string(scene), some = Simulation::from_string(scene);
  const auto advance = [](Simulation& simulation, int frame, bool skips) {
    simulation.set("DRIVE", "x", 0.1 * frame);
    simulation.set("MOVE", "y", 0.2 * frame);
    skips ? simulation.skip_frame() : simulation.step();
  };
  for (int frame = 0; frame < 5; ++frame) {
    const bool skips = frame % 2 == 0;
    advance(every, frame, false);
    advance(some, frame, skips);
    if (!skips) CHECK(all_of(some) == all_of(every));
  }
  // A part in front of the others in the list gives items other numbers, and no flow.
  const std::vector<double> before = flow_numbers(every.measurement("CAM"), "instance");
  every.execute("<part name='A' insert_at='ROOT' shape='sphere' radius='1' pose_offset='-9 0 0 0 0 0'/>");
  every.step();
  for (const double number : flow_numbers(every.measurement("CAM"), "flow_backward")) {
    CHECK(std::abs(number) <= kFlow_px);
  }
}

TEST_CASE("flow that is not asked for costs nothing, and backward flow of what is drawn casts no ray") {
  const auto work = [](const std::string& outputs) {
    Simulation simulation = Simulation::from_string("<simvis>" + kMovingThings + flow_camera(outputs) + "</simvis>");
    move_on(simulation, 0);
    move_on(simulation, 1);
    const Diagnostics diagnostics = simulation.diagnostics();
    return std::tuple(diagnostics.counters(), diagnostics.ray_counters().rays, diagnostics.motions_followed());
  };
  CHECK(work("color instance") == work("color instance flow_backward scene_flow"));
  // Only the outlines of round shapes are cast, as for ids.
  CHECK(work("color flow_backward") == work("color instance"));
  CHECK(std::get<1>(work("color flow_backward")) < kFlowPixels / 3);
  CHECK(std::get<1>(work("color flow_backward occlusion")) >= kFlowPixels);
}

TEST_CASE("occlusion without flow is an error at its place") {
  const std::string error = error_of([&] {
    Simulation::from_string("<simvis>" + kMovingThings + "\n" + flow_camera("color occlusion") + "</simvis>", {}, ".",
                            "s");
  });
  CHECK(contains(error,
                 ": error: attribute \"outputs\": occlusion is that of a flow, expected flow_backward or "
                 "flow_forward beside it"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
