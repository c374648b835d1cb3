// States of sensors that remember more than poses: event cameras, cameras with flow, scanners that choose their method,
// and cameras for people, with what they show.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <simvis/cost_model.h>
#include <simvis/device.h>
#include <simvis/simulation.h>
#include <simvis/version.h>
#include "engine/base/fnv1a.h"
#include "tests/state/saved_state.h"
#include "tests/support/long_count.h"
#include "tests/support/parts/animated_part.h"
#include "tests/support/random_numbers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("state");

namespace simvis::test {
namespace {

struct Remembering {
  std::string type, attributes;
};

const std::string kSize = "width='16' height='12' ";

// Nothing of them depends on earlier measurements but flow of drawn images, so that their frames can be skipped.
std::vector<Remembering> flows() {
  const std::string all = kSize + "outputs='color flow_backward flow_forward scene_flow";
  return {{"camera", all + "'"},
          {"camera", all + " occlusion'"},
          {"camera", all + "' row_time='0.002'"},
          {"camera", all + " occlusion' row_time='0.002'"},
          {"camera", all + "' exposure_time='0.02'"},
          {"camera", all + "' distortion='brown_conrady' k1='-0.2'"},
          {"camera", kSize + "outputs='depth flow_forward' layer='first'"},
          {"stereo_camera", kSize + "outputs='color flow_backward flow_forward'"}};
}

std::vector<Remembering> others() {
  const std::string picture = "width='8' height='6' picture='on' step='1' time_error='0.001' ";
  return {{"event_camera", picture},
          {"event_camera", picture + "leak='20' threshold_noise='0.05' refractory='0.03' latency='0.15' "
                                     "latency_noise='0.05'"},
          {"event_camera", picture + "cutoff='30' shot_noise='20'"},
          {"event_camera", picture + "brownian='0.3' brownian_dark='0.1' leak_light='5'"},
          {"laser_scanner", "samples='61' method='auto' max_error_rel='0.01' resolution='128'"},
          {"camera", kSize + "view='visualization'"},
          {"camera", kSize + "view='visualization' auto_exposure='0.18' auto_exposure_time='0.2'"}};
}

/// What becomes of the sensors while frames are made.
struct Situation {
  std::string name, attributes;
  bool skips = false, switches = false;
};

std::vector<Situation> situations() {
  return {{.name = "running", .attributes = ""},
          {.name = "delayed", .attributes = " delay='0.15' delay_jitter='0.1' drop='0.2' freeze='0.3'"},
          {.name = "at a slower rate", .attributes = " rate='4'"},
          {.name = "switched off and on", .attributes = "", .switches = true}};
}

/// The measurements of a frame, by the names of sensors, and the surveys of those that choose their method.
using Hashes = std::vector<std::pair<std::string, std::uint64_t>>;

Hashes hashes_of(const Simulation& simulation) {
  Hashes hashes;
  for (const std::string& name : simulation.measured()) {
    SensorBytes bytes;
    bytes.add(simulation.measurement(name));
    hashes.emplace_back(name, bytes.hash());
  }
  for (const SensorInfo& each : simulation.sensors()) {
    if (each.method == "auto") hashes.emplace_back(each.name, fnv1a(each.report.explanation));
  }
  return hashes;
}

/// Costs of a device on which `auto` renders, or of one on which it casts.
const std::filesystem::path& cache_of_costs(bool renders) {
  static const TemporaryFolder folders[2];
  static const bool are_written = [] {
    Device device;
    for (const bool cheap_to_render : {false, true}) {
      CostModel costs;
      for (std::size_t i = 0; i < kCostTerms; ++i) {
        costs.of[i] = (i < static_cast<std::size_t>(CostTerm::cast)) == cheap_to_render ? 0.001 : 1000;
      }
      save_cost_model(cost_model_file(device, folders[cheap_to_render ? 1 : 0].path(), version()), costs);
    }
    return true;
  }();
  REQUIRE(are_written);
  return folders[renders ? 1 : 0].path();
}

class Scene {
 public:
  Scene(std::vector<Remembering> sensors, Situation situation)
      : sensors_(std::move(sensors)), situation_(std::move(situation)) {
    write_text(folder_ / "strip.gltf", bending_strip().text());
  }

  Simulation load(bool auto_renders = true) const {
    SimulationDesc desc;
    desc.device.cache_dir = cache_of_costs(auto_renders).string();
    return Simulation::from_string(xml(), desc, folder_.path());
  }

