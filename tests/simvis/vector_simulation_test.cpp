// Environments that are stepped together measure what single simulations measure, and share what none of them changes.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <simvis/vector_simulation.h>
#include "engine/base/srgb.h"
#include "simvis/vector_simulation_impl.h"
#include "tests/support/error_of.h"
#include "tests/support/every_sensor.h"
#include "tests/support/sensor_bytes.h"
#include "tests/support/sky_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis::test {
namespace {

constexpr std::uint64_t kSeed = 40;
constexpr std::size_t kCount = 3;
const std::string kNoise =
    "<sensor type='laser_scanner' name='NOISY' insert_at='ROBOT' samples='21' range_noise='0.01'/>";
const std::vector<std::size_t> kAll = {0, 1, 2};
// Types of other tests of this program: what they measure depends on all simulations, or differs from what they list.
const std::set<std::string_view> kMadeUp = {"test_run_counter", "wrong_output"};

SimulationDesc desc_with(unsigned threads) {
  SimulationDesc desc;
  desc.seed = kSeed;
  desc.threads = threads;
  return desc;
}

Simulation single(const std::string& xml, std::uint64_t seed, const std::filesystem::path& folder = ".") {
  SimulationDesc desc = desc_with(1);
  desc.seed = seed;
  return Simulation::from_string(xml, desc, folder);
}

VectorSimulation room(unsigned threads = 2, const std::string& sensor = kNoise) {
  return VectorSimulation::from_string(scene_with(sensor), kCount, desc_with(threads));
}

bool has_element(const Simulation& simulation, const std::string& name) {
  return std::ranges::count(simulation.parameters().elements(), name, &ElementDescriptor::name) == 1;
}

double place(std::size_t environment, int frame) { return 0.1 * frame - 0.3 * static_cast<double>(environment); }

// The numbers of an output in one environment as doubles.
std::vector<double> row(const VectorOutput& output, std::size_t environment) {
  const OutputShape& shape = output.output.shape;
  const std::size_t count = size_product({shape.rows, shape.columns, shape.channels});
  std::vector<double> numbers(count);
  std::visit(
      [&](const auto& all) {
        REQUIRE(all.size() == output.environments * count);
        for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<double>(all[environment * count + i]);
      },
      output.numbers);
  return numbers;
}

// The numbers that a measurement has of it: colour without alpha, NaN or 0 if there is no measurement.
std::vector<double> expected_row(const VectorOutput& output, const MeasuredArray& array) {
  const OutputShape& shape = output.output.shape;
  const std::size_t count = size_product({shape.rows, shape.columns, shape.channels});
  const bool whole = std::visit([](const auto& all) { return std::is_integral_v<std::decay_t<decltype(*all.data())>>; },
                                array.numbers);
  std::vector<double> numbers(count, whole ? 0.0 : std::nan(""));
  for (std::size_t i = 0; array.count() > 0 && i < count; ++i) {
    numbers[i] = array.number(i / shape.channels * array.shape.channels + i % shape.channels);
  }
  return numbers;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// Compares three frames of three environments with single simulations of their seeds, and returns how many outputs were
// compared.
int check_environments(const std::string& xml, const std::filesystem::path& folder, unsigned threads) {
  VectorSimulation vector = VectorSimulation::from_string(xml, kCount, desc_with(threads), folder);
  std::vector<Simulation> singles;
  for (std::size_t i = 0; i < kCount; ++i) singles.push_back(single(xml, kSeed + i, folder));
  const bool moves = has_element(singles[0], "MOVE");
  int compared = 0;
  for (int frame = 0; frame < 3; ++frame) {
    if (moves) vector.set("MOVE", "x", std::array{place(0, frame), place(1, frame), place(2, frame)});
    vector.step();
    for (std::size_t i = 0; i < kCount; ++i) {
      if (moves) singles[i].set("MOVE", "x", place(i, frame));
      singles[i].step();
      CHECK(measured_hash(*vector.environment(i)) == measured_hash(singles[i]));
      const Measurement measurement = singles[i].measurement("S");
      for (const MeasuredArray& array : measurement.arrays) {
        if (array.kind == OutputKind::table_column || array.name.ends_with("silhouettes")) continue;
        const VectorOutput& output = vector.output("S", array.name);
        INFO(array.name);
        CHECK(same(row(output, i), expected_row(output, array)));
        ++compared;
      }
    }
  }
  return compared;
}

// While it exists, no environment but the first can be loaded.
struct RefusedEnvironments {
  RefusedEnvironments() {
    call_environments_by([](const std::function<void()>&) { throw InputError("refused"); });
  }
  ~RefusedEnvironments() {
    call_environments_by([](const std::function<void()>& work) { work(); });
  }
};

}  // namespace

TEST_CASE("an environment measures the bytes of a single simulation with its seed, for every sensor") {
  int compared = 0;
  std::set<std::string_view> types;
  for (const SensorType* const type : sensor_types()) {
    if (kMadeUp.contains(type->name)) continue;
    for (const std::string& attributes : attributes_of(type->name)) {
      for (const unsigned threads : {1u, 3u, 8u}) {  // 8: several threads work in one environment
        CAPTURE(type->name);
        CAPTURE(attributes);
        CAPTURE(threads);
        const TemporaryFolder folder;
        const int outputs = check_environments(scene_text_of(type->name, attributes, folder), folder.path(), threads);
        if (outputs > 0) types.insert(type->name);
        compared += outputs;
      }
    }
  }
  CHECK(types.size() > 20);
  CHECK(compared > 3 * 9 * 100);  // threads, environments and frames, outputs
}

TEST_CASE("environments differ by their seeds alone") {
  VectorSimulation vector = room();
  vector.step();
  const VectorOutput& ranges = vector.output("NOISY", "range_m");
  CHECK(ranges.environments == kCount);
  CHECK(ranges.output.shape == OutputShape{1, 21, 1});
  CHECK(ranges.output.unit == "m");
  for (std::size_t i = 0; i < kCount; ++i) {
    Simulation alone = single(scene_with(kNoise), kSeed + i);
    alone.step();
    const std::vector<float>& expected = alone.scan("NOISY").range_m;
    CHECK(same(row(ranges, i), {expected.begin(), expected.end()}));
  }
  CHECK(!same(row(ranges, 0), row(ranges, 1)));
  CHECK(!same(row(ranges, 1), row(ranges, 2)));
}

TEST_CASE("an output is kept by its copies, and has nothing before the first measurement") {
  VectorSimulation vector = room();
  const VectorOutput& ranges = vector.output("NOISY", "range_m");
  for (const double range : row(ranges, 1)) CHECK(std::isnan(range));
  vector.step();
  const VectorOutput before = ranges;
  const std::vector<double> numbers = row(before, 2);
  vector.set("MOVE", "x", std::array{0.5});
  vector.step();
  CHECK(same(row(before, 2), numbers));
  CHECK(!same(row(ranges, 2), numbers));
  CHECK(&vector.output("NOISY", "range_m") == &ranges);
  VectorSimulation moved = std::move(vector);
  CHECK(&moved.output("NOISY", "range_m") == &ranges);
  CHECK(contains(error_of([&] { vector.step(); }), "was moved from"));  // NOLINT(bugprone-use-after-move)
}

TEST_CASE("codes of colours are those of sRGB") {
  VectorSimulation vector = room(2, "<sensor type='camera' name='S' insert_at='ROBOT' width='8' height='6'/>");
  vector.set("MOVE", "y", std::array{0.0, 1.0, 2.0});
  vector.step();
  const VectorOutput& codes = vector.output("S", "rgb");
  CHECK(codes.output.shape == OutputShape{6, 8, 3});
  CHECK(codes.output.value_type == ValueType::u8);
  for (std::size_t i = 0; i < kCount; ++i) {
    const Image color = vector.environment(i)->color("S");
    std::vector<std::uint8_t> expected(std::size_t{6} * 8 * 3);
    srgb_codes(color.pixels, expected);
    CHECK(same(row(codes, i), {expected.begin(), expected.end()}));
  }
  CHECK(!same(row(codes, 0), row(codes, 2)));
}

TEST_CASE("parameters are set in all environments or in none") {
  VectorSimulation vector = room();
  vector.set("MOVE", "x", std::array{1.0, 2.0, 3.0});
  CHECK(vector.get("MOVE", "x") == std::vector{1.0, 2.0, 3.0});
  vector.set("MOVE", "y", std::array{4.0});
  CHECK(vector.get("MOVE", "y") == std::vector{4.0, 4.0, 4.0});
  CHECK(contains(error_of([&] { vector.set("NECK", "value", std::array{1.0, 2.0, 30.0}); }), "(environment 2)"));
  CHECK(vector.get("NECK", "value") == std::vector{0.0, 0.0, 0.0});
  CHECK(error_of([&] { vector.set("MOVE", "x", std::array{1.0, 2.0}); }) == "MOVE.x has 2 values, expected 1 or 3");
  CHECK(contains(error_of([&] { vector.set("MOVE", "x", std::array{std::nan("")}); }), "MOVE.x"));
  CHECK(contains(error_of([&] { vector.set("MVE", "x", std::array{1.0}); }), "did you mean \"MOVE\"?"));
  CHECK(contains(error_of([&] { static_cast<void>(vector.get("MOVE", "z2")); }), "no parameter \"z2\""));
}

TEST_CASE("if an environment fails, the others make their frame") {
  // A range of 32 to 64 m as float32 is rounded by up to 2^-19 m = 1.9e-6 m, and 60.175 m by more than the tolerance.
  // The other ranges are multiples of 1/8 m, which float32 has.
  const std::string exact =
      "<sensor type='laser_scanner' name='S' insert_at='ROBOT' samples='1' min_angle='0' max_angle='0' method='hybrid' "
      "max_error_m='1e-7'/>";
  constexpr double kFar_m = -57.3;
  VectorSimulation vector = room(2, exact);
  vector.step();
  const VectorOutput& ranges = vector.output("S", "range_m");
  vector.set("MOVE", "x", std::array{1.0, kFar_m, 0.5});
  const std::string message = error_of([&] { vector.step(); });
  CHECK(contains(message, "(environment 1)"));
  CHECK(std::vector(vector.failed().begin(), vector.failed().end()) == std::vector<std::size_t>{1});
  CHECK(row(ranges, 0)[0] == doctest::Approx(3 - 0.125 - 1.0));
  CHECK(row(ranges, 2)[0] == doctest::Approx(3 - 0.125 - 0.5));
  CHECK(vector.environment(0)->last_frame()->index == 1);
  CHECK(vector.environment(1)->last_frame()->index == 0);
  vector.set("MOVE", "x", std::array{1.0, 0.25, kFar_m});
  vector.step(std::array<std::size_t, 1>{1});  // the frame is tried again
  CHECK(vector.failed().empty());
  CHECK(row(ranges, 1)[0] == doctest::Approx(3 - 0.125 - 0.25));
  CHECK(vector.environment(1)->last_frame()->index == 1);
  vector.set("MOVE", "x", std::array{kFar_m, 0.25, kFar_m});
  CHECK(contains(error_of([&] { vector.step(); }), "(environment 0; these have failed too: 2)"));
}

TEST_CASE("after an error of a consumer, an environment has made its frame and has not failed") {
  const TemporaryFolder folder;
  VectorSimulation vector = room();
  vector.environment(1)->record({.file = folder / "run.mcap"});
  std::filesystem::create_directory(folder / "run.mcap");  // no recording can be made here
  const std::string message = message_of<OutletError>([&] { vector.step(); });
  CHECK(contains(message, "recording: "));
  CHECK(contains(message, "(environment 1)"));
  CHECK(vector.failed().empty());
  vector.step();
  for (const std::size_t i : kAll) CHECK(vector.environment(i)->last_frame()->index == 1);
}

TEST_CASE("an error of a frame that was not made comes before those of consumers, whose frames were made") {
  const TemporaryFolder folder;
  VectorSimulation vector = room();
  vector.environment(0)->record({.file = folder / "run.mcap"});
  std::filesystem::create_directory(folder / "run.mcap");  // no recording can be made here
  static_cast<void>(vector.output("NOISY", "range_m"));
  vector.environment(2)->execute("<remove name='NOISY'/>");
  const std::string message = message_of<InputError>([&] { vector.step(); });
  CHECK(contains(message, "there is no sensor \"NOISY\" (environment 2; these have failed too: 0)"));
  CHECK(std::vector(vector.failed().begin(), vector.failed().end()) == std::vector<std::size_t>{2});
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) CHECK(vector.environment(i)->last_frame()->index == 0);
  CHECK_FALSE(vector.environment(2)->last_frame().has_value());
}

