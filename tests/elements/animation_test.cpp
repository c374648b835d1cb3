// The element `animation`: the places of nodes and vertices at a time, computed here from the keys, and the results of
// sensors.
#include "elements/animation.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/parts/animated_part.h"

TEST_SUITE_BEGIN("elements");

using namespace simvis;
using namespace simvis::test;

namespace {

// A few products and sums in double of values up to 16.
constexpr double kDouble = 16 * 8 * 0x1p-53;
// Coordinates up to 4, rounded to float32 once: half a step of 2^-22.
constexpr double kFloat_m = 0x1p-23;

void check_near(const glm::dvec3& seen, const glm::dvec3& expected, double tolerance) {
  for (int i = 0; i < 3; ++i) CHECK(std::abs(seen[i] - expected[i]) <= tolerance);
}
void check_near(const glm::dmat4& seen, const glm::dmat4& expected) {
  for (int i = 0; i < 16; ++i) CHECK(std::abs(seen[i / 4][i % 4] - expected[i / 4][i % 4]) <= kDouble);
}

const std::vector<float> kTimes{1, 2, 4};

// A triangle, node 0, scaled by 2 and turned by a quarter about z at rest, and one channel for it.
GltfBuilder moved_triangle(const char* path, const char* type, const char* interpolation,
                           const std::vector<float>& values) {
  GltfBuilder builder;
  builder.triangle();
  const double half = std::sqrt(0.5);
  builder.root["nodes"][0].update({{"translation", {7, 8, 9}}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}});
  add_clip(builder, "Move");
  add_channel(builder, 0, path, interpolation, builder.accessor<float>("SCALAR", kTimes),
              builder.accessor<float>(type, values));
  return builder;
}

// The interval of kTimes that contains `time`, and the share of it that has passed, clamped to both ends.
struct Interval {
  std::size_t key;
  double part, length;
};
Interval interval(double time) {
  if (time <= 1) return {0, 0, 1};
  if (time < 2) return {0, time - 1, 1};
  if (time < 4) return {1, (time - 2) / 2, 2};
  return {1, 1, 2};
}

double hermite(double p0, double m0, double p1, double m1, double t) {
  return (2 * t * t * t - 3 * t * t + 1) * p0 + (t * t * t - 2 * t * t + t) * m0 + (3 * t * t - 2 * t * t * t) * p1 +
         (t * t * t - t * t) * m1;
}

glm::dmat4 turn_z(double angle) {
  return glm::dmat4(std::cos(angle), std::sin(angle), 0, 0, -std::sin(angle), std::cos(angle), 0, 0, 0, 0, 1, 0, 0, 0,
                    0, 1);
}

// A triangle with two morph targets; the weights go from (0, 1) to (1, 0.5) in 2 s.
GltfBuilder morphing_triangle() {
  GltfBuilder builder;
  json& primitive = builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                                       {"NORMAL", builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1})}});
  primitive["targets"] = {{{"POSITION", builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 0, 0, 0, 0})},
                           {"NORMAL", builder.accessor<float>("VEC3", {1, 0, 0, 0, 0, 0, 0, 0, 0})}},
                          {{"POSITION", builder.accessor<float>("VEC3", {0.5f, 0, 0, 0, 0, 0, 0, 3, 0})}}};
  add_clip(builder, "Morph");
  add_channel(builder, 0, "weights", "LINEAR", builder.accessor<float>("SCALAR", {0, 2}),
              builder.accessor<float>("SCALAR", {0, 1, 1, 0.5f}));
  return builder;
}

}  // namespace

