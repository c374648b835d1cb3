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

/// Events of pixels in constant light, frame by frame: of each the time since the event before, and the polarity.
struct Waits {
  std::vector<double> seconds;
  std::vector<bool> on;
};
Waits waits_of(const EventModelDesc& desc, double light, std::uint32_t count, std::int64_t frame_ns) {
  Waits waits;
  EventPixels pixels(desc, count, 5, "E");
  for (std::uint32_t pixel = 0; pixel < count; ++pixel) {
    pixels.begin(pixel, light);
    // Only the first event counts, so that no wait is cut off by the end.
    for (std::uint64_t frame = 1; waits.on.size() == pixel; ++frame) {
      REQUIRE(frame < 100000);
      const std::int64_t end_ns = static_cast<std::int64_t>(frame) * frame_ns;
      const auto events = follow(pixels, pixel, {{0, light}, {1, light}}, end_ns - frame_ns, end_ns, frame);
      if (events.empty()) continue;
      waits.seconds.push_back(events[0].time_ns / 1e9);
      waits.on.push_back(events[0].on);
    }
  }
  return waits;
}

TEST_CASE("Brownian motion without drift comes to its thresholds when the formula says, in frames of any length") {
  constexpr std::uint32_t kPixels = 4000;
  constexpr double kOn = 0.2, kDeviation = 0.5;
  for (const std::int64_t frame_ns : {kSecond_ns, kSecond_ns / 100}) {
    const Waits waits =
        waits_of({.on = kOn, .off = kOn, .darkness = 1e-9, .brownian = kDeviation}, 1, kPixels, frame_ns);
    // The probability of no crossing until t (Borodin, Salminen, "Handbook of Brownian Motion", 1.3.0.2).
    const auto later = [&](double time_s) {
      double sum = 0;
      for (int k = 0; k < 200; ++k) {
        const double n = 2 * k + 1, pi = std::numbers::pi;
        sum += (k % 2 == 0 ? 4 : -4) / (pi * n) *
               std::exp(-n * n * pi * pi * kDeviation * kDeviation * time_s / (8 * kOn * kOn));
      }
      return sum;
    };
    const std::vector<double> limits = {0.04, 0.06, 0.08, 0.1, 0.13, 0.16, 0.2, 0.25, 0.3, 0.4};
    std::vector<double> counts(limits.size() + 1), expected;
    for (const double wait : waits.seconds) {
      counts[static_cast<std::size_t>(std::ranges::upper_bound(limits, wait) - limits.begin())] += 1;
    }
    for (std::size_t i = 0; i <= limits.size(); ++i) {
      expected.push_back(kPixels * ((i == 0 ? 1 : later(limits[i - 1])) - (i == limits.size() ? 0 : later(limits[i]))));
    }
    check_chi_square(counts, expected);
    const auto positive = static_cast<double>(std::ranges::count(waits.on, true));
    check_chi_square({positive, kPixels - positive}, {kPixels / 2.0, kPixels / 2.0});
  }
}

TEST_CASE("Brownian motion with drift has the polarities and the mean time of the formula") {
  constexpr std::uint32_t kPixels = 4000;
  constexpr double kOn = 0.3, kOff = 0.2, kDeviation = 0.4;
  // Of the leak, which drifts by 0.75 * 0.3 in a second. In a light of 0.25 the deviation is 0.5 / 0.25 of `brownian`.
  const EventModelDesc desc{
      .on = kOn, .off = kOff, .darkness = 1e-9, .brownian = 0.15, .brownian_dark = 0.1, .leak_light_hz = 3};
  const Waits waits = waits_of(desc, 0.25, kPixels, kSecond_ns / 10);
  const double drift = 0.75 * kOn, strength = 2 * drift / (kDeviation * kDeviation);
  const double on = std::expm1(strength * kOff) / (std::exp(strength * kOff) - std::exp(-strength * kOn));
  const auto positive = static_cast<double>(std::ranges::count(waits.on, true));
  check_chi_square({positive, kPixels - positive}, {kPixels * on, kPixels * (1 - on)});
  // By Wald, the mean value at the end is the drift in the mean time; a time's deviation is below its mean.
  double sum_s = 0;
  for (const double wait : waits.seconds) sum_s += wait;
  const double mean_s = (on * kOn - (1 - on) * kOff) / drift;
  CHECK(std::abs(sum_s / kPixels - mean_s) < 5 * mean_s / std::sqrt(double{kPixels}));
}

TEST_CASE("without noise a Brownian motion is its drift, and a refractory time delays it") {
  const auto times_of = [](double refractory_s, double cutoff_hz) {
    EventPixels pixels({.darkness = 0.1, .refractory_s = refractory_s, .cutoff_hz = cutoff_hz, .leak_light_hz = 4}, 1,
                       0, "E");
    pixels.begin(0, 0.5);
    return follow(pixels, 0, {{0, 0.5}, {1, 0.5}}, 0, kSecond_ns * 19 / 10);
  };
  const auto free = times_of(0, 0), slow = times_of(0, 20), blocked = times_of(0.6, 0);
  REQUIRE(free.size() == 3);  // 2 Hz: at 0.5, 1 and 1.5 s
  REQUIRE(slow.size() == free.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    const double expected_ns = 0.5e9 * (static_cast<double>(i) + 1);
    CHECK(std::abs(free[i].time_ns - expected_ns) < 1);
    CHECK(std::abs(slow[i].time_ns - expected_ns) < 1);
    if (i < blocked.size()) CHECK(std::abs(blocked[i].time_ns - (0.5e9 + 0.6e9 * static_cast<double>(i))) < 1);
  }
  REQUIRE(blocked.size() == 3);
}

TEST_CASE("Brownian motion in changing light crosses as without it, if it is small") {
  const std::vector<LightKnot> knots = {{0, 1}, {1, 3}};
  EventPixels exact({.darkness = 0.01}, 1, 0, "E"), noisy({.darkness = 0.01, .brownian_dark = 1e-9}, 1, 0, "E");
  exact.begin(0, 1);
  noisy.begin(0, 1);
  const auto expected = follow(exact, 0, knots), seen = follow(noisy, 0, knots);
  REQUIRE(expected.size() == 5);
  REQUIRE(seen.size() == expected.size());
  // A chord of the logarithm within a ratio r of light is off by (ln r)^2 / 8, of a slope of at least ln(3) / 2 a
  // second.
  const double allowed_ns = 1e9 * std::pow(std::log(kLightRatio), 2) / 8 / (std::log(3.0) / 2);
  for (std::size_t i = 0; i < seen.size(); ++i) CHECK(std::abs(seen[i].time_ns - expected[i].time_ns) < allowed_ns);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