  /// Makes the next frame.
  Hashes make(Simulation& simulation) const {
    const std::uint64_t frame = simulation.next_frame().index;
    control(simulation, frame);
    if (situation_.skips && frame % 3 == 2) {
      simulation.skip_frame();
      return {};
    }
    simulation.step();
    return hashes_of(simulation);
  }

 private:
  // A box that goes and turns, a strip that bends and rests, paint that changes, a part that is hidden for some frames.
  std::string xml() const {
    std::string xml = R"(
      <element type='light' name='SUN' insert_at='ROOT'/>
      <part name='WALL' insert_at='ROOT' shape='box' size='0.25 6 4' pose_offset='5 0 0 0 0 0'/>
      <part name='STRIP' insert_at='ROOT' file='strip.gltf' up='z' pose_offset='0 1.5 -1 0 0 0'/>
      <element type='animation' name='BEND' insert_at='ROOT' part='STRIP'/>
      <part name='BOX' insert_at='ROOT' shape='box' size='0.6 0.6 0.6' pose_offset='3 -0.5 0 0 0 0'/>
      <element type='pose' name='SHIFT' insert_at='BOX'/>
      <part name='TIP' insert_at='BOX' pose_offset='0 0 0.5 0 0 0'/>
      <element type='material' name='PAINT' insert_at='ROOT' part='BOX'/>
      <part name='CUBE' insert_at='ROOT' shape='box' size='0.5 0.5 0.5' pose_offset='2.5 0.4 0.3 0 0 0'/>
      <element type='visibility' name='SHOWN' insert_at='CUBE'/>
      <part name='OLD' insert_at='ROOT' shape='box' size='0.4 0.4 0.5' pose_offset='2 0.2 -0.3 0 0 0'/>
      <part name='ROBOT' insert_at='ROOT'/>
      <element type='pose' name='MOVE' insert_at='ROBOT'/>
      <element type='trail' name='PATH' insert_at='ROOT' part='TIP' step='0.02' keep='5' width='0.1'/>
      <sensor type='laser_scanner' name='SCAN' insert_at='ROBOT' samples='41' rate='5'/>
      <element type='laser_beams' name='BEAMS' insert_at='ROOT' scanner='SCAN' width='0.05' size='0.2'/>
      <element type='point_cloud' name='HITS' insert_at='ROOT' scanner='SCAN' keep='2' size='0.2'/>)";
    int number = 0;
    for (const Remembering& each : sensors_) {
      xml += "\n<sensor type='" + each.type + "' name='" + name(number++) + "' insert_at='ROBOT' " + each.attributes +
             situation_.attributes + "/>";
    }
    return xml;
  }
  static std::string name(int number) { return "S" + std::to_string(number); }

  void control(Simulation& simulation, std::uint64_t frame) const {
    const auto k = static_cast<double>(frame);
    simulation.set("SHIFT", "y", 0.08 * k);
    simulation.set("SHIFT", "yaw", 5 * k);
    simulation.set("MOVE", "y", 0.01 * k * k);
    simulation.set("MOVE", "yaw", frame > 5 ? k : 0);  // before, most pixels see nothing that moves
    simulation.set("BEND", "time", frame < 4 ? 0.2 * k : 0.8);
    simulation.set("SHOWN", "visible", frame % 5 == 3 ? 0 : 1);
    simulation.set("PAINT", "red", frame >= 6 ? 0.2 : 1);
    simulation.set("BEAMS", "red", frame >= 5 ? 0 : 1);
    if (!situation_.switches) return;
    if (frame == 0 || frame == 5) simulation.enable("SCAN", frame == 5);
    for (int i = 0; i < static_cast<int>(sensors_.size()); ++i) {
      if (frame == 2 || frame == 5) simulation.enable(name(i), frame == 5);
    }
  }

