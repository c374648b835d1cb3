// Timing faults: an estimator that knows only what consumers get recovers delay, jitter, losses, repetitions and drift.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <simvis/simulation.h>
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/every_sensor.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

constexpr double kNanosecond_s = 1e-9;
// Of a normal distribution: all but one in a million.
constexpr double kOneInAMillion = 4.9;

/// What a consumer gets in a frame, with the true times beside it.
struct Delivery {
  std::int64_t frame_ns = 0, stamp_ns = 0;
  double captured_s = 0, arrived_s = 0;

  bool operator==(const Delivery&) const = default;
};

std::vector<Delivery> deliveries(Simulation& simulation, int frames, std::string_view sensor = kSensor) {
  std::vector<Delivery> all;
  for (int frame = 0; frame < frames; ++frame) {
    simulation.step();
    if (std::ranges::count(simulation.measured(), sensor) == 0) continue;
    const Measurement measurement = simulation.measurement(sensor);
    all.push_back({simulation.last_frame()->time_ns, measurement.time_ns, *measurement.value("capture_time_s"),
                   *measurement.value("arrival_time_s")});
  }
  return all;
}

SimulationDesc timed(bool when_due, std::uint64_t seed, double rate_hz) {
  SimulationDesc desc;
  desc.rate_hz = rate_hz;
  desc.frames_when_due = when_due;
  desc.seed = seed;
  return desc;
}

Simulation delayed_imu(const std::string& attributes, const SimulationDesc& desc, const std::string& others = {}) {
  return Simulation::from_string(
      "<simvis>" + others + "<sensor type='imu' name='S' insert_at='ROOT' " + attributes + "/></simvis>", desc);
}

/// Small images, because only times matter.
std::string small_images(std::string_view type) {
  const std::vector<std::string> all = attributes_of(type);
  const auto small = std::ranges::find_if(all, [](const std::string& each) { return each.find("width") != each.npos; });
  return small == all.end() ? all.front() : *small;
}

}  // namespace

TEST_CASE("an estimator recovers delay, jitter, losses and drift from what consumers get") {
  constexpr int kFrames = 20000;
  constexpr double kRate_hz = 100, kDelay_s = 0.023, kJitter_s = 0.008, kDrop = 0.1, kDrift = 3e-4, kOffset_s = 0.25;
  const std::string attributes =
      "rate='100' delay='0.023' delay_jitter='0.008' drop='0.1' clock_drift='3e-4' clock_offset='0.25'";
  for (const bool when_due : {false, true}) {
    for (const std::uint64_t seed : {0u, 7u}) {
      CAPTURE(when_due);
      CAPTURE(seed);
      Simulation simulation = delayed_imu(attributes, timed(when_due, seed, kRate_hz));
      const std::vector<Delivery> all = deliveries(simulation, kFrames);
      REQUIRE(all.size() > 15000);
      const auto n = static_cast<double>(all.size());
      // Stamps are a line over the true times: the errors are those of two roundings to a nanosecond over the whole.
      const double span_s = all.back().captured_s - all.front().captured_s;
      const double drift = static_cast<double>(all.back().stamp_ns - all.front().stamp_ns) * kNanosecond_s / span_s - 1;
      CHECK(std::abs(drift - kDrift) <= 2 * kNanosecond_s / span_s);
      const double offset_s =
          static_cast<double>(all.front().stamp_ns) * kNanosecond_s - (1 + kDrift) * all.front().captured_s;
      CHECK(std::abs(offset_s - kOffset_s) <= 2 * kNanosecond_s);
      // Of n uniform delays the least and the largest are this close to the ends, but for one case in a million.
      const double gap_s = kJitter_s * (1 - std::pow(1e-6, 1 / n));
      double least_s = std::numeric_limits<double>::infinity(), largest_s = 0, sum_s = 0;
      for (const Delivery& each : all) {
        const double delay_s = each.arrived_s - each.captured_s;
        least_s = std::min(least_s, delay_s);
        largest_s = std::max(largest_s, delay_s);
        sum_s += delay_s;
        CHECK(each.arrived_s <= static_cast<double>(each.frame_ns) * kNanosecond_s + kNanosecond_s);
        CHECK(each.arrived_s >
              static_cast<double>(each.frame_ns) * kNanosecond_s - 2 / kRate_hz);  // next frame, or the one after
      }
      CHECK(least_s >= kDelay_s - kNanosecond_s);
      CHECK(least_s <= kDelay_s + gap_s);
      CHECK(largest_s <= kDelay_s + kJitter_s + kNanosecond_s);
      CHECK(largest_s >= kDelay_s + kJitter_s - gap_s);
      CHECK(std::abs(sum_s / n - kDelay_s - kJitter_s / 2) <= kOneInAMillion * kJitter_s / std::sqrt(12 * n));
      // Samples that are missing between the first and the last one.
      const double sent = std::round(span_s * kRate_hz) + 1;
      CHECK(std::abs(1 - n / sent - kDrop) <= kOneInAMillion * std::sqrt(kDrop * (1 - kDrop) / sent));
    }
  }
}

