// Paths along chains of joints against closed forms in long double; between frames, far away, and as the graph changes.
#include "scenegraph/scene_motion.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <vector>

#include <simvis/node.h>
#include <simvis/pose.h>
#include "scenegraph/motion.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr double kU = 0x1p-53;
constexpr std::int64_t kStep_ns = 10'000'000;

using Real = long double;
using RealMatrix = glm::mat<4, 4, Real>;

std::shared_ptr<Shape> chain_shape() {
  auto mesh = std::make_shared<Mesh>();
  mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh->attributes.resize(3);
  mesh->indices = {0, 1, 2};
  compute_bounds(*mesh);
  return std::make_shared<Shape>(mesh);
}

/// An arm of two joints: a shoulder that turns about z, and at `kUpper_m` along x an elbow that turns about y. The hand
/// is at `kLower_m` from the elbow.
constexpr double kUpper_m = 0.7, kLower_m = 0.4;

/// The matrix of a turn about z (0 about y), in closed form.
RealMatrix turned(bool about_z, Real angle) {
  const Real c = std::cos(angle), s = std::sin(angle);
  RealMatrix m(1);
  const int a = about_z ? 0 : 2, b = about_z ? 1 : 0;
  m[a][a] = c;
  m[a][b] = s;
  m[b][a] = -s;
  m[b][b] = c;
  return m;
}
RealMatrix shifted(const glm::vec<3, Real>& way) {
  RealMatrix m(1);
  m[3] = glm::vec<4, Real>(way, 1);
  return m;
}

struct Angles {
  Real shoulder = 0, elbow = 0;
};
RealMatrix hand_pose(const glm::dvec3& base_m, const Angles& at) {
  return shifted(glm::vec<3, Real>(base_m)) * turned(true, at.shoulder) * shifted({kUpper_m, 0, 0}) *
         turned(false, at.elbow) * shifted({kLower_m, 0, 0});
}

class Arm {
 public:
  explicit Arm(const glm::dvec3& base_m, const glm::dmat4& scale = glm::dmat4(1)) {
    root->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), base_m)));
    root->add(std::make_shared<Transform>(scale));
    root->add(shoulder);
    root->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), {kUpper_m, 0, 0})));
    root->add(elbow);
    root->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), {kLower_m, 0, 0})));
    root->add(chain_shape());
  }
  void set(const Angles& at) {
    shoulder->set_matrix(glm::dmat4(turned(true, at.shoulder)));
    elbow->set_matrix(glm::dmat4(turned(false, at.elbow)));
  }
  const DrawList& frame(const Angles& at, std::int64_t number) {
    set(at);
    const DrawList& list = flattener.update();
    motion.update(flattener, list, number * kStep_ns);
    return list;
  }
  /// The path of the hand over these frames.
  std::shared_ptr<const MotionPath> path(const std::vector<std::int64_t>& frames) const {
    std::vector<std::int64_t> times_ns;
    for (const std::int64_t frame : frames) times_ns.push_back(frame * kStep_ns);
    return motion.paths(times_ns)[flattener.item_transform(0)];
  }

  std::shared_ptr<Group> root = std::make_shared<Group>();
  std::shared_ptr<Transform> shoulder = std::make_shared<Transform>(), elbow = std::make_shared<Transform>();
  Flattener flattener{root};
  SceneMotion motion;
};

double error_m(const glm::dmat4& pose, const RealMatrix& expected) {
  double error = 0;
  for (int i = 0; i < 4; ++i)
    error = std::max(error, static_cast<double>(glm::length(RealMatrix(pose)[i] - expected[i])));
  return error;
}

TEST_CASE("a frame that failed is forgotten if the next one is earlier, whether anything moves in it or not") {
  for (const Angles& to : {Angles{0.3L, 0.1L}, Angles{}}) {
    Arm arm({0, 0, 0}), expected({0, 0, 0});
    for (Arm* const each : {&arm, &expected}) each->frame({}, 0);
    arm.frame({1.0L, -0.5L}, 4);  // this frame fails
    const DrawList& list = arm.frame(to, 2);
    expected.frame(to, 2);
    CHECK(arm.motion.times_from(0) == std::vector<std::int64_t>{0, 2 * kStep_ns});
    const auto path = arm.path({0, 2}), expected_path = expected.path({0, 2});
    REQUIRE((path == nullptr) == (expected_path == nullptr));
    if (path == nullptr) continue;
    const glm::dmat4& now = list.world_from_node[list.items[0].transform];
    CHECK(place_at(*path, -0.5, now) == place_at(*expected_path, -0.5, now));
  }
}

