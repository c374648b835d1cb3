// The frame plan names everything that a frame draws, creates, holds and uploads, and contains nothing that no due
// sensor shows. Counts come from the pipeline statistics of the device, sizes from the requested memory.
#include <simvis/frame_plan.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <optional>

#include <simvis/ray_caster.h>
#include <simvis/simulation.h>
#include "program/report/explain.h"
#include "tests/support/renderer_scene.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("engine");

namespace simvis {
namespace {

using namespace test;

constexpr std::uint32_t kSide_px = 64;
constexpr std::uint64_t kPixels = std::uint64_t{kSide_px} * kSide_px;

DeviceDesc instrumented_device() {
  return {.select = "", .validation = false, .cache_dir = tested_build() + "/test_cache", .instrumented = true};
}

Device& instrumented() {
  static Device device(instrumented_device());
  return device;
}

/// A view of 90 degrees.
FramePlan square(bool color, bool depth) { return plan_of(kSide_px, kSide_px, kSide_px / 2.0, color, depth); }

/// A wall that fills the view, with a texture, under one light.
RendererScene lit_wall(AlphaMode mode) {
  Material material;
  material.alpha_mode = mode;
  material.base_color_texture = four_texels();
  RendererScene scene = textured_wall(material);
  scene.add_light({}, glm::dmat4(1));
  return scene;
}

bool holds(const FramePlan& plan, std::string_view part_of_name) {
  return std::ranges::any_of(
      plan.memory, [&](const PlannedMemory& memory) { return memory.name.find(part_of_name) != std::string::npos; });
}

std::uint64_t memory_of(std::initializer_list<const FramePlan*> plans) {
  std::uint64_t bytes = 0;
  for (const FramePlan* plan : plans) {
    for (const PlannedMemory& memory : plan->memory) bytes += memory.bytes;
  }
  return bytes;
}

std::uint64_t uploaded_of(const FramePlan& plan) {
  std::uint64_t bytes = 0;
  for (const PlannedMemory& memory : plan.memory) bytes += memory.uploaded;
  return bytes;
}

/// Sum over all views and passes of a plan.
PlannedPipeline sum_of_pipelines(const FramePlan& plan, std::uint64_t& made) {
  PlannedPipeline sum;
  const auto add = [&](const std::vector<PlannedPipeline>& pipelines) {
    for (const PlannedPipeline& pipeline : pipelines) {
      CHECK(!pipeline.variant.empty());
      CHECK(!pipeline.reason.empty());
      sum.draws += pipeline.draws;
      sum.triangles += pipeline.triangles;
      made += pipeline.made;
    }
  };
  for (const Pass& pass : plan.passes) {
    add(pass.pipelines);
    for (const View& view : pass.views) add(view.pipelines);
  }
  return sum;
}

void check_named(const Renderer& renderer, const FramePlan& plan) {
  std::uint64_t made = 0;
  const PlannedPipeline sum = sum_of_pipelines(plan, made);
  CHECK(sum.draws == renderer.counters().draws);
  CHECK(sum.triangles == renderer.counters().triangles);
  CHECK(made == renderer.counters().pipelines_made);
  CHECK(uploaded_of(plan) == renderer.counters().bytes_uploaded);
  for (const PlannedMemory& memory : plan.memory) {
    INFO(memory.name);
    CHECK(memory.bytes > 0);
    CHECK(!memory.reason.empty());
  }
}

TEST_CASE("depth of opaque surfaces needs no colour target, no texture and no light, and shades no fragment") {
  Renderer renderer(instrumented());
  const RendererScene scene = lit_wall(AlphaMode::opaque);
  FramePlan plan = square(false, true);
  renderer.render(scene.list, plan);
  renderer.complete(plan);
  check_named(renderer, plan);
  for (const char* name : {"colour", "texture", "attributes", "lights", "materials"}) CHECK(!holds(plan, name));
  REQUIRE(plan.passes[0].views[0].pipelines.size() == 1);
  CHECK(plan.passes[0].views[0].pipelines[0].variant == "depth, triangles, opaque, back faces culled");
  CHECK(!plan.passes[0].views[0].shades());
  REQUIRE(renderer.costs()->passes.size() == 1);
  CHECK(renderer.costs()->passes[0].bytes_read_back == kPixels * sizeof(float));
  if (!renderer.costs()->counted) return test::skip("this device counts nothing");
  const PipelineStatistics& depth = renderer.costs()->passes[0].views[0].statistics;
  // Mesa's llvmpipe counts covered fragments even without a fragment shader.
  if (!instrumented().is_cpu()) CHECK(depth.fragment_invocations == 0);
  CHECK(depth.vertex_invocations >= 4);  // the corners of the wall; a device may shade one more than once
  CHECK(depth.vertices == 6);
  CHECK(depth.primitives_clipped == 2);

  // The same in colour: at least one fragment for each pixel.
  plan = square(true, false);
  renderer.render(scene.list, plan);
  renderer.complete(plan);
  check_named(renderer, plan);
  for (const char* name : {"pass/colour", "texture four", "attributes", "lights", "materials"})
    CHECK(holds(plan, name));
  CHECK(plan.passes[0].views[0].pipelines[0].variant ==
        "colour, triangles, opaque, textured, 1 light, back faces culled");
  CHECK(plan.passes[0].views[0].shades());
  CHECK(renderer.costs()->passes[0].views[0].statistics.fragment_invocations >= kPixels);
}

TEST_CASE("depth of masked surfaces: textures of masks are uploaded, others are not") {
  Renderer renderer(instrumented());
  RendererScene scene = lit_wall(AlphaMode::mask);
  Material opaque;
  opaque.base_color_texture = std::make_shared<Texture>(*four_texels());
  scene.add(rectangle(-1, -1, 1, 1), opaque, at(0, 0, 2));
  FramePlan plan = square(false, true);
  renderer.render(scene.list, plan);
  renderer.complete(plan);
  check_named(renderer, plan);
  const auto textures = std::ranges::count_if(
      plan.memory, [](const PlannedMemory& memory) { return memory.name.starts_with("texture"); });
  REQUIRE(textures == 1);
  REQUIRE(holds(plan, "texture four"));
  CHECK(std::ranges::find(plan.memory, "texture four", &PlannedMemory::name)->uploaded == 4 * 4);  // RGBA of 4 texels
  CHECK(!holds(plan, "colour"));
  CHECK(!holds(plan, "lights"));
  CHECK(plan.passes[0].views[0].shades());
  if (!renderer.costs()->counted) return test::skip("this device counts nothing");
  CHECK(renderer.costs()->passes[0].views[0].statistics.fragment_invocations >= kPixels);  // each asks for alpha
}

TEST_CASE("the plan contains all memory of the device, and all uploads and creations") {
  Device device(instrumented_device());
  Renderer renderer(device);
  CHECK(device.memory_bytes() == 0);  // nothing is held before a frame needs it
  const RendererScene scene = lit_wall(AlphaMode::mask);
  FramePlan averaged = square(true, false);
  averaged.passes[0].name = "averaged";
  averaged.passes[0].supersampling = 2;
  FramePlan both = square(true, true);
  both.passes.push_back(averaged.passes[0]);
  for (FramePlan plan : {square(false, true), both, square(true, false), both, FramePlan{}}) {
    renderer.render(scene.list, plan);
    renderer.complete(plan);
    check_named(renderer, plan);
    CHECK(memory_of({&plan}) == device.memory_bytes());
  }
  // In the second frame, unchanged content is neither created nor uploaded.
  FramePlan again = both;
  renderer.render(scene.list, again);
  renderer.complete(again);
  CHECK(renderer.counters().pipelines_made == 0);
  for (const PlannedMemory& memory : again.memory) {
    CHECK((memory.uploaded == 0 || memory.name == "instances" || memory.name == "lights"));
  }
  CHECK(again.passes[1].pipelines.at(0).variant == "resolve, supersampling 2, msaa 1");
}

TEST_CASE("a ray caster on the device names its memory too") {
  Device device(instrumented_device());
  const std::unique_ptr<RayCaster> caster = make_device_ray_caster(device);
  const RendererScene scene = lit_wall(AlphaMode::opaque);
  const std::array<glm::dvec3, 3> directions{glm::dvec3{0, 0, 1}, {0, 0.1, 1}, {1, 0, 0}};
  std::array<RayHit, 3> hits;
  FramePlan plan;
  caster->name_memory(plan.memory);
  CHECK(plan.memory.empty());
  caster->set_world(scene.list);
  caster->cast(glm::dmat4(1), directions, hits);
  caster->name_memory(plan.memory);
  CHECK(hits[0].range_m == 1);
  CHECK(memory_of({&plan}) == device.memory_bytes());
  CHECK(uploaded_of(plan) == caster->counters().bytes_uploaded);
}

TEST_CASE("the time spans of the device are nested, and their sum is at most that of the pass") {
  Renderer renderer(instrumented());
  const RendererScene scene = lit_wall(AlphaMode::opaque);
  FramePlan plan = square(true, true);
  plan.passes[0].width_px = 2 * kSide_px;
  plan.passes[0].views.push_back(plan.passes[0].views[0]);
  plan.passes[0].views[1].x_px = kSide_px;
  plan.passes.push_back(square(false, true).passes[0]);
  renderer.render(scene.list, plan);
  renderer.complete(plan);
  check_named(renderer, plan);  // the two views of one pass share a pipeline, which is created once
  const FrameCosts& costs = *renderer.costs();
  REQUIRE(costs.passes.size() == 2);
  CHECK(costs.submitted_ns < costs.finished_ns);
  std::int64_t end_ns = 0;
  const auto follows = [&](const GpuSpan& span) {
    CHECK(span.start_ns >= end_ns);
    CHECK(span.end_ns >= span.start_ns);
    end_ns = span.end_ns;
  };
  follows(costs.uploads);
  for (const PassCost& pass : costs.passes) {
    const std::int64_t before_ns = end_ns;
    for (const ViewCost& view : pass.views) follows(view.time);
    CHECK(pass.time.start_ns >= before_ns);
    CHECK(pass.time.start_ns <= pass.views.front().time.start_ns);
    CHECK(pass.time.end_ns >= end_ns);
    end_ns = pass.time.end_ns;
  }
  for (const PassCost& pass : costs.passes) follows(pass.readback);
  if (costs.timed) CHECK(end_ns > 0);
}

/// A simulation of the wall at x = 4 m with `commands`.
class WallSimulation {
 public:
  explicit WallSimulation(const std::string& commands, bool instrumented = true) {
    write_text(folder_ / "wall.gltf", wall_gltf());
    SimulationDesc desc;
    desc.device = instrumented_device();
    desc.device.instrumented = instrumented;
    simulation_.emplace(Simulation::from_string(std::string(kWallPart) + commands, desc, folder_.path()));
  }
  Simulation& operator*() { return *simulation_; }
  Simulation* operator->() { return &*simulation_; }