TEST_CASE("translations are interpolated between keys; values without a channel stay as in the file") {
  const std::vector<glm::dvec3> keys{{0, 0, 0}, {1, -2, 3}, {4, 4, 4}}, in{{9, 9, 9}, {1, 0, -1}, {0.5, 2, 0}},
      out{{1, 2, 3}, {-1, 0, 2}, {9, 9, 9}};
  std::vector<float> plain, cubic;
  const auto append = [](std::vector<float>& values, const glm::dvec3& v) {
    for (int i = 0; i < 3; ++i) values.push_back(static_cast<float>(v[i]));
  };
  for (std::size_t k = 0; k < 3; ++k) {
    append(plain, keys[k]);
    for (const auto* each : {&in, &keys, &out}) append(cubic, (*each)[k]);
  }
  PlayedPart step(moved_triangle("translation", "VEC3", "STEP", plain), "repeat='once'");
  PlayedPart linear(moved_triangle("translation", "VEC3", "LINEAR", plain), "repeat='once'");
  PlayedPart spline(moved_triangle("translation", "VEC3", "CUBICSPLINE", cubic), "repeat='once'");
  for (const double time : {-5.0, 0.0, 1.0, 1.25, 1.999, 2.0, 2.5, 3.7, 4.0, 1e9}) {
    CAPTURE(time);
    const auto [k, t, length] = interval(time);
    check_near(glm::dvec3(step.matrix_at(time)[3]), t == 1 ? keys[k + 1] : keys[k], 0);
    check_near(glm::dvec3(linear.matrix_at(time)[3]), keys[k] + t * (keys[k + 1] - keys[k]), kDouble);
    glm::dvec3 curve;
    for (int i = 0; i < 3; ++i) {
      curve[i] = hermite(keys[k][i], length * out[k][i], keys[k + 1][i], length * in[k + 1][i], t);
    }
    check_near(glm::dvec3(spline.matrix_at(time)[3]), curve, kDouble);
    // A quarter turn and twice the size.
    glm::dmat4 expected(0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1);
    expected[3] = glm::dvec4(curve, 1);
    check_near(spline.matrix_at(time), expected);
  }
}

TEST_CASE("scales are interpolated and may mirror a part") {
  PlayedPart part(moved_triangle("scale", "VEC3", "LINEAR", {1, 1, 1, 3, 1, -1, 3, 1, -1}));
  check_near(part.matrix_at(1.5), glm::dmat4(0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 7, 8, 9, 1));
  check_near(part.matrix_at(3), glm::dmat4(0, 3, 0, 0, -1, 0, 0, 0, 0, 0, -1, 0, 7, 8, 9, 1));
}

TEST_CASE("rotations turn at a constant rate along the shorter arc") {
  const auto about_z = [](double degrees, double sign) {
    const double half = degrees * M_PI / 360;
    return std::vector<float>{0, 0, static_cast<float>(sign * std::sin(half)),
                              static_cast<float>(sign * std::cos(half))};
  };
  // The second key is the same rotation as its negative. From 130 to 300 degrees the shorter arc passes through 215.
  std::vector<float> keys = about_z(10, 1);
  for (const auto& key : {about_z(130, -1), about_z(300, 1)}) keys.insert(keys.end(), key.begin(), key.end());
  const auto angle = [&](std::size_t key) {
    return 2 * std::atan2(keys[4 * key + 2], static_cast<double>(keys[4 * key + 3]));
  };
  GltfBuilder builder = moved_triangle("rotation", "VEC4", "LINEAR", keys);
  builder.root["nodes"][0].erase("scale");
  builder.root["nodes"][0].erase("translation");
  PlayedPart linear(builder, "repeat='once'");
  const double second = angle(1) + 2 * M_PI;  // of the negative quaternion: beyond 180 degrees
  for (const double time : {0.0, 1.0, 1.25, 1.5, 1.9}) {
    CAPTURE(time);
    check_near(linear.matrix_at(time), turn_z(angle(0) + interval(time).part * (second - angle(0))));
  }
  for (const double time : {2.0, 2.5, 3.0, 4.0}) {
    CAPTURE(time);
    check_near(linear.matrix_at(time), turn_z(second + interval(time).part * (angle(2) - second)));
  }
  builder.root["animations"][0]["samplers"][0]["interpolation"] = "STEP";
  PlayedPart step(builder, "repeat='once'");
  check_near(step.matrix_at(1.99), turn_z(angle(0)));
  check_near(step.matrix_at(2), turn_z(second));
}