TEST_CASE("an environment that is not stepped and lacks an output does not hide the error of a consumer") {
  const TemporaryFolder folder;
  VectorSimulation vector = room();
  vector.environment(1)->record({.file = folder / "run.mcap"});
  std::filesystem::create_directory(folder / "run.mcap");  // no recording can be made here
  static_cast<void>(vector.output("NOISY", "range_m"));
  vector.environment(0)->execute("<remove name='NOISY'/>");
  const std::string message = message_of<OutletError>([&] { vector.step(std::array<std::size_t, 1>{1}); });
  CHECK(contains(message, "recording: "));
  CHECK(contains(message, "(environment 1; these have failed too: 0)"));
  CHECK(vector.failed().empty());
  CHECK(vector.environment(1)->last_frame()->index == 0);
  CHECK(contains(error_of([&] { vector.step(std::array<std::size_t, 1>{1}); }), "(environment 0)"));
}

TEST_CASE("an environment without an output has nothing there, makes no frame, and shows its other outputs") {
  VectorSimulation vector = room(2, kNoise + "<sensor type='laser_scanner' name='KEPT' insert_at='ROBOT'/>");
  const VectorOutput& missing = vector.output("NOISY", "range_m");
  const VectorOutput& kept = vector.output("KEPT", "range_m");
  vector.step();
  const VectorOutput missing_before = missing, kept_before = kept;  // the next rows are written to other memory
  vector.environment(2)->execute("<remove name='NOISY'/>");
  vector.set("MOVE", "x", std::array{1.0});
  CHECK(contains(error_of([&] { vector.step(); }), "there is no sensor \"NOISY\" (environment 2)"));
  CHECK(std::vector(vector.failed().begin(), vector.failed().end()) == std::vector<std::size_t>{2});
  for (const double range : row(missing, 2)) CHECK(std::isnan(range));
  CHECK(same(row(kept, 2), row(kept_before, 2)));
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
    CHECK(!same(row(missing, i), row(missing_before, i)));
    CHECK(!same(row(kept, i), row(kept_before, i)));
    CHECK(vector.environment(i)->last_frame()->index == 1);
  }
  CHECK(vector.environment(2)->last_frame()->index == 0);
  CHECK(contains(error_of([&] { vector.step(std::array<std::size_t, 1>{0}); }), "(environment 2)"));
  CHECK(vector.failed().empty());  // only environment 0 was to make a frame
  CHECK(vector.environment(0)->last_frame()->index == 2);
}

