// Effects on beam directions that are off: bytes and counters equal those of a scanner that never names them.
#include <doctest/doctest.h>

#include <simvis/effect.h>
#include "scenes/showcase/effect_examples.h"
#include "tests/support/element_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

const std::string kWallParts = R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>
  <element type="pose" name="P" insert_at="ROOT"/>)";

std::string scanner_with(std::string_view attributes) {
  return R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="91" )" + std::string(attributes) + "/>";
}

struct SeenScan {
  Scan scan;
  FrameCounters counters;
  std::uint64_t rays = 0, planned_rays = 0;
  std::vector<std::string> effects;
  std::string method;
};

SeenScan see(std::string_view attributes) {
  GltfBuilder file;
  add_plate(file, {}, file.append("materials", unlit("Wall", {1, 1, 1, 1})));
  World world({{"wall.gltf", file}}, kWallParts + scanner_with(attributes));
  for (int frame = 0; frame < 2; ++frame) {
    world->set("P", "x", frame);
    world->step();
  }
  SeenScan seen{.scan = world->scan("SCAN"),
                .counters = world->diagnostics().counters(),
                .rays = world->diagnostics().ray_counters().rays,
                .effects = {},
                .method = world->sensors().at(0).method};
  for (const RayCast& each : world->diagnostics().frame_plan().casts) seen.planned_rays += each.max_rays;
  for (const PlannedEffect& each : world->diagnostics().frame_plan().effects) seen.effects.push_back(each.effect);
  return seen;
}

TEST_CASE("effects that are named but off cost nothing and change nothing; effects that are on cast every beam") {
  const std::string planar = R"(method="planar" )";
  const SeenScan plain = see(planar);
  for (const char* const name : {"angular_noise", "beam_divergence", "returns", "sweep_motion"}) {
    CAPTURE(name);
    const EffectExample* const example = find_effect_example(name);
    REQUIRE(example != nullptr);
    const SeenScan off = see(planar + std::string(example->off_attributes));
    CHECK(off.scan.range_m == plain.scan.range_m);
    CHECK(off.scan.error_bound_m == plain.scan.error_bound_m);
    CHECK(off.scan.channels().empty());
    CHECK(off.counters == plain.counters);
    CHECK(off.rays == 0);
    CHECK(off.effects.empty());
    CHECK(off.method == "planar");
    const SeenScan on = see(example->attributes);
    CHECK(on.scan.range_m.size() == plain.scan.range_m.size());
    CHECK(on.effects == std::vector<std::string>{name});
    CHECK(on.counters.draws == 0);
    CHECK(on.rays == 2 * on.planned_rays);
    CHECK(on.rays == 2 * 91 * (std::string_view(name) == "beam_divergence" ? 16 : 1));
    CHECK(on.method == "raycast");
  }
}

TEST_CASE("methods that render cannot show these effects") {
  CHECK(contains(error_of([] { see(R"(method="planar" sweep="0.01")"); }), "cannot show \"sweep_motion\""));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