TEST_CASE("a hand on two joints moves along them, not on a screw of its own") {
  for (const double away_m : {0.0, 1e6}) {
    for (const Angles& to : {Angles{0.5L, 0}, Angles{0.5L, -1.2L}, Angles{-2.8L, 2.9L}, Angles{1e-7L, 2e-7L}}) {
      CAPTURE(away_m);
      CAPTURE(static_cast<double>(to.shoulder));
      const glm::dvec3 base_m(away_m, -away_m / 2, 1);
      const Angles from{0.3L, 0.2L};
      const auto between = [&](Real share) {  // 0 to 1
        return Angles{from.shoulder + share * (to.shoulder - from.shoulder),
                      from.elbow + share * (to.elbow - from.elbow)};
      };
      Arm arm(base_m);
      arm.frame(from, 0);
      const DrawList& list = arm.frame(to, 1);
      const auto path = arm.path({0, 1});
      REQUIRE(path != nullptr);
      const glm::dmat4& now = list.world_from_node[list.items[0].transform];
      // Poses of the world: four products of six roundings, of places in the world. Each joint's angle and turn: forty
      // roundings of the arm's length of 1.1 m, for turns up to pi.
      const double tolerance_m = 24 * kU * (2 * away_m + 2) + 2 * 40 * kU * 1.1 * (1 + 3.2);
      for (const double share : {-1.0, -0.75, -0.3, 0.0, -1.4}) {
        CHECK(error_m(place_at(*path, share, now), hand_pose(base_m, between(1 + Real(share)))) <= tolerance_m);
      }
    }
  }
}

TEST_CASE("a path goes through the poses of all frames, and between them along the joints") {
  constexpr int kFrames = 10;
  const auto at = [](Real frame) { return Angles{std::sin(frame), 0.5L * std::cos(2 * frame)}; };
  Arm arm({2, 0, 0});
  for (int frame = 0; frame <= kFrames; ++frame) arm.frame(at(frame), frame);
  const DrawList& list = arm.flattener.update();
  std::vector<std::int64_t> frames;
  for (int frame = 4; frame <= kFrames; ++frame) frames.push_back(frame);
  const auto path = arm.path(frames);
  REQUIRE(path != nullptr);
  REQUIRE(path->pieces.size() == 6);
  constexpr double kRounding_m = 40 * kU * 4 * 4;  // forty roundings of poses within 4 m, of four displacements
  for (const double frame : {4.0, 4.5, 5.0, 6.25, 9.0, 9.9, 10.0}) {
    CAPTURE(frame);
    const Real first = std::floor(Real(frame)), part = Real(frame) - first;
    const Angles from = at(first), to = at(first + 1);
    const Angles expected{from.shoulder + part * (to.shoulder - from.shoulder),
                          from.elbow + part * (to.elbow - from.elbow)};
    const glm::dmat4 place = place_at(*path, (frame - 10) / 6, list.world_from_node[list.items[0].transform]);
    CHECK(error_m(place, hand_pose({2, 0, 0}, expected)) <= kRounding_m);
  }
  CHECK(arm.motion.times_from(7 * kStep_ns).size() == 4);
  arm.motion.forget_before(7 * kStep_ns);
  CHECK(arm.motion.times_from(0).size() == 4);
  const auto kept = arm.path({7, 8, 9, 10});
  REQUIRE(kept != nullptr);
  CHECK(arm.path({6, 10}) == nullptr);  // unknown
}

TEST_CASE("a frame that is made again replaces its poses") {
  Arm arm({0, 0, 0});
  arm.frame({0, 0}, 0);
  arm.frame({1, 1}, 1);
  const DrawList& list = arm.frame({0.5L, 0}, 1);
  const auto path = arm.path({0, 1});
  REQUIRE(path != nullptr);
  REQUIRE(path->pieces.size() == 1);
  CHECK(path->pieces[0].joints.size() == 1);
  constexpr double kRounding_m = 80 * kU * 4;
  CHECK(error_m(place_at(*path, -0.5, list.world_from_node[list.items[0].transform]),
                hand_pose({0, 0, 0}, {0.25L, 0})) <= kRounding_m);
}