TEST_CASE("if environments cannot be loaded, the error names all of them, whatever the number of threads is") {
  const RefusedEnvironments refused;
  for (const unsigned threads : {1u, 2u, 8u}) {
    CHECK(error_of([&] { room(threads); }) == "refused (environment 1; these have failed too: 2)");
  }
}

TEST_CASE("errors of single environments name them: in load, set and get") {
  const TemporaryFolder folder;
  write_text(folder / "wall.obj", "v 1 0 0\nv 1 1 0\nv 1 0 1\nf 1 2 3\n");
  const std::string sensor = "<sensor type='laser_scanner' name='S' insert_at='ROOT' samples='3'/>";
  SimulationDesc desc = desc_with(1);
  desc.progress = [&](const Progress&) { std::filesystem::remove(folder / "wall.obj"); };  // when 0 and 1 are loaded
  const std::string message = error_of([&] {
    VectorSimulation::from_string("<s><part name='P' insert_at='ROOT' file='wall.obj'/>" + sensor + "</s>", kCount,
                                  desc, folder.path());
  });
  CHECK(contains(message, "there is no part file"));
  CHECK(message.ends_with(" (environment 2)"));
  VectorSimulation vector = room();
  vector.environment(1)->execute("<remove name='NECK'/>");
  CHECK(error_of([&] { vector.set("NECK", "value", std::array{1.0}); }).ends_with(" (environment 1)"));
  CHECK(vector.environment(0)->get("NECK", "value") == 0);
  CHECK(error_of([&] { static_cast<void>(vector.get("NECK", "value")); }).ends_with(" (environment 1)"));
}

