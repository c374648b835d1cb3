// The sensor behind the optics of an event camera against closed forms and the distributions that it promises.
#include "sensors/event_camera/event_pixels.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr std::int64_t kSecond_ns = 1000000000;
// Times are doubles of nanoseconds within some seconds: 2^-53 of 1e10, a hundred times.
constexpr double kRounded_ns = 1e-4;

std::vector<PixelEvent> follow(EventPixels& pixels, std::uint32_t pixel, const std::vector<LightKnot>& knots,
                               std::int64_t begin_ns = 0, std::int64_t end_ns = kSecond_ns, std::uint64_t frame = 1) {
  std::vector<PixelEvent> events;
  pixels.follow(pixel, frame, {begin_ns, end_ns, knots}, events);
  return events;
}

/// Chi-square of counts against one expectation for all. Its mean is the number of counts and its standard deviation
/// sqrt(2 n); a right model exceeds five of these once in a million runs, and this run is always the same.
void check_chi_square(const std::vector<double>& counts, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    REQUIRE(expected[i] > 5);
    sum += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
  }
  const double n = static_cast<double>(counts.size());
  CHECK(std::abs(sum - n) < 5 * std::sqrt(2 * n));
}

TEST_CASE("linear light crosses levels when the formula says, up and down") {
  EventPixels pixels({.on = 0.3, .off = 0.2, .darkness = 0.01}, 1, 0, "E");
  pixels.begin(0, 1);
  const std::vector<PixelEvent> up = follow(pixels, 0, {{0, 1}, {0.5, 1}, {1, 3}});
  REQUIRE(up.size() == 3);  // ln(3.01 / 1.01) = 1.09
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(up[i].on);
    const double light = 1.01 * std::exp(0.3 * (static_cast<double>(i) + 1)) - 0.01;
    CHECK(std::abs(up[i].time_ns - 1e9 * (0.5 + 0.5 * (light - 1) / 2)) < kRounded_ns);
  }
  // The reference stands at ln 1.01 + 0.9; the light falls back to 1 in the next second.
  const std::vector<PixelEvent> down = follow(pixels, 0, {{0, 3}, {1, 1}}, kSecond_ns, 2 * kSecond_ns);
  REQUIRE(down.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK_FALSE(down[i].on);
    const double light = 1.01 * std::exp(0.9 - 0.2 * (static_cast<double>(i) + 1)) - 0.01;
    CHECK(std::abs(down[i].time_ns - 1e9 * (1 + (3 - light) / 2)) < kRounded_ns);
  }
}

TEST_CASE("a refractory time delays events and keeps the reference") {
  EventPixels pixels({.refractory_s = 0.25}, 1, 0, "E");
  pixels.begin(0, 1);
  // A step by a factor of e^0.95: four crossings at once, of which each waits for the one before.
  const double high = 1.001 * std::exp(0.95) - 0.001;
  const std::vector<PixelEvent> events = follow(pixels, 0, {{0, 1}, {0, high}, {1, high}});
  REQUIRE(events.size() == 4);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(std::abs(events[i].time_ns - 0.25e9 * static_cast<double>(i)) < kRounded_ns);
  // The last one was sent at 0.75 s, so that a fall in the next second is free at once.
  CHECK(follow(pixels, 0, {{0, high}, {0, 1}, {1, 1}}, kSecond_ns, 2 * kSecond_ns).at(0).time_ns == 1e9);
}

TEST_CASE("leakage gives events at its rate, evenly shifted over the pixels") {
  constexpr std::uint32_t kPixels = 2000;
  EventPixels pixels({.leak_hz = 2.5}, kPixels, 7, "E");
  std::vector<double> shares(10);
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    pixels.begin(pixel, 1);
    const std::vector<PixelEvent> events = follow(pixels, pixel, {{0, 1}, {1, 1}});
    REQUIRE((events.size() == 2 || events.size() == 3));
    for (std::size_t i = 1; i < events.size(); ++i) {
      REQUIRE(std::abs(events[i].time_ns - events[i - 1].time_ns - 0.4e9) < 1);
    }
    REQUIRE(events[0].on);
    shares[std::min<std::size_t>(static_cast<std::size_t>(events[0].time_ns / 0.4e9 * 10), 9)] += 1;
  }
  check_chi_square(shares, std::vector<double>(10, kPixels / 10.0));
}

