// Work in a process of its own: whatever becomes of it, the caller hears of it in time.
#include <doctest/doctest.h>

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "scenegraph/import/inventor/foreign_scene.h"
#include "scenegraph/import/inventor/guarded_child.h"
#include "tests/support/error_of.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("scenegraph/import");

using namespace simvis;

namespace {

using Bytes = std::vector<std::uint8_t>;

ForeignScene triangle_scene() {
  ForeignScene scene;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.attributes.resize(3);
  mesh.indices = {0, 1, 2};
  scene.meshes = {mesh};
  Texture texture;
  texture.width = texture.height = 1;
  texture.rgba = {1, 2, 3, 4};
  texture.sampler.wrap_v = Wrap::mirrored_repeat;
  scene.textures = {texture};
  ForeignMaterial material;
  material.material.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  material.material.double_sided = true;
  material.texture = 0;
  scene.materials = {material};
  scene.shapes = {{"S", glm::dmat4(2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1), 0, 0}};
  scene.lights = {{"L", glm::dmat4(1), Light{.kind = LightKind::spot, .intensity = 5}}};
  scene.commands = {"<part/>"};
  scene.warnings = {"careful"};
  return scene;
}

std::string fault_after(void (*change)(ForeignScene&)) {
  ForeignScene scene = triangle_scene();
  change(scene);
  return error_of([&] { unpack_foreign_scene(pack_foreign_scene(scene), "a.iv: error: "); });
}

}  // namespace

TEST_CASE("a child's result and its log arrive") {
  const Bytes large(3'000'000, 7);
  int touched = 0;
  const ChildReport report = run_in_child([&](ChildLog& log) {
    touched = 1;
    log.add("one\ntwo");
    log.add(
        "\tth\xc3\xa9"
        "ee");
    log.add("\xff\xc3\xa9");
    return large;
  });
  CHECK(report.end == ChildEnd::finished);
  CHECK(report.result == large);
  CHECK(report.log == std::vector<std::string>{"one two",
                                               " th\xc3\xa9"
                                               "ee",
                                               "???"});
  CHECK(touched == 0);
}

TEST_CASE("a child that crashes, throws or hangs is reported as that, with what it said before") {
  const ChildReport crashed = run_in_child([](ChildLog& log) -> Bytes {
    log.add("about to crash");
    std::raise(SIGSEGV);
    return {};
  });
  CHECK(crashed.end == ChildEnd::crashed);
  CHECK(contains(crashed.reason, "Segmentation fault"));
  CHECK(crashed.log == std::vector<std::string>{"about to crash"});

  const ChildReport threw = run_in_child([](ChildLog&) -> Bytes { throw std::runtime_error("no such thing"); });
  CHECK(threw.end == ChildEnd::threw);
  CHECK(threw.reason == "no such thing");

  const auto start = std::chrono::steady_clock::now();
  ChildLimits limits;
  limits.time = std::chrono::milliseconds(100);
  const ChildReport hung = run_in_child(
      [](ChildLog& log) -> Bytes {
        log.add("waiting");
        for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
      },
      limits);
  CHECK(hung.end == ChildEnd::took_too_long);
  CHECK(hung.log == std::vector<std::string>{"waiting"});
  // It would never end; the machine may be busy.
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
}

TEST_CASE("a child cannot fill the log, nor the memory") {
  const ChildReport chatty = run_in_child([](ChildLog& log) {
    for (int i = 0; i < 100'000; ++i) log.add("the same line again");
    return Bytes{1};
  });
  std::size_t bytes = 0;
  for (const std::string& line : chatty.log) bytes += line.size() + 1;
  CHECK(bytes > 60'000);
  CHECK(bytes <= 65'536);
  CHECK(chatty.result == Bytes{1});
  if (sanitized()) return;  // it maps terabytes for itself
  ChildLimits limits;
  limits.memory_bytes = std::size_t{64} << 20;
  const ChildReport greedy = run_in_child([](ChildLog&) { return Bytes(std::size_t{128} << 20, 1); }, limits);
  CHECK(greedy.end == ChildEnd::threw);
  CHECK(contains(greedy.reason, "64 MiB"));
}

TEST_CASE("a scene comes out of its bytes as it went in") {
  const ForeignScene scene = unpack_foreign_scene(pack_foreign_scene(triangle_scene()), "");
  const ForeignScene expected = triangle_scene();
  CHECK(scene.meshes == expected.meshes);
  CHECK(scene.textures == expected.textures);
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[0].material == expected.materials[0].material);
  CHECK(scene.materials[0].texture == 0);
  REQUIRE(scene.shapes.size() == 1);
  CHECK(scene.shapes[0].name == "S");
  CHECK(scene.shapes[0].part_from_shape == expected.shapes[0].part_from_shape);
  REQUIRE(scene.lights.size() == 1);
  CHECK(scene.lights[0].light == expected.lights[0].light);
  CHECK(scene.commands == expected.commands);
  CHECK(scene.warnings == expected.warnings);
}

TEST_CASE("a scene with a fault is refused") {
  CHECK(contains(fault_after([](ForeignScene& s) { s.meshes[0].positions[1].y = NAN; }), "not finite"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.meshes[0].attributes[0].normal.x = INFINITY; }), "not finite"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.meshes[0].indices[0] = 3; }), "index"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.meshes[0].indices.pop_back(); }), "half a primitive"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.meshes[0].attributes.pop_back(); }), "attributes"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.textures[0].width = 2; }), "texture"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.materials[0].texture = 1; }), "texture"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.shapes[0].mesh = 1; }), "content"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.shapes[0].part_from_shape[0][3] = 1; }), "not affine"));
  CHECK(contains(fault_after([](ForeignScene& s) { s.lights[0].light.intensity = NAN; }), "not finite"));
}

TEST_CASE("cut and flipped bytes of a scene are refused or harmless") {
  const Bytes whole = pack_foreign_scene(triangle_scene());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CHECK_THROWS_AS(unpack_foreign_scene({whole.data(), size}, ""), InputError);
  }
  int refused = 0;
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1u << (bit % 8)));
    try {
      const ForeignScene scene = unpack_foreign_scene(bytes, "");
      for (const Mesh& mesh : scene.meshes) {
        for (const std::uint32_t index : mesh.indices) REQUIRE(index < mesh.positions.size());
      }
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(refused > 0);
}

TEST_SUITE_END();