  TemporaryFolder folder_;
  std::vector<Remembering> sensors_;
  Situation situation_;
};

// Compares all frames that follow the states of all frames, in turn in this simulation and in new ones.
void check_goes_on(const Scene& scene) {
  constexpr std::size_t kFrames = 9;
  Simulation simulation = scene.load(), unsaved = scene.load();
  std::vector<std::string> states;
  std::vector<Hashes> frames;
  for (std::size_t i = 0; i < kFrames; ++i) {
    states.push_back(simulation.save_state());
    frames.push_back(scene.make(simulation));
    CHECK(scene.make(unsaved) == frames.back());  // saving changes nothing
  }
  const auto check_from = [&](std::size_t from, Simulation& restored) {
    CAPTURE(from);
    restored.restore_state(states[from]);
    CHECK(restored.save_state() == states[from]);
    for (std::size_t i = from; i < std::min(from + 3, kFrames); ++i) {
      CAPTURE(i);
      CHECK(scene.make(restored) == frames[i]);
    }
  };
  for (std::size_t from = kFrames; from-- > 0;) check_from(from, simulation);
  for (const std::size_t first : {3, 6}) {
    Simulation fresh = scene.load();
    for (const std::size_t from : {first, first - 2, first + 1}) check_from(from, fresh);
  }
}

TEST_CASE("event cameras, scanners of method auto and cameras for people go on to the bit") {
  for (const Situation& each : situations()) {
    CAPTURE(each.name);
    check_goes_on(Scene(others(), each));
  }
}

TEST_CASE("flow goes on to the bit, also if frames are skipped") {
  std::vector<Situation> all = situations();
  all.push_back({.name = "skipped", .attributes = "", .skips = true});
  all.push_back({.name = "skipped at a slower rate", .attributes = " rate='4'", .skips = true});
  for (const Situation& each : all) {
    CAPTURE(each.name);
    check_goes_on(Scene(flows(), each));
  }
}

TEST_CASE("the eyes of a stereo camera save their scene once") {
  constexpr int kBoxes = 300;
  std::string boxes;
  for (int i = 0; i < kBoxes; ++i) {
    boxes += "<part name='B" + std::to_string(i) + "' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='" +
             std::to_string(i) + " 0 0 0 0 0'/>";
  }
  const auto size_with = [&](const std::string& type) {
    Simulation simulation =
        Simulation::from_string("<s>" + boxes + "<sensor type='" + type +
                                "' name='C' insert_at='ROOT' outputs='flow_backward normal' " + kSize + "/></s>");
    simulation.step();
    return simulation.save_state().size();
  };
  CHECK(size_with("stereo_camera") <
        size_with("camera") + kBoxes * sizeof(glm::dmat4) / 2);  // a box has a place each time
}

// Nothing is left of the frames that followed the state before.
TEST_CASE("flow goes on in another way than before") {
  std::vector<Situation> ways = situations();
  ways.resize(1);
  ways.push_back({.name = "skipped", .attributes = "", .skips = true});
  for (const Situation& each : ways) {
    CAPTURE(each.name);
    const Scene before(flows(), each), scene(flows(), situations().front());
    Simulation simulation = before.load();
    std::vector<std::string> states;
    for (int i = 0; i < 6; ++i) {
      states.push_back(simulation.save_state());
      static_cast<void>(before.make(simulation));
    }
    for (const std::size_t from : {1, 3}) {
      Simulation fresh = before.load();
      std::vector<Hashes> frames[2];
      for (Simulation* const restored : {&simulation, &fresh}) {
        restored->restore_state(states[from]);
        for (int i = 0; i < 3; ++i) {
          restored->set("MOVE", "z", 0.1);
          frames[restored == &fresh ? 1 : 0].push_back(scene.make(*restored));
        }
      }
      CHECK(frames[0] == frames[1]);
    }
  }
}

// The last frame shows what the state has no more: values that have been set since, and a part that is gone.
TEST_CASE("changes between the last frame and the state are changes of the next frame") {
  const auto set = [](Simulation& simulation) {
    simulation.set("PAINT", "green", 0.1);
    simulation.set("BEND", "time", 1.5);
    simulation.set("PATH", "red", 0.7);
  };
  const auto request = [](Simulation& simulation) {
    simulation.execute("<remove name='OLD'/>");
    simulation.execute("<part name='NEW' insert_at='ROOT' shape='box' size='0.6 0.6 0.6' pose_offset='2 0 0 0 0 0'/>");
  };
  for (const std::vector<Remembering>& sensors : {others(), flows()}) {
    const Scene scene(sensors, situations().front());
    for (const bool requests : {false, true}) {
      CAPTURE(requests);
      Simulation simulation = scene.load();
      for (int i = 0; i < 3; ++i) static_cast<void>(scene.make(simulation));
      requests ? request(simulation) : set(simulation);
      const std::string state = simulation.save_state();
      simulation.step();
      const std::vector<Hashes> expected{hashes_of(simulation), scene.make(simulation)};
      Simulation fresh = scene.load();
      if (requests) request(fresh);
      for (Simulation* const restored : {&simulation, &fresh}) {
        restored->restore_state(state);
        CHECK(restored->save_state() == state);
        restored->step();
        CHECK(hashes_of(*restored) == expected[0]);
        CHECK(scene.make(*restored) == expected[1]);
      }
    }
  }
}

// The last sensor measures when all others have, and finds that it cannot.
void check_failed_frame(int frames_before) {
  CAPTURE(frames_before);
  std::vector<Remembering> sensors = others();
  for (const Remembering& each : flows()) sensors.push_back(each);
  sensors.push_back({"laser_scanner", "samples='3' method='hybrid' max_error_m='1e-300'"});
  const std::string failing = "S" + std::to_string(sensors.size() - 1);
  const Scene scene(sensors, situations().front());
  const auto load = [&] {
    Simulation simulation = scene.load();
    simulation.enable(failing, false);
    return simulation;
  };
  Simulation simulation = load();
  for (int i = 0; i < frames_before; ++i) static_cast<void>(scene.make(simulation));
  simulation.enable(failing, true);
  CHECK_THROWS_AS(scene.make(simulation), InputError);
  simulation.enable(failing, false);
  const std::string state = simulation.save_state();
  const std::vector<Hashes> expected{scene.make(simulation), scene.make(simulation)};
  Simulation fresh = load();
  for (Simulation* const restored : {&simulation, &fresh}) {
    restored->restore_state(state);
    for (const Hashes& each : expected) CHECK(scene.make(*restored) == each);
  }
}

// The first frame has the time at which nothing has been measured yet.
TEST_CASE("a frame that failed is made again from its state") {
  for (const int frames_before : {0, 4}) check_failed_frame(frames_before);
}

TEST_CASE("restores of files at random frames, in turn in two simulations") {
  constexpr int kFrames = 12;
  const int restores = count_of("SIMVIS_TEST_RESTORES", sanitized() ? 6 : 60);
  std::vector<Remembering> sensors = others();
  for (const std::size_t each : {0, 1, 7}) sensors.push_back(flows()[each]);
  const Scene scene(sensors, situations()[1]);
  const TemporaryFolder folder;
  const auto file = [&](std::size_t frame) { return folder / ("state" + std::to_string(frame)); };
  Simulation simulation = scene.load(), other = scene.load(false);  // which has other costs until it is restored
  std::vector<Hashes> frames;
  for (std::size_t i = 0; i < kFrames; ++i) {
    write_text(file(i), simulation.save_state());
    frames.push_back(scene.make(simulation));
  }
  Random random;
  int equal = 0;
  for (int i = 0; i < restores; ++i) {
    const std::size_t from = random.below(kFrames);
    Simulation& restored = i % 2 == 0 ? simulation : other;
    restored.restore_state(read_text(file(from)));
    equal += scene.make(restored) == frames[from];
  }
  CHECK(equal == restores);
}

// Of numbers that no run has, those that are taken make frames.
TEST_CASE("a state of a stranger is refused and changes nothing, or makes frames, with everything that is remembered") {
  std::vector<Remembering> sensors = others();
  for (const Remembering& each : flows()) sensors.push_back(each);
  const Scene scene(sensors, situations().front());
  Simulation simulation = scene.load();
  for (int i = 0; i < 5; ++i) static_cast<void>(scene.make(simulation));
  const std::string state = simulation.save_state();
  const Hashes after = scene.make(simulation);
  simulation.restore_state(state);
  const std::size_t begin = begin_of_content(state), sensors_begin = state.find("sensor \"S0\"");
  REQUIRE(sensors_begin != state.npos);
  Random random;
  int refused = 0, taken = 0;
  const int tries = count_of("SIMVIS_TEST_INPUTS", 150);
  for (int i = 0; i < tries; ++i) {
    static constexpr std::uint64_t kNumbers[] = {~0ull,      0x7ff8000000000000, 0x7fefffffffffffff,
                                                 1ull << 40, 1u << 31,           0};
    const std::size_t from = i % 4 == 0 ? begin : sensors_begin;
    std::string changed = state;
    std::memcpy(changed.data() + from + random.below(changed.size() - from - 8), &kNumbers[random.below(6)], 8);
    try {
      simulation.restore_state(with_right_hash(changed));
      ++taken;
      simulation.step();
    } catch (const Error&) {
      ++refused;
    }
    simulation.restore_state(state);
  }
  CHECK(refused > tries / 20);
  CHECK(taken > tries / 20);
  CHECK(scene.make(simulation) == after);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