TEST_CASE("rotations along splines have unit length") {
  const double half = std::sqrt(0.5);
  const auto h = static_cast<float>(half);
  // In-tangent, key, out-tangent: no rotation, a quarter about x, the same.
  const std::vector<float> keys{0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 2, 0, 0, h, 0,
                                0, h, 0, 0, 0, 0, 0, 0, 0, 0, h, 0, 0, h, 0, 0, 0, 0};
  GltfBuilder builder = moved_triangle("rotation", "VEC4", "CUBICSPLINE", keys);
  builder.root["nodes"][0].erase("scale");
  PlayedPart part(builder, "repeat='once'");
  const double t = 0.25;
  glm::dvec4 q(hermite(0, 1, h, 0, t), hermite(0, 0, 0, 2, t), 0, hermite(1, 0, h, 0, t));
  q /= glm::length(q);
  const glm::dmat4 m = part.matrix_at(1 + t);
  // The turned axes, by the formula q v q^-1 written out.
  check_near(glm::dvec3(m[0]), {1 - 2 * q.y * q.y, 2 * q.x * q.y, -2 * q.w * q.y}, kDouble);
  check_near(glm::dvec3(m[1]), {2 * q.x * q.y, 1 - 2 * q.x * q.x, 2 * q.w * q.x}, kDouble);
  check_near(glm::dvec3(m[2]), {2 * q.w * q.y, -2 * q.w * q.x, 1 - 2 * (q.x * q.x + q.y * q.y)}, kDouble);
}

TEST_CASE("a skinned strip bends with its joint") {
  PlayedPart part(bending_strip(), "repeat='once'");
  for (const double time : {0.0, 0.5, 1.0, 1.25, 2.0}) {
    CAPTURE(time);
    const double a = time * M_PI / 4;
    const Mesh mesh = part.mesh_at(time);
    REQUIRE(mesh.positions.size() == 6);
    CHECK(part.matrix_at(time) == glm::dmat4(1));
    for (const double y : {-2.0, 2.0}) {
      const std::size_t side = y > 0 ? 1 : 0;
      check_near(glm::dvec3(mesh.positions[side]), {3, y, 0}, kFloat_m);
      check_near(glm::dvec3(mesh.positions[2 + side]), {3, y, 1}, kFloat_m);
      check_near(glm::dvec3(mesh.positions[4 + side]), {3 + std::sin(a), y, 1 + std::cos(a)}, kFloat_m);
      check_near(glm::dvec3(mesh.attributes[side].normal), {-1, 0, 0}, kFloat_m);
      // The mean of a rotation by 0 and one by a is a rotation by a / 2, shrunk.
      check_near(glm::dvec3(mesh.attributes[2 + side].normal), {-std::cos(a / 2), 0, std::sin(a / 2)}, kFloat_m);
      check_near(glm::dvec3(mesh.attributes[4 + side].normal), {-std::cos(a), 0, std::sin(a)}, kFloat_m);
    }
    CHECK(mesh.bounds_max.z == std::max(mesh.positions[4].z, 1.0f));
    CHECK(mesh.bounds_max.x == mesh.positions[4].x);
  }
}