TEST_CASE("a frozen measurement repeats the numbers before it, with its own stamp") {
  constexpr int kFrames = 3000;
  constexpr double kFreeze = 0.3;
  Simulation simulation = delayed_imu("rate='100' freeze='0.3' accelerometer_stddev='1'", timed(false, 3, 100));
  double repeated = 0, before_m_s2 = 0, captured_s = -1;
  for (int frame = 0; frame < kFrames; ++frame) {
    simulation.step();
    const Measurement measurement = simulation.measurement(kSensor);
    CHECK(measurement.time_ns == simulation.last_frame()->time_ns);
    const double force_m_s2 = *measurement.value("specific_force_x_m_s2");
    const bool is_old = *measurement.value("capture_time_s") == captured_s;
    CHECK((force_m_s2 == before_m_s2) == is_old);
    CHECK(simulation.reading(kSensor).find("specific_force_x_m_s2") == force_m_s2);
    repeated += is_old ? 1 : 0;
    before_m_s2 = force_m_s2;
    captured_s = *measurement.value("capture_time_s");
  }
  CHECK(std::abs(repeated / kFrames - kFreeze) <= kOneInAMillion * std::sqrt(kFreeze * (1 - kFreeze) / kFrames));
}

TEST_CASE("sensors of all types have the same faults, at fixed and at free rates, whatever else measures") {
  constexpr int kFrames = 25;
  const std::string faults =
      " rate='50' delay='0.05' delay_jitter='0.03' drop='0.2' freeze='0.5' clock_offset='0.5' clock_drift='2e-3'";
  for (const std::uint64_t seed : {0u, 7u}) {
    Simulation plain = delayed_imu(faults, timed(false, seed, 50));
    const std::vector<Delivery> expected = deliveries(plain, kFrames);
    REQUIRE(expected.size() > 10);
    CHECK(std::ranges::is_sorted(expected, {}, &Delivery::arrived_s));
    CHECK(std::ranges::adjacent_find(expected, [](const Delivery& a, const Delivery& b) {
            return a.captured_s == b.captured_s;
          }) != expected.end());
    std::size_t types = 0;
    for (const SensorType* type : sensor_types()) {
      for (const bool when_due : {false, true}) {
        CAPTURE(type->name);
        CAPTURE(when_due);
        CAPTURE(seed);
        Simulation simulation =
            scene_of(type->name, small_images(type->name) + faults, {.desc = timed(when_due, seed, 50)});
        CHECK(deliveries(simulation, kFrames) == expected);
        CHECK(simulation.sensors().at(0).frames == expected.size());
        ++types;
      }
    }
    CHECK(types >= 40);
    // Another sensor makes more frames, in which measurements may come earlier; what they are stays.
    Simulation beside =
        delayed_imu(faults, timed(true, seed, 50), "<sensor type='imu' name='B' insert_at='ROOT' rate='70'/>");
    std::vector<Delivery> found = deliveries(beside, 3 * kFrames);
    REQUIRE(found.size() >= expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(found[i].stamp_ns == expected[i].stamp_ns);
      CHECK(found[i].captured_s == expected[i].captured_s);
      CHECK(found[i].arrived_s == expected[i].arrived_s);
      CHECK(found[i].frame_ns <= expected[i].frame_ns);
    }
  }
}

TEST_CASE("a measurement that is under way at the end of a run does not arrive") {
  Simulation simulation = delayed_imu("delay='0.25'", timed(false, 0, 10));
  CHECK(std::isnan(*simulation.measurement(kSensor).value("capture_time_s")));
  const std::vector<Delivery> all = deliveries(simulation, 10);
  REQUIRE(all.size() == 7);  // those of 0 to 0.6 s
  CHECK(all.front().frame_ns == 300'000'000);
  CHECK(all.front().stamp_ns == 0);
  CHECK(all.back().captured_s == 0.6);
  CHECK(all.back().arrived_s == 0.85);
  const std::vector<Delivery> later = deliveries(simulation, 1);  // the run goes on after all
  REQUIRE(later.size() == 1);
  CHECK(later.front().captured_s == 0.7);
  // A run from time 0 again has the same faults.
  Simulation again = delayed_imu("delay='0.25'", timed(false, 0, 10));
  CHECK(deliveries(again, 10) == all);
}