 private:
  TemporaryFolder folder_;
  std::optional<Simulation> simulation_;
};

std::string camera(const std::string& name, const std::string& more) {
  return "<sensor type=\"camera\" name=\"" + name + "\" insert_at=\"ROOT\" width=\"64\" height=\"64\" " + more + "/>";
}

const std::string kScanner =
    R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="31" min_angle="-45" max_angle="45"
            method="planar"/>)";

PlannedSensor sensor_of(const std::vector<PlannedSensor>& sensors, std::string_view name) {
  const auto found = std::ranges::find(sensors, name, &PlannedSensor::name);
  REQUIRE(found != sensors.end());
  return *found;
}

TEST_CASE("a sensor at 1 Hz in a run of 15 Hz renders in one frame of 15") {
  WallSimulation slow(camera("SLOW", R"(rate="1")")), both(camera("SLOW", R"(rate="1")") + kScanner), alone(kScanner);
  for (std::uint64_t frame = 0; frame < 31; ++frame) {
    for (WallSimulation* simulation : {&slow, &both, &alone}) (*simulation)->step();
    const bool due = frame % 15 == 0;
    CHECK(slow->diagnostics().counters().views == due);
    CHECK(slow->diagnostics().counters().bytes_read_back == (due ? 4 * sizeof(float) * kPixels : 0));
    CHECK(sensor_of(slow->diagnostics().planned_sensors(), "SLOW").due_state ==
          (due ? DueState::due : DueState::waiting));
    CHECK(slow->diagnostics().frame_plan().passes.size() == due);
    CHECK(both->diagnostics().counters().views == alone->diagnostics().counters().views + due);
    CHECK(both->diagnostics().counters().draws == alone->diagnostics().counters().draws + due);
    CHECK(both->scan("SCAN").range_m == alone->scan("SCAN").range_m);
  }
}

TEST_CASE("a camera that is off, or in a part that is, renders nothing; the plan gives the reason") {
  WallSimulation without(kScanner), with(camera("CAM", R"(outputs="color depth")") + kScanner);
  with->enable("CAM", false);
  without->step();
  with->step();
  CHECK(with->diagnostics().counters() == without->diagnostics().counters());
  CHECK(with->diagnostics().device_memory_bytes() == without->diagnostics().device_memory_bytes());
  const std::vector<PlannedSensor> sensors = with->diagnostics().planned_sensors();
  CHECK(sensor_of(sensors, "CAM").due_state == DueState::off);
  CHECK(sensor_of(sensors, "SCAN").due_state == DueState::due);
  CHECK(sensor_of(sensors, "SCAN").end_pass == 1);
  const std::string text = explain(
      with->diagnostics().frame_plan(),
      {with->diagnostics().counters(), sensors, with->diagnostics().frame_costs(), with->diagnostics().sensor_costs()});
  INFO(text);
  CHECK(text.find("sensor CAM, camera: not due, it is turned off; color, depth\n") != std::string::npos);
  CHECK(text.find("sensor SCAN, laser_scanner: due, in every frame; ranges\n  pass SCAN.depth: ") != std::string::npos);
  CHECK(text.find("    view SCAN/face 0: ") != std::string::npos);
  CHECK(text.find("      pipeline depth, triangles, opaque, selected on the CPU: ") != std::string::npos);
  CHECK(text.find("  cost on the host: ") != std::string::npos);
  CHECK(text.find("memory on the device: " + std::to_string(with->diagnostics().device_memory_bytes()) + " bytes\n") !=
        std::string::npos);
}

TEST_CASE("an output without a consumer is neither rendered nor read back") {
  const auto read_back = [](const char* outputs) {
    WallSimulation simulation(camera("CAM", std::string("outputs=\"") + outputs + "\""));
    simulation->step();
    const FramePlan& plan = simulation->diagnostics().frame_plan();
    CHECK(plan.passes.size() == 1);
    CHECK(memory_of({&plan}) == simulation->diagnostics().device_memory_bytes());
    CHECK(holds(plan, "colour") == (std::string_view(outputs) != "depth"));
    CHECK(holds(plan, "depth readback") == (std::string_view(outputs) != "color"));
    return simulation->diagnostics().counters().bytes_read_back;
  };
  CHECK(read_back("color") == 4 * sizeof(float) * kPixels);
  CHECK(read_back("depth") == sizeof(float) * kPixels);
  CHECK(read_back("color depth") == 5 * sizeof(float) * kPixels);
}

TEST_CASE("the plans of both audiences together cover the memory of the device") {
  WallSimulation simulation(camera("CAM", "") + camera("PEOPLE", R"(view="visualization")") + kScanner);
  CHECK(simulation->diagnostics().device_memory_bytes() == 0);
  simulation->step();
  REQUIRE(simulation->diagnostics().visualization_plan() != nullptr);
  CHECK(memory_of({&simulation->diagnostics().frame_plan(), simulation->diagnostics().visualization_plan()}) ==
        simulation->diagnostics().device_memory_bytes());
  CHECK(sensor_of(simulation->diagnostics().visualization_sensors(), "PEOPLE").due_state == DueState::due);
  CHECK(simulation->diagnostics().visualization_costs()->passes.size() == 1);
  CHECK(simulation->diagnostics().sensor_costs().size() == 3);
  simulation->enable("PEOPLE", false);
  simulation->step();
  CHECK(simulation->diagnostics().visualization_plan()->passes.empty());
  CHECK(simulation->diagnostics().visualization_counters()->draws == 0);
  CHECK(sensor_of(simulation->diagnostics().visualization_sensors(), "PEOPLE").due_state == DueState::off);
}

TEST_CASE("instrumentation changes no byte of results, no counter and no memory; costs exist only with it") {
  const std::string sensors = camera("CAM", R"(outputs="color depth" supersampling="4")") + kScanner;
  WallSimulation with(sensors, true), without(sensors, false);
  for (int frame = 0; frame < 3; ++frame) {
    with->step();
    without->step();
    CHECK(with->color("CAM").pixels == without->color("CAM").pixels);
    CHECK(with->depth("CAM").pixels == without->depth("CAM").pixels);
    CHECK(with->scan("SCAN").range_m == without->scan("SCAN").range_m);
    CHECK(with->scan("SCAN").error_bound_m == without->scan("SCAN").error_bound_m);
    CHECK(with->diagnostics().counters() == without->diagnostics().counters());
    CHECK(with->diagnostics().device_memory_bytes() == without->diagnostics().device_memory_bytes());
  }
  CHECK(with->diagnostics().frame_costs() != nullptr);
  CHECK(without->diagnostics().frame_costs() == nullptr);
  CHECK(without->diagnostics().sensor_costs().empty());
}

TEST_CASE("a step that fails leaves a plan that can be read") {
  WallSimulation simulation(camera("CAM", "") + R"(<sensor type="laser_scanner" name="EXACT" insert_at="ROOT"
    samples="3" method="hybrid" max_error_m="1e-30"/>)");
  CHECK_THROWS_AS(simulation->step(), InputError);
  CHECK(sensor_of(simulation->diagnostics().planned_sensors(), "CAM").due_state == DueState::due);
  simulation->enable("EXACT", false);
  simulation->step();
  CHECK(simulation->diagnostics().frame_plan().passes.size() == 1);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