TEST_CASE("normals that are missing in the file are those of the bent triangles") {
  GltfBuilder builder = bending_strip();
  builder.root["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
  PlayedPart part(builder, "repeat='once'");
  const Mesh& mesh = part.mesh_at(1);
  REQUIRE(mesh.positions.size() == 12);
  check_near(glm::dvec3(mesh.attributes[0].normal), {-1, 0, 0}, kFloat_m);
  // Rounding of float32 corners: it turns a triangle of 1 m by this.
  check_near(glm::dvec3(mesh.attributes[11].normal), {-std::sqrt(0.5), 0, std::sqrt(0.5)}, 4 * kFloat_m);
}

TEST_CASE("morph weights are interpolated") {
  PlayedPart part(morphing_triangle(), "repeat='once'");
  for (const double time : {0.0, 0.5, 1.5, 2.0, 3.0}) {
    CAPTURE(time);
    const double t = std::min(time / 2, 1.0), a = t, b = 1 - 0.5 * t;
    const Mesh& mesh = part.mesh_at(time);
    check_near(glm::dvec3(mesh.positions[0]), {0.5 * b, 0, a}, kFloat_m);
    check_near(glm::dvec3(mesh.positions[1]), {1, 0, 0}, 0);
    check_near(glm::dvec3(mesh.positions[2]), {0, 1 + 3 * b, 0}, kFloat_m);
    check_near(glm::dvec3(mesh.attributes[0].normal), glm::normalize(glm::dvec3(a, 0, 1)), kFloat_m);
    CHECK(mesh.attributes[1].normal == glm::vec3(0, 0, 1));
  }
}

TEST_CASE("if two nodes share a mesh, the node without weights of its own keeps the mesh's weights") {
  GltfBuilder builder = morphing_triangle();
  builder.append("nodes", {{"mesh", 0}, {"translation", {0, 5, 0}}});
  PlayedPart part(builder, "repeat='once'");
  CHECK(part.mesh_at(2, 0).positions[0] == glm::vec3(0.25f, 0, 1));
  CHECK(part.mesh_at(2, 1).positions[0] == glm::vec3(0));
}

TEST_CASE("sensors see the part as it is at each time") {
  TemporaryFolder folder;
  write_text(folder / "strip.gltf", bending_strip().text());
  // The beams are horizontal, half a metre above the hinge. The camera is lower and looks at the part that does not
  // bend.
  Simulation simulation = Simulation::from_string(R"(
    <part file="strip.gltf" name="STRIP" insert_at="ROOT" up="z"/>
    <element type="animation" name="BEND" insert_at="ROOT" part="STRIP"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3" min_angle="-10" max_angle="10" method="planar"
            pose_offset="0 0 1.5 0 0 0"/>
    <sensor type="camera" name="EYE" insert_at="ROOT" width="8" height="8" hfov="20" outputs="depth"
            pose_offset="0 0 1 0 0 0"/>)",
                                                  {}, folder.path());
  // The strip in the view of a camera at the height of its hinge: upper rows show the bent half, lower rows the other.
  for (const double time : {0.0, 1.0, 0.5, 1.75, 0.0}) {
    CAPTURE(time);
    simulation.set("BEND", "time", time);
    simulation.step();
    const double a = time * M_PI / 4;
    const double height = 0.5 / std::cos(a);  // above the hinge, along the strip, where the beams meet it
    const Scan& scan = simulation.scan("SCAN");
    for (std::size_t beam = 0; beam < 3; ++beam) {
      CAPTURE(beam);
      const double expected_m = (3 + height * std::sin(a)) / std::cos(scan.azimuth_rad[beam]);
      if (height > 1) {
        CHECK(std::isinf(scan.range_m[beam]));
      } else {
        CHECK(std::abs(scan.range_m[beam] - expected_m) <= scan.error_bound_m[beam]);
      }
    }
    const Image& depth = simulation.depth("EYE");
    // Depth is stored as near / z in float32: a relative step of 2^-24, and several for the setup of the plane.
    constexpr double kDepth = 1e-4;
    const double pitch = std::tan(10 * M_PI / 180) / 4;  // between rows, at a depth of 1
    for (std::size_t row = 0; row < 8; ++row) {
      CAPTURE(row);
      const double slope = (3.5 - static_cast<double>(row)) * pitch;  // up per metre forward
      // z - 1 = slope * x meets the bent half, x = 3 + h sin a and z - 1 = h cos a, or the other half, x = 3.
      const double h = 3 * slope / (std::cos(a) - slope * std::sin(a));
      const double expected_m = slope < 0 ? 3 : 3 + h * std::sin(a);
      if (slope > 0 && h > 0.95) continue;
      CHECK(std::abs(depth.pixels[row * 8 + 4] - expected_m) <= kDepth * expected_m);
    }
  }
}

