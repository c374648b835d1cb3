// Animations of glTF files: errors, skipped channels, and files of other projects.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include <simvis/error.h>
#include "scenegraph/part_player.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/animated_part.h"
#include "tests/support/random_numbers.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Node 0 shows a triangle with one morph target, node 1 has a matrix, node 2 shows a mesh without targets. Channels of
// the clip: translation and weights of node 0, rotation of node 2.
GltfBuilder animated_file() {
  GltfBuilder builder;
  builder.triangle()["targets"] = {{{"POSITION", builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 0, 0, 0, 0})}}};
  builder.append("nodes", {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
  builder.triangle();
  const int times = builder.accessor<float>("SCALAR", {0, 1});
  add_clip(builder, "Clip");
  add_channel(builder, 0, "translation", "LINEAR", times, builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0}));
  add_channel(builder, 0, "weights", "LINEAR", times, builder.accessor<float>("SCALAR", {0, 1}));
  add_channel(builder, 2, "rotation", "LINEAR", times, builder.accessor<float>("VEC4", {0, 0, 0, 1, 1, 0, 0, 0}));
  return builder;
}

json& channel(GltfBuilder& b, std::size_t i) { return b.root["animations"][0]["channels"][i]; }
json& sampler(GltfBuilder& b, std::size_t i) { return b.root["animations"][0]["samplers"][i]; }

struct AnimationCase {
  const char* what;  // a part of the message
  std::function<void(GltfBuilder&)> spoil;
};

void check_animation_cases(std::initializer_list<AnimationCase> cases) {
  TemporaryFolder folder;
  const std::filesystem::path file = folder / "part.gltf";
  for (const AnimationCase& c : cases) {
    CAPTURE(c.what);
    GltfBuilder builder = animated_file();
    c.spoil(builder);
    write_text(file, builder.text());
    ContentPool pool;
    const std::string message = error_of([&] { import_part(file, pool); });
    CHECK(message.starts_with(file.string() + ": error: "));
    CHECK(contains(message, c.what));
  }
}

std::shared_ptr<const PartAnimations> animations_of(const GltfBuilder& builder, std::vector<std::string>* warnings) {
  TemporaryFolder folder;
  ContentPool pool;
  write_text(folder / "part.gltf", builder.text());
  const PartContent content = import_part(folder / "part.gltf", pool);
  *warnings = content.warnings;
  return content.animations;
}

bool is_finite(const glm::dmat4& m) {
  for (int i = 0; i < 16; ++i) {
    if (!std::isfinite(m[i / 4][i % 4])) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("the base file without mistakes is valid, and samplers share their times") {
  std::vector<std::string> warnings;
  const auto animations = animations_of(animated_file(), &warnings);
  REQUIRE(animations != nullptr);
  REQUIRE(animations->clips.size() == 1);
  const AnimationClip& clip = animations->clips[0];
  CHECK(clip.name == "Clip");
  CHECK(clip.duration_s == 1);
  REQUIRE(clip.samplers.size() == 3);
  CHECK(clip.samplers[0].times_s == clip.samplers[2].times_s);
  CHECK(animations->shapes.size() == 1);
  CHECK(animations->nodes.size() == 2);
  CHECK(warnings.empty());
}

TEST_CASE("a file without animations stores nothing for them") {
  GltfBuilder builder = animated_file();
  builder.root.erase("animations");
  std::vector<std::string> warnings;
  CHECK(animations_of(builder, &warnings) == nullptr);
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "morph targets are not animated"));
}