TEST_CASE("leakage in falling light delays the fall by what has leaked") {
  EventPixels pixels({.on = 0.2, .off = 0.2, .darkness = 1e-9, .leak_hz = 1}, 1, 0, "E");
  pixels.begin(0, 1);
  // ln(1 - 0.9 t) + 0.2 t + b rises nowhere; the phase b of the pixel follows from its first event.
  const std::vector<PixelEvent> events = follow(pixels, 0, {{0, 1}, {1, 0.1}});
  REQUIRE(events.size() > 5);
  const auto output = [](double time_ns) { return std::log(1 - 0.9 * time_ns / 1e9 + 1e-9) + 0.2 * time_ns / 1e9; };
  for (std::size_t i = 1; i < events.size(); ++i) {
    CHECK_FALSE(events[i].on);
    CHECK(output(events[i - 1].time_ns) - output(events[i].time_ns) == doctest::Approx(0.2).epsilon(1e-9));
  }
}

TEST_CASE("the photoreceptor answers a step of light with one pole, faster in more light") {
  for (const double high : {2.0, 4.0}) {
    EventPixels pixels({.on = 0.1, .off = 0.1, .darkness = 1e-9, .white = 1, .cutoff_hz = 10}, 1, 0, "E");
    pixels.begin(0, 1);
    const std::vector<PixelEvent> events = follow(pixels, 0, {{0, 1}, {0, high}, {1, high}});
    const double step = std::log(high), tau_s = 1 / (2 * std::numbers::pi * 10 * high);
    REQUIRE(events.size() == static_cast<std::size_t>(step / 0.1));
    for (std::size_t i = 0; i < events.size(); ++i) {
      const double expected_s = -tau_s * std::log(1 - 0.1 * (static_cast<double>(i) + 1) / step);
      CHECK(std::abs(events[i].time_ns / 1e9 - expected_s) < 1e-9);
    }
  }
}

TEST_CASE("shot noise is a Poisson process of the stated rates") {
  constexpr std::uint32_t kPixels = 200;
  for (const double light : {0.0, 0.5, 3.0}) {
    EventPixels pixels({.shot_noise_hz = 40}, kPixels, 11, "E");
    const double rate = 20 * (1 - 0.75 * std::min(light, 1.0));
    std::vector<double> on, off;
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
      pixels.begin(pixel, light);
      double positive = 0, negative = 0;
      for (const PixelEvent& event : follow(pixels, pixel, {{0, light}, {1, light}}, 0, 2 * kSecond_ns)) {
        REQUIRE((event.time_ns >= 0 && event.time_ns < 2e9));
        (event.on ? positive : negative) += 1;
      }
      on.push_back(positive);
      off.push_back(negative);
    }
    check_chi_square(on, std::vector<double>(kPixels, 2 * rate));
    check_chi_square(off, std::vector<double>(kPixels, 2 * rate));
  }
}

TEST_CASE("thresholds are a normal pattern that stays, and delays are normal") {
  constexpr std::uint32_t kPixels = 4000;
  const EventModelDesc desc{.threshold_noise = 0.03, .latency_s = 1e-3, .latency_noise_s = 1e-4};
  EventPixels pixels(desc, kPixels, 3, "E");
  const EventPixels again(desc, kPixels, 3, "E"), other(desc, kPixels, 4, "E");
  std::vector<double> on(8), delay(8);
  // Eight classes of equal probability of the normal distribution.
  constexpr double kLimits[] = {-1.1503493803760079, -0.67448975019608171, -0.31863936396437514, 0,
                                0.31863936396437514, 0.67448975019608171,  1.1503493803760079};
  const auto class_of = [&](double normal) {
    return static_cast<std::size_t>(std::ranges::upper_bound(kLimits, normal) - std::begin(kLimits));
  };
  std::size_t same = 0;
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    REQUIRE(pixels.on(pixel) == again.on(pixel));
    same += pixels.on(pixel) == other.on(pixel);
    on[class_of((pixels.on(pixel) - 0.2) / 0.03)] += 1;
    pixels.begin(pixel, 1);
    const double light = 1.001 * std::exp(pixels.on(pixel) * 1.5) - 0.001;
    const std::vector<PixelEvent> events = follow(pixels, pixel, {{0, 1}, {0, light}, {1, light}});
    REQUIRE(events.size() == 1);
    delay[class_of((events[0].time_ns / 1e9 - 1e-3) / 1e-4)] += 1;
  }
  CHECK(same == 0);
  check_chi_square(on, std::vector<double>(8, kPixels / 8.0));
  check_chi_square(delay, std::vector<double>(8, kPixels / 8.0));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