TEST_CASE("of two parts from one file only the animated one moves, and unmoved content is shared") {
  GltfBuilder builder = bending_strip();
  builder.append("meshes", {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 0}}}}});
  builder.append("nodes", {{"mesh", 1}});  // node 3 does not move
  builder.root["scenes"][0]["nodes"] = {0, 1, 3};
  PlayedPart part(builder, "", "<part file='part.gltf' name='Q' insert_at='ROOT' up='z' pose_offset='9 0 0 0 0 0'/>");
  const DrawList before = part.at(0);
  const DrawList after = part.at(1.5);
  REQUIRE(after.items.size() == 4);
  // The skinned strip stands at the end of the root: items 1 and 3 are strips. Parts are inserted one after the other.
  const auto mesh = [](const DrawList& list, std::size_t item) { return list.meshes[list.items[item].mesh]; };
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < 4; ++i) {
    if (mesh(before, i) != mesh(after, i)) changed.push_back(i);
  }
  REQUIRE(changed.size() == 1);
  CHECK(changed[0] < 2);
  CHECK(mesh(after, 1 - changed[0]) == mesh(after, 3 - changed[0]));
  CHECK(mesh(after, 2 + changed[0])->positions[5] == glm::vec3(3, 2, 2));
  // The node of the joint turns, but it has no shape.
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(before.world_from_node[before.items[i].transform] == after.world_from_node[after.items[i].transform]);
  }
}

TEST_CASE("two copies of one file are animated independently") {
  TemporaryFolder folder;
  for (const char* name : {"a.gltf", "b.gltf"}) write_text(folder / name, bending_strip().text());
  const BuiltScene built = build_scene(parse_commands(R"(
    <part file="a.gltf" name="A" insert_at="ROOT" up="z"/>
    <part file="b.gltf" name="B" insert_at="ROOT" up="z"/>
    <element type="animation" name="WALK_A" insert_at="ROOT" part="A" time="1"/>
    <element type="animation" name="WALK_B" insert_at="ROOT" part="B" repeat="once" time="2"/>)",
                                                      "s.xml", folder.path()));
  Flattener flattener(built.scene.root());
  const DrawList& list = flattener.update();
  std::vector<float> heights;
  for (const DrawItem& item : list.items) heights.push_back(list.meshes[item.mesh]->bounds_max.z);
  std::ranges::sort(heights);
  REQUIRE(heights.size() == 2);
  CHECK(heights[0] == 1);
  CHECK(std::abs(heights[1] - (1 + std::sqrt(0.5))) <= kFloat_m);
}

TEST_CASE("clips of different nodes of a part play at the same time") {
  GltfBuilder builder = moved_triangle("translation", "VEC3", "STEP", {1, 0, 0, 2, 0, 0, 3, 0, 0});
  builder.append("nodes", {{"mesh", 0}});
  add_clip(builder, "Other");
  add_channel(builder, 1, "translation", "LINEAR", builder.accessor<float>("SCALAR", {0, 1}),
              builder.accessor<float>("VEC3", {0, 0, 0, 0, 4, 0}), 1);
  TemporaryFolder folder;
  write_text(folder / "part.gltf", builder.text());
  BuiltScene built = build_scene(parse_commands(R"(
    <part file="part.gltf" name="P" insert_at="ROOT" up="z"/>
    <element type="animation" name="A" insert_at="ROOT" part="P" time="2"/>
    <element type="animation" name="B" insert_at="ROOT" part="P" clip="Other" time="0.5"/>)",
                                                "s.xml", folder.path()));
  const DrawList list = Flattener(built.scene.root()).update();
  REQUIRE(list.items.size() == 2);
  CHECK(list.world_from_node[list.items[0].transform][3] == glm::dvec4(2, 0, 0, 1));
  CHECK(list.world_from_node[list.items[1].transform][3] == glm::dvec4(0, 2, 0, 1));
}