TEST_CASE("animations of the wrong structure") {
  check_animation_cases({
      {"animations must be an array", [](GltfBuilder& b) { b.root["animations"] = 1; }},
      {"animations/0 lacks the required property \"channels\"",
       [](GltfBuilder& b) { b.root["animations"][0].erase("channels"); }},
      {"animations/0 lacks the required property \"samplers\"",
       [](GltfBuilder& b) { b.root["animations"][0].erase("samplers"); }},
      {"animations/0/channels/1 lacks the required property \"target\"",
       [](GltfBuilder& b) { channel(b, 1).erase("target"); }},
      {"animations/0/channels/0/target/node is 9, but the file has 3 nodes",
       [](GltfBuilder& b) { channel(b, 0)["target"]["node"] = 9; }},
      {"animations/0/channels/0/target/path must be a string",
       [](GltfBuilder& b) { channel(b, 0)["target"]["path"] = 3; }},
      {"animations/0/channels/0/sampler is 3, but the animation has 3 samplers",
       [](GltfBuilder& b) { channel(b, 0)["sampler"] = 3; }},
      {"animations/0/samplers/2/input is 99, but the file has", [](GltfBuilder& b) { sampler(b, 2)["input"] = 99; }},
      {"animations/0/channels/0/target/path is \"colour\"; expected translation, rotation, scale or weights",
       [](GltfBuilder& b) { channel(b, 0)["target"]["path"] = "colour"; }},
      {"animations/0/samplers/0/interpolation is \"CUBIC\"; expected STEP, LINEAR or CUBICSPLINE",
       [](GltfBuilder& b) { sampler(b, 0)["interpolation"] = "CUBIC"; }},
      {"animations/0/channels/0 moves nodes/1, which has a matrix",
       [](GltfBuilder& b) { channel(b, 0)["target"]["node"] = 1; }},
      {"animations/0/channels/1 changes the weights of nodes/2, which has none",
       [](GltfBuilder& b) { channel(b, 1)["target"]["node"] = 2; }},
      {"animations/0/channels/1 changes the weights of nodes/1, which has none",
       [](GltfBuilder& b) { channel(b, 1)["target"]["node"] = 1; }},
      {"animations/0/channels/3 changes the translation of nodes/0, as a channel before it does",
       [](GltfBuilder& b) { b.root["animations"][0]["channels"].push_back(channel(b, 0)); }},
  });
}

TEST_CASE("wrong keys") {
  const auto times = [](std::vector<float> values) {
    return [values](GltfBuilder& b) { sampler(b, 0)["input"] = b.accessor<float>("SCALAR", values); };
  };
  check_animation_cases({
      {"animations/0/samplers/0 has 2 output values for 3 times; expected 3", times({0, 1, 2})},
      {"animations/0/samplers/0/input: accessors/", times({-1, 1})},
      {"has the time -1.000000 in element 0; expected times that ascend from 0", times({-1, 1})},
      {"has the time 1.000000 after 1.000000 in element 1; expected times that ascend", times({1, 1})},
      {"(times of an animation) has a value that is not finite in element 1", times({0, NAN})},
      {"(times of an animation) has a value that is not finite in element 1", times({0, INFINITY})},
      {"(translations) has a value that is not finite in element 1",
       [](GltfBuilder& b) {
         sampler(b, 0)["output"] = b.accessor<float>("VEC3", {0, 0, 0, NAN, 0, 0});
       }},
      {"(times of an animation) is of type VEC3; expected SCALAR",
       [](GltfBuilder& b) { sampler(b, 0)["input"] = sampler(b, 0)["output"]; }},
      {"(rotations) is of type VEC3; expected VEC4",
       [](GltfBuilder& b) { sampler(b, 2)["output"] = sampler(b, 0)["output"]; }},
      {"(times of an animation) holds UNSIGNED_BYTE; expected FLOAT",
       [](GltfBuilder& b) {
         sampler(b, 0)["input"] = b.accessor<std::uint8_t>("SCALAR", {0, 1});
       }},
      {"animations/0/samplers/0 has 2 output values for 2 times; expected 6",
       [](GltfBuilder& b) { sampler(b, 0)["interpolation"] = "CUBICSPLINE"; }},
      {"animations/0/samplers/0 has one time; expected at least 2 for CUBICSPLINE",
       [](GltfBuilder& b) {
         sampler(b, 0) = {{"interpolation", "CUBICSPLINE"},
                          {"input", b.accessor<float>("SCALAR", {0})},
                          {"output", b.accessor<float>("VEC3", {0, 0, 0, 0, 0, 0, 0, 0, 0})}};
       }},
      {"has in element 1 a rotation that is not a unit quaternion",
       [](GltfBuilder& b) {
         sampler(b, 2)["output"] = b.accessor<float>("VEC4", {0, 0, 0, 1, 0, 0, 0, 2});
       }},
      {"has in element 0 a rotation that is not a unit quaternion",  // whatever the times are: the file has none
       [](GltfBuilder& b) {
         sampler(b, 2) = {
             {"input", b.append("accessors", {{"componentType", kFloat}, {"count", 1}, {"type", "SCALAR"}})},
             {"output", b.accessor<float>("VEC4", {0, 0, 0, 0})}};
       }},
      {"has animations that can move a node to where float32 is not finite",
       [](GltfBuilder& b) {
         channel(b, 0)["target"] = {{"path", "scale"}, {"node", 0}};
         sampler(b, 0)["output"] = b.accessor<float>("VEC3", {1, 1, 1, 1e30f, 1, 1});
         b.append("nodes", {{"children", {0}}, {"scale", {1e30, 1, 1}}});
       }},
      {"has animations that can move a vertex, by its morph targets or joints, to where float32 is not finite",
       [](GltfBuilder& b) {
         sampler(b, 1)["output"] = b.accessor<float>("SCALAR", {0, 3e38f});
         b.root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] =
             b.accessor<float>("VEC3", {0, 0, 2, 0, 0, 0, 0, 0, 0});
       }},
      {"meshes/0 has primitives with different numbers of morph targets",
       [](GltfBuilder& b) {
         b.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}});
       }},
      {"animations/0/channels/3 has a sampler of 1 weights for nodes/2, which has 2",
       [](GltfBuilder& b) {
         const json target{{"POSITION", 0}};
         b.root["meshes"][1]["primitives"][0]["targets"] = {target, target};
         b.root["animations"][0]["channels"].push_back(
             {{"sampler", 1}, {"target", {{"node", 2}, {"path", "weights"}}}});
       }},
  });
}