TEST_CASE("a chain may be scaled or mirrored as a whole; one that is stretched has no path") {
  constexpr double kRounding_m = 200 * kU * 4;  // as above, and five products and inverses of scaled matrices
  const Angles from{0.3L, 0.2L}, to{1.1L, -0.7L}, half{0.7L, -0.25L};
  for (const glm::dvec3& scale : {glm::dvec3(0.25), glm::dvec3(1, -1, 1), glm::dvec3(-2)}) {
    CAPTURE(scale.x);
    const glm::dmat4 scaled = glm::scale(glm::dmat4(1), scale);
    Arm arm({0, 0, 0}, scaled);
    arm.frame(from, 0);
    const DrawList& list = arm.frame(to, 1);
    const auto path = arm.path({0, 1});
    REQUIRE(path != nullptr);
    const glm::dmat4 place = place_at(*path, -0.5, list.world_from_node[list.items[0].transform]);
    CHECK(error_m(place, RealMatrix(scaled) * hand_pose({0, 0, 0}, half)) <= kRounding_m);
  }
  Arm stretched({0, 0, 0}, glm::scale(glm::dmat4(1), {1, 2, 1}));
  stretched.frame(from, 0);
  stretched.frame(to, 1);
  CHECK(stretched.path({0, 1}) == nullptr);
  // A joint about the axis along which it is stretched turns nevertheless.
  Arm along({0, 0, 0}, glm::scale(glm::dmat4(1), {1, 1, 3}));
  along.frame({0.3L, 0.2L}, 0);
  along.frame({0.9L, 0.2L}, 1);
  CHECK(along.path({0, 1}) != nullptr);
}

TEST_CASE("the matter of an item moves with its transform, also when the graph changes around it") {
  const auto root = std::make_shared<Group>();
  const auto arm = std::make_shared<Separator>(), other = std::make_shared<Separator>();
  const auto turn = std::make_shared<Transform>(),
             size = std::make_shared<Transform>(glm::scale(glm::dmat4(1), {2, 3, 4}));
  arm->add(turn);
  arm->add(size);
  arm->add(chain_shape());
  other->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), {0, 5, 0})));
  other->add(chain_shape());
  root->add(arm);
  Flattener flattener(root);
  SceneMotion motion;
  constexpr double kStep_s = 0.01;
  const glm::dvec3 centre(1, 0, 0);
  std::int64_t now_ns = 0;
  const auto frame = [&](const glm::dmat4& pose) {
    turn->set_matrix(pose);
    now_ns += kStep_ns;
    motion.update(flattener, flattener.update(), now_ns);
  };
  const auto turned_by = [&](double angle) {
    return glm::rotate(glm::translate(glm::dmat4(1), centre), angle, {0, 0, 1});
  };
  const auto velocity = [&](std::uint32_t item, const glm::dvec3& point) {
    const std::uint32_t transform = flattener.item_transform(item);
    const std::optional<glm::dmat4> before = motion.world_from_node(now_ns - kStep_ns)[transform];
    const glm::dmat4 now = motion.world_from_node(now_ns)[transform].value();
    return before ? matter_velocity_mps(*before, now, point, kStep_s) : glm::dvec3(0);
  };
  const glm::dvec3 point(3, 2, 1), expected = glm::cross(glm::dvec3(0, 0, 2), point - centre);
  // The difference of two poses within 5 m, of 30 roundings, over a step; turned by two radians per second.
  constexpr double kTolerance_mps = 4 * 2 * 30 * kU * 5 / kStep_s;
  frame(turned_by(0));
  frame(turned_by(2 * kStep_s));
  CHECK(glm::length(velocity(0, point) - expected) <= kTolerance_mps);
  root->insert_before(*arm, other);  // the arm's item is the second one from now on
  frame(turned_by(4 * kStep_s));
  CHECK(velocity(0, point) == glm::dvec3(0));
  CHECK(glm::length(velocity(1, point) - expected) <= kTolerance_mps);
  CHECK(motion.paths(std::vector{now_ns - kStep_ns, now_ns})[flattener.item_transform(0)] == nullptr);
  CHECK(motion.paths(std::vector{now_ns - kStep_ns, now_ns})[flattener.item_transform(1)] != nullptr);
  // A body that grows from the origin of its frame.
  size->set_matrix(glm::scale(glm::dmat4(1), {4, 6, 8}));
  frame(glm::dmat4(1));
  size->set_matrix(glm::scale(glm::dmat4(1), {8, 12, 16}));
  frame(glm::dmat4(1));
  CHECK(glm::length(velocity(1, {1, 1, 1}) - glm::dvec3(0.5 / kStep_s)) <= kTolerance_mps * 2);
  CHECK(motion.paths(std::vector{now_ns - kStep_ns, now_ns})[flattener.item_transform(1)] == nullptr);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