TEST_CASE("what is under way is lost when the sensor is switched off") {
  Simulation simulation = delayed_imu("delay='0.25'", timed(false, 0, 10));
  deliveries(simulation, 4);
  simulation.enable(kSensor, false);
  CHECK(deliveries(simulation, 2).empty());
  simulation.enable(kSensor, true);
  const std::vector<Delivery> all = deliveries(simulation, 4);
  REQUIRE(all.size() == 1);
  CHECK(all.front().captured_s == 0.6);
}

TEST_CASE("the times of beams are by the clock of the stamps") {
  constexpr double kTimes_s = 2 * kNanosecond_s;
  const auto scanner = [](const std::string& attributes) {
    return Simulation::from_string(
        "<sensor type='laser_scanner' name='S' insert_at='ROOT' samples='11' sweep='0.05' " + attributes + "/>",
        timed(false, 0, 10));
  };
  Simulation drifting = scanner("clock_offset='2' clock_drift='0.01'"),
             stamped = scanner("delay='0.05' stamp='arrival'");
  for (int frame = 0; frame < 4; ++frame) {
    drifting.step();
    stamped.step();
  }
  const double now_s = 0.3;
  const SharedNumbers<double> times_s = drifting.scan("S").channel("time_s");
  REQUIRE(times_s.size() == 11);
  for (std::size_t i = 0; i < 11; ++i) {
    const double left_s = now_s - 0.005 * static_cast<double>(10 - i);
    CHECK(std::abs(times_s[i] - (2 + 1.01 * left_s)) <= kTimes_s);
  }
  CHECK(drifting.scan("S").time_ns == 2'303'000'000);
  // The scan of 0.2 s arrived at 0.25 s.
  const SharedNumbers<double> late_s = stamped.scan("S").channel("time_s");
  REQUIRE(late_s.size() == 11);
  CHECK(stamped.scan("S").time_ns == 250'000'000);
  CHECK(std::abs(late_s.front() - 0.2) <= kTimes_s);
  CHECK(std::abs(late_s.back() - 0.25) <= kTimes_s);
  const Measurement late = stamped.measurement("S");
  const MeasuredArray* const array = late.find("time_s");
  REQUIRE(array != nullptr);
  CHECK(array->number(10) == late_s.back());
}

TEST_CASE("the times of events are by the clock of the stamps, in readings and arrays") {
  const std::string camera = "width='16' height='10' leak='200' rate='15'";
  Simulation plain = scene_of("event_camera", camera), ahead = scene_of("event_camera", camera + " clock_offset='2'");
  drive(plain);
  drive(ahead);
  const Reading &expected = plain.reading(kSensor), &found = ahead.reading(kSensor);
  const Measurement late = ahead.measurement(kSensor);
  const MeasuredArray* const array = late.find("time_s");
  REQUIRE(array != nullptr);
  REQUIRE(expected.rows() > 0);
  REQUIRE(found.rows() == expected.rows());
  REQUIRE(array->count() == expected.rows());
  for (std::size_t row = 0; row < expected.rows(); ++row) {
    CHECK(std::abs(*found.find("time_s", row) - *expected.find("time_s", row) - 2) <= kNanosecond_s);
    CHECK(array->number(row) == *found.find("time_s", row));
    CHECK(*found.find("t_us", row) == std::floor(*found.find("time_s", row) * 1e6));
    CHECK(found.find("x", row) == expected.find("x", row));
  }
}

TEST_CASE("faults that are off cost nothing") {
  Simulation none = delayed_imu("accelerometer_stddev='1'", {}),
             off = delayed_imu("accelerometer_stddev='1' delay='0' drop='0'", {});
  for (const Simulation* each : {&none, &off}) {
    CHECK(built_scene(*each).sensors.at(0).delayed == nullptr);
    CHECK(built_scene(*each).sensors.at(0).outputs.size() == 6);
  }
  none.step();
  off.step();
  CHECK(none.reading("S").values() == off.reading("S").values());
  CHECK_FALSE(none.measurement("S").value("capture_time_s"));
  CHECK_NOTHROW(off.require_skippable());
}

TEST_CASE("wrong timing faults are errors at their place") {
  const auto refused = [](const std::string& attributes) { return error_of([&] { delayed_imu(attributes, {}); }); };
  CHECK(contains(refused("drop='1.5'"), "attribute \"drop\""));
  CHECK(contains(refused("delay='-1'"), "attribute \"delay\""));
  CHECK(contains(refused("stamp='late'"), "capture"));
  CHECK(contains(refused("stamp='arrival' clock_drift='1e-6'"), "attribute \"clock_drift\" has no effect"));
  // What arrives in a frame depends on earlier ones.
  Simulation delayed = delayed_imu("delay='0.1'", {});
  CHECK(contains(error_of([&] { delayed.require_skippable(); }), "\"S\""));
}

}  // namespace simvis::test

TEST_SUITE_END();