TEST_CASE("loops are exact at large times, forwards and backwards") {
  const auto at_end = [](float end) {
    GltfBuilder builder = moved_triangle("translation", "VEC3", "LINEAR", {0, 0, 0, 1, 2, 3, 4, 4, 4});
    builder.root["animations"][0]["samplers"][0]["input"] = builder.accessor<float>("SCALAR", {0, end / 2, end});
    return builder;
  };
  PlayedPart three_quarters(at_end(0.75f));
  CHECK(three_quarters.matrix_at(1e6) == three_quarters.matrix_at(0.25));  // 1333333 rounds and a third of one
  CHECK(three_quarters.matrix_at(-0.25) == three_quarters.matrix_at(0.5));
  CHECK(three_quarters.matrix_at(0.75) == three_quarters.matrix_at(0));
  // 1.3 in float32 is a whole number of 2^-23 s, and so is a million; the remainder is computed with integers.
  const auto end = static_cast<std::uint64_t>(1.3f * 0x1p23);
  const double rest = static_cast<double>((1000000ull << 23) % end) * 0x1p-23;
  PlayedPart odd(at_end(1.3f));
  CHECK(odd.matrix_at(1e6) == odd.matrix_at(rest));
  const double part = rest < 1.3f / 2 ? 2 * rest / 1.3f : 2 * rest / 1.3f - 1;
  const glm::dvec3 from = rest < 1.3f / 2 ? glm::dvec3(0) : glm::dvec3(1, 2, 3);
  const glm::dvec3 to = rest < 1.3f / 2 ? glm::dvec3(1, 2, 3) : glm::dvec3(4);
  check_near(glm::dvec3(odd.matrix_at(1e6)[3]), from + part * (to - from), kDouble);
  PlayedPart once(at_end(0.75f), "repeat='once'");
  CHECK(once.matrix_at(1e6)[3] == glm::dvec4(4, 4, 4, 1));
  CHECK(once.matrix_at(-1)[3] == glm::dvec4(0, 0, 0, 1));
}

TEST_CASE("after a return to an earlier time all bytes are the same as before") {
  for (const GltfBuilder& builder : {bending_strip(), morphing_triangle()}) {
    PlayedPart travelled(builder);
    for (const double time : {0.3, 1.9, 1e6, -4.4, 1.1}) travelled.at(time);
    PlayedPart fresh(builder, "time='0.7'");
    const DrawList back = travelled.at(0.7);
    const DrawList first = fresh.at(0.7);
    REQUIRE(back.meshes.size() == first.meshes.size());
    for (std::size_t i = 0; i < back.meshes.size(); ++i) CHECK(*back.meshes[i] == *first.meshes[i]);
    CHECK(back.world_from_node == first.world_from_node);
  }
}

TEST_CASE("the first pose of a clip that starts at the file's rest pose equals the file") {
  PlayedPart part(bending_strip());
  const Mesh posed = part.mesh_at(0);
  const auto& shapes = part.built().scene.own_part("P", {}).content.animations->shapes;
  REQUIRE(shapes.size() == 1);
  Mesh expected = *shapes[0].shape->mesh();
  expected.short_lived = true;  // the next pose brings another mesh
  CHECK(posed == expected);
}