TEST_CASE("the progress of loading ends with the number of environments") {
  for (const std::size_t count : {std::size_t{1}, kCount}) {
    for (const unsigned threads : {1u, 2u, 8u}) {
      std::vector<Progress> all;
      SimulationDesc desc = desc_with(threads);
      desc.progress = [&](const Progress& progress) { all.push_back(progress); };
      VectorSimulation::from_string(scene_with(kNoise), count, desc);
      REQUIRE(!all.empty());
      CHECK(all.back().done == count);
      for (std::size_t i = 0; i < all.size(); ++i) {
        CHECK(all[i].total == count);
        if (i > 0) CHECK(all[i - 1].done < all[i].done);
      }
    }
  }
}

TEST_CASE("some environments go back to their states, and the others go on") {
  VectorSimulation vector = room();
  const std::vector<std::size_t> some = {2, 0};
  CHECK(contains(error_of([&] { vector.restore_states(some); }), "environment 2 has no state to restore"));
  vector.step();
  vector.save_states();
  const VectorOutput& ranges = vector.output("NOISY", "range_m");
  std::vector<std::vector<double>> frames;
  for (int frame = 0; frame < 2; ++frame) {
    vector.set("MOVE", "x", std::array{place(0, frame)});
    vector.step();
    for (std::size_t i = 0; i < kCount; ++i) frames.push_back(row(ranges, i));
  }
  vector.restore_states(some);
  vector.set("MOVE", "x", std::array{place(0, 0)});
  vector.step();
  CHECK(same(row(ranges, 0), frames[0]));
  CHECK(same(row(ranges, 2), frames[2]));
  CHECK(!same(row(ranges, 1), frames[1]));
  CHECK(vector.environment(1)->last_frame()->index == 3);
}