TEST_CASE("channels for extensions and channels without data are skipped with a warning") {
  GltfBuilder builder = animated_file();
  channel(builder, 0)["target"].erase("node");
  sampler(builder, 2)["input"] =
      builder.append("accessors", {{"componentType", kFloat}, {"count", 2}, {"type", "SCALAR"}});
  std::vector<std::string> warnings;
  const auto animations = animations_of(builder, &warnings);
  REQUIRE(animations->clips.at(0).channels.size() == 1);
  CHECK(animations->clips[0].channels[0].property == AnimatedProperty::weights);
  REQUIRE(warnings.size() == 2);
  CHECK(contains(warnings[0], "channels that are not for a node are left out"));
  CHECK(contains(warnings[1], "whose accessors hold no data are left out"));
}

TEST_CASE("rotations and weights may be normalised integers") {
  GltfBuilder builder = animated_file();
  sampler(builder, 1)["output"] = builder.accessor<std::uint8_t>("SCALAR", {0, 51, 0, 0}, true);
  builder.root["accessors"].back()["count"] = 2;
  sampler(builder, 2)["output"] = builder.accessor<std::int16_t>("VEC4", {0, 0, 0, 32767, 32767, 0, 0, 0}, true);
  PlayedPart part(builder, "repeat='once'");
  CHECK(part.mesh_at(1, 0).positions[0] == glm::vec3(0, 0, static_cast<float>(51 / 255.0)));
  CHECK(part.matrix_at(1, 1)[1] == glm::dvec4(0, -1, 0, 0));  // half a turn about x
}

TEST_CASE("a chain of 50,000 nodes carries a joint at its end") {
  constexpr int kDepth = 50000;
  GltfBuilder builder;
  json& attributes = builder.triangle()["attributes"];
  attributes["JOINTS_0"] = builder.accessor<std::uint8_t>("VEC4", std::vector<std::uint8_t>(12, 0));
  attributes["WEIGHTS_0"] = builder.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  builder.root["nodes"][0]["skin"] = 0;
  builder.append("skins", {{"joints", {kDepth}}});
  for (int i = 1; i < kDepth; ++i) builder.append("nodes", {{"children", {i + 1}}, {"translation", {1, 0, 0}}});
  builder.append("nodes", json::object());
  add_clip(builder, "Turn");
  const int times = builder.accessor<float>("SCALAR", {0, 1});
  add_channel(builder, 1, "rotation", "LINEAR", times, builder.accessor<float>("VEC4", {0, 0, 0, 1, 0, 0, 1, 0}));
  PlayedPart part(builder, "repeat='once'");
  CHECK(part.mesh_at(0).positions[0] == glm::vec3(kDepth - 1, 0, 0));
  CHECK(part.mesh_at(1).positions[0] == glm::vec3(1 - (kDepth - 2), 0, 0));  // node 1 itself stays where it is
}