TEST_CASE("a step writes only moved content, and an unchanged pose writes nothing") {
  PlayedPart part(bending_strip(), "repeat='once'");
  part.at(0.5);
  FlattenCounters expected = part.counters();
  part.at(0.6);
  expected.meshes_written += 1;
  expected.transforms_written += 1;  // the joint's own node
  CHECK(part.counters() == expected);
  part.at(0.6);
  CHECK(part.counters() == expected);
  part.at(5);
  expected.meshes_written += 1;
  expected.transforms_written += 1;
  CHECK(part.counters() == expected);
  part.at(6);  // another time, the same pose
  CHECK(part.counters() == expected);

  PlayedPart rigid(moved_triangle("translation", "VEC3", "LINEAR", {0, 0, 0, 1, 2, 3, 4, 4, 4}), "repeat='once'");
  rigid.at(1.5);
  expected = rigid.counters();
  rigid.at(1.6);
  expected.transforms_written += 1;
  CHECK(rigid.counters() == expected);
  rigid.at(1.6);
  CHECK(rigid.counters() == expected);
}

TEST_CASE("clips are found by name and by number") {
  GltfBuilder builder = moved_triangle("translation", "VEC3", "STEP", {1, 0, 0, 1, 0, 0, 1, 0, 0});
  const auto add = [&](const char* name, float x) {
    add_clip(builder, name);
    add_channel(builder, 0, "translation", "STEP", builder.accessor<float>("SCALAR", {0}),
                builder.accessor<float>("VEC3", {x, 0, 0}), builder.root["animations"].size() - 1);
  };
  add("Run", 2);
  add("", 3);
  add("1", 4);
  const auto x = [&](const std::string& clip) { return PlayedPart(builder, clip).matrix_at(0.5)[3].x; };
  CHECK(x("") == 1);
  CHECK(x("clip='Move'") == 1);
  CHECK(x("clip='Run'") == 2);
  CHECK(x("clip='0'") == 1);
  CHECK(x("clip='2'") == 3);
  CHECK(x("clip='1'") == 4);  // a name before a number
  const std::string error = error_of([&] { PlayedPart(builder, "clip='run'"); });
  CHECK(contains(error, "s.xml:1:"));
  CHECK(contains(error,
                 "part \"P\" has no animation \"run\", did you mean \"Run\"? (expected one of: \"Move\", "
                 "\"Run\", \"1\", or a number from 0 to 3)"));
  CHECK(contains(error_of([&] { PlayedPart(builder, "clip='4'"); }), "has no animation \"4\""));
}

TEST_CASE("a thousand steps leave nothing behind, also on the device") {
  constexpr int kSteps = 1000;
  TemporaryFolder folder;
  write_text(folder / "strip.gltf", bending_strip().text());
  Simulation simulation = Simulation::from_string(R"(
    <part file="strip.gltf" name="STRIP" insert_at="ROOT" up="z"/>
    <element type="animation" name="BEND" insert_at="ROOT" part="STRIP"/>
    <sensor type="camera" name="EYE" insert_at="ROOT" width="2" height="2" outputs="depth"/>)",
                                                  {}, folder.path());
  std::vector<std::weak_ptr<const Mesh>> shown;
  std::uint64_t uploaded = 0, bytes_held = 0;
  for (int i = 0; i < kSteps; ++i) {
    simulation.set("BEND", "time", 0.001 * (i + 1));
    simulation.step();
    REQUIRE(simulation.diagnostics().draw_list().meshes.size() == 1);
    shown.emplace_back(simulation.diagnostics().draw_list().meshes[0]);
    // The first two frames allocate what later frames use.
    const FrameCounters& counters = simulation.diagnostics().counters();
    CHECK(counters.meshes_held == 1);
    if (i == 2) uploaded = counters.bytes_uploaded;
    if (i == 2) bytes_held = counters.mesh_bytes;
    if (i > 2) CHECK(counters.bytes_uploaded == uploaded);
    if (i > 2) CHECK(counters.mesh_bytes == bytes_held);
  }
  // The renderer holds the meshes on the device: only the last of all that were shown.
  int alive = 0;
  for (const auto& mesh : shown) alive += mesh.expired() ? 0 : 1;
  CHECK(alive == 1);
}

TEST_SUITE_END();