TEST_CASE("if one environment cannot go back to its state, it stays and the others go back") {
  VectorSimulation vector = room();
  vector.step();
  vector.save_states();
  vector.step();
  vector.environment(1)->execute("<remove name='NECK'/>");
  const std::string message = error_of([&] { vector.restore_states(kAll); });
  CHECK(contains(message, "the state is of another scene"));
  CHECK(message.ends_with(" (environment 1)"));
  for (const std::size_t i : kAll) CHECK(vector.environment(i)->next_frame().index == (i == 1 ? 2u : 1u));
}

TEST_CASE("an environment that is loaded again has another seed, and the same sensors on") {
  VectorSimulation vector = room(2, kNoise + "<sensor type='imu' name='IMU' insert_at='ROBOT'/>");
  for (const std::size_t i : kAll) vector.environment(i)->enable("IMU", false);
  vector.step();
  vector.save_states();
  const std::shared_ptr<Simulation> before = vector.environment(1);
  vector.reload(std::array<std::size_t, 1>{1}, std::array<std::uint64_t, 1>{7});
  CHECK(vector.environment(1) != before);
  CHECK(before->last_frame()->index == 0);  // it lives as long as it is held
  CHECK(!vector.environment(1)->last_frame());
  CHECK(contains(error_of([&] { vector.restore_states(kAll); }), "environment 1 has no state"));
  vector.step();
  Simulation alone = single(scene_with(kNoise), 7);
  alone.step();
  const std::vector<float>& expected = alone.scan("NOISY").range_m;
  CHECK(same(row(vector.output("NOISY", "range_m"), 1), {expected.begin(), expected.end()}));
  CHECK(vector.environment(1)->measured().size() == 1);
  CHECK(
      contains(error_of([&] { vector.reload(kAll, std::array<std::uint64_t, 1>{7}); }), "1 seeds for 3 environments"));
}