TEST_CASE("broken animations are refused, or play with every vertex and node finite") {
  constexpr int kFiles = 2000;
  GltfBuilder morphing = animated_file();
  const ByteString seeds[] = {bending_strip().glb(), morphing.glb()};
  TemporaryFolder folder;
  int played = 0;
  Random random;
  for (int i = 0; i < kFiles; ++i) {
    CAPTURE(i);
    ByteString bytes = seeds[i % 2];
    // Most flips are in the numbers at the end, where a file stays readable.
    const std::size_t first =
        random.below(4) == 0 ? 0 : bytes.size() - (i % 2 == 0 ? bending_strip() : morphing).bytes.size();
    for (std::uint64_t flips = 1 + random.below(6); flips > 0; --flips) {
      bytes[first + random.below(bytes.size() - first)] ^= static_cast<std::uint8_t>(1u << random.below(8));
    }
    const std::filesystem::path file = folder / ("part" + std::to_string(i) + ".glb");
    write_bytes(file, bytes);
    ContentPool pool;
    PartContent content;
    const std::string message = error_of([&] { content = import_part(file, pool); });
    if (content.root == nullptr) {
      REQUIRE(message.starts_with(file.string() + ": error: "));
      continue;
    }
    if (content.animations == nullptr) continue;
    NodeMap clone_of;
    const auto root = std::make_shared<Group>();
    root->add(clone_graph(content.root, clone_of));
    Flattener flattener(root);
    for (std::size_t clip = 0; clip < content.animations->clips.size(); ++clip) {
      PartPlayer player(content.animations, clip, clone_of);
      for (const double part : {0.0, 0.1, 0.5, 0.9, 1.0}) {
        player.show(part * player.duration_s());
        const DrawList& list = flattener.update();
        for (const glm::dmat4& m : list.world_from_node) REQUIRE(is_finite(m));
        for (const auto& mesh : list.meshes) {
          for (const glm::vec3& p : mesh->positions)
            REQUIRE((std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)));
        }
      }
    }
    ++played;
  }
  CHECK(played > kFiles / 10);
}

TEST_CASE("test data: valid animations of other projects load") {
  const auto index_file = test::test_data("malformed/INDEX.csv");
  if (!index_file) return;
  const std::filesystem::path folder = index_file->parent_path();
  std::ifstream index(*index_file);
  int valid = 0;
  std::string line;
  while (std::getline(index, line)) {
    std::istringstream cells(line);
    std::string name, suite, bytes, expected;
    for (std::string* cell : {&name, &suite, &bytes, &expected}) std::getline(cells, *cell, ',');
    if (name.find("anim") == std::string::npos || expected != "valid") continue;
    CAPTURE(name);
    ContentPool pool;
    CHECK_NOTHROW(import_part(folder / name, pool));
    ++valid;
  }
  CHECK(valid > 4);
}

TEST_CASE("test data: sample models play with finite, bounded and moving vertices") {
  const char* const models[] = {
      "AnimatedTriangle/glTF-Embedded/AnimatedTriangle.gltf", "BoxAnimated/glTF-Binary/BoxAnimated.glb",
      "CesiumMilkTruck/glTF-Binary/CesiumMilkTruck.glb",      "Fox/glTF-Binary/Fox.glb",
      "InterpolationTest/glTF-Binary/InterpolationTest.glb",  "RiggedSimple/glTF-Binary/RiggedSimple.glb",
      "SimpleMorph/glTF-Embedded/SimpleMorph.gltf",           "SimpleSkin/glTF/SimpleSkin.gltf"};
  for (const char* model : models) {
    CAPTURE(model);
    const auto file = test::test_data(std::string("gltf/") + model);
    if (!file) continue;
    PlayedPart part(*file, "repeat='once'");
    CHECK(part.built().scene.warnings().empty());
    const double duration_s = part.duration_s();
    CHECK(duration_s > 0);
    const DrawList start = part.at(0);
    bool moves = false;
    for (const double time : {duration_s / 3, duration_s / 2, duration_s}) {
      const DrawList& list = part.at(time);
      moves = moves || list.meshes != start.meshes || list.world_from_node != start.world_from_node;
      for (const auto& mesh : list.meshes) {
        const glm::vec3 size = mesh->bounds_max - mesh->bounds_min;
        CHECK(std::isfinite(glm::length(size)));
      }
    }
    CHECK(moves);
  }
}

TEST_SUITE_END();