TEST_CASE("meshes are there once") {
  const VectorSimulation vector = room(2, "<sensor type='camera' name='S' insert_at='ROBOT' width='8' height='6'/>");
  const DrawList& first = vector.environment(0)->diagnostics().draw_list();
  REQUIRE(!first.meshes.empty());
  for (const std::size_t i : kAll) CHECK(vector.environment(i)->diagnostics().draw_list().meshes == first.meshes);
}

TEST_CASE("pictures of the sky are there once, from whatever files they come") {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name, float radiance) {
    write_text(folder / name, sky_exr(sky_picture(4, [&](auto, auto) { return glm::vec3(radiance); })));
  };
  write("day.exr", 1);
  write("copy.exr", 1);
  write("night.exr", 0.5f);
  const auto load = [&](const std::string& name) {
    return VectorSimulation::from_string(
        "<s><element type='sky_light' name='SKY' insert_at='ROOT' picture='" + name + "'/></s>", kCount, desc_with(2),
        folder.path());
  };
  const VectorSimulation day = load("day.exr"), copy = load("copy.exr"), night = load("night.exr");
  const auto sky = [](const VectorSimulation& vector, std::size_t i) {
    return vector.environment(i)->diagnostics().draw_list().sky.picture;
  };
  REQUIRE(sky(day, 0) != nullptr);
  for (const std::size_t i : kAll) {
    CHECK(sky(day, i) == sky(day, 0));
    CHECK(sky(copy, i) == sky(day, 0));
    CHECK(sky(night, i) == sky(night, 0));
  }
  CHECK(sky(night, 0) != sky(day, 0));
}

TEST_CASE("mistakes with environments and outputs") {
  for (const std::size_t count : {std::size_t{0}, std::size_t{65537}}) {
    CHECK(error_of([&] { VectorSimulation::from_string("<simvis/>", count); }) ==
          std::to_string(count) + " environments are not possible, expected 1 to 65536");
  }
  CHECK(contains(error_of([] { VectorSimulation::from_string("<simvis><prt/></simvis>", 2); }), "<string>:1:"));
  VectorSimulation vector = room(2, kNoise +
                                        "<sensor type='camera' name='CAM' insert_at='ROBOT' width='8' height='6' "
                                        "outputs='color boxes'/>");
  CHECK(contains(error_of([&] { vector.output("NOSY", "range_m"); }), "did you mean \"NOISY\"?"));
  CHECK(contains(error_of([&] { vector.output("NOISY", "rang_m"); }), "did you mean \"range_m\"?"));
  CHECK(contains(error_of([&] { vector.output("NOISY", "rgb"); }), "has no output \"rgb\""));
  CHECK(contains(error_of([&] { vector.output("CAM", "box_class"); }), "expected"));
  CHECK(contains(error_of([&] { vector.environment(3); }), "there is no environment 3, expected one below 3"));
  CHECK(contains(error_of([&] { vector.step(std::vector<std::size_t>{0, 0}); }), "environment 0 comes twice"));
  CHECK(contains(error_of([&] { vector.step(std::vector<std::size_t>{9}); }), "no environment 9"));
  // A scene that was changed by itself.
  vector.output("NOISY", "range_m");
  vector.step();
  vector.environment(2)->execute("<remove name='NOISY'/>");
  CHECK(contains(error_of([&] { vector.step(); }), "there is no sensor \"NOISY\" (environment 2)"));
  vector.environment(2)->execute("<sensor type='laser_scanner' name='NOISY' insert_at='ROBOT' samples='5'/>");
  const std::string other = error_of([&] { vector.step(); });
  CHECK(contains(other, "has the shape 1 x 5, expected that of the other environments, 1 x 21 (environment 2)"));
}

}  // namespace simvis::test
