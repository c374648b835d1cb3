#include "sensors/event_camera/event_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "sensors/event_camera/brownian_bridge.h"

namespace simvis {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// What states may hold.
constexpr double kMaxLogarithm = 100;  // of a luminance
constexpr double kSumRounding = 1e-6;  // of some 1e6 events and leaks below 1e3, each by 2^-53 of the sum so far
constexpr double kMaxWhites = 1e6;     // light, in units of white, in the mean over a run
constexpr double kMaxDeviations = 40;  // of a Brownian motion

double light_at(std::span<const LightKnot> knots, double time) {
  const auto after = std::ranges::upper_bound(knots, time, {}, &LightKnot::time);
  if (after == knots.begin()) return knots.front().light;
  if (after == knots.end()) return knots.back().light;
  const LightKnot &a = *(after - 1), &b = *after;
  return a.light + (time - a.time) / (b.time - a.time) * (b.light - a.light);
}

/// Where a monotonic function that is below 0 at `low` and not at `high` becomes 0: to the last bit of the time.
template <typename Function>
double find_root(double low, double high, const Function& function) {
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return high;
    (function(middle) < 0 ? low : high) = middle;
  }
}

}  // namespace

AttributeRows<EventModelDesc> EventModelDesc::rows() {
  using Desc = EventModelDesc;
  constexpr AttributeLimits kThreshold{.min = 0.01, .max = 10}, kDeviation{.min = 0, .max = 10},
      kLuminance{.min = 1e-9, .max = 1e9}, kTime{.min = 0, .max = 3600}, kEventRate{.min = 0, .max = 1e5};
  return {
      row(&Desc::on, "threshold_on", "", kThreshold,
          "rise of the natural logarithm of the light that gives an event of polarity 1"),
      row(&Desc::off, "threshold_off", "", kThreshold,
          "fall of the natural logarithm of the light that gives an event of polarity 0"),
      row(&Desc::threshold_noise, "threshold_noise", "", kDeviation,
          "standard deviation of both thresholds over the pixels; each pixel keeps its own"),
      row(&Desc::darkness, "darkness", "", kLuminance,
          "luminance that is added to all light before its logarithm is taken"),
      row(&Desc::white, "white", "", kLuminance, "luminance of white for cutoff and shot_noise"),
      row(&Desc::refractory_s, "refractory", "s", kTime,
          "after an event a pixel sends none for this time, and keeps its reference"),
      row(&Desc::leak_hz, "leak", "Hz", kEventRate, "events of polarity 1 by leakage, of each pixel in constant light"),
      row(&Desc::leak_light_hz, "leak_light", "Hz", kEventRate, "more leak in white light, in proportion to the light"),
      row(&Desc::brownian, "brownian", "", kDeviation,
          "Brownian motion of the logarithm by the noise of light: standard deviation in a second, in white light "
          "without darkness"),
      row(&Desc::brownian_dark, "brownian_dark", "", kDeviation,
          "Brownian motion of the logarithm in any light: standard deviation in a second"),
      row(&Desc::cutoff_hz, "cutoff", "Hz", AttributeLimits{.min = 0, .max = 1e6},
          "cutoff of the photoreceptor's low-pass in white light, proportional to the light; 0: none"),
      row(&Desc::shot_noise_hz, "shot_noise", "Hz", kEventRate,
          "events by shot noise, of both polarities together, of each pixel in the dark; a quarter in white light"),
      row(&Desc::latency_s, "latency", "s", kTime, "mean delay of an event"),
      row(&Desc::latency_noise_s, "latency_noise", "s", kTime, "standard deviation of the delay of an event")};
}

EventPixels::EventPixels(const EventModelDesc& desc, std::size_t pixels, std::uint64_t seed, const std::string& sensor)
    : desc_(desc),
      pattern_(seed, sensor + "/thresholds"),
      shots_(seed, sensor + "/shot_noise"),
      delays_(seed, sensor + "/latency"),
      motions_(seed, sensor + "/brownian"),
      states_(pixels) {
  thresholds_.reserve(pixels);
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
    const auto own = [&](double nominal, std::uint32_t draw) {
      if (desc.threshold_noise == 0) return nominal;
      return std::max(kMinThreshold, nominal + desc.threshold_noise * pattern_.gaussian(0, pixel, draw));
    };
    thresholds_.push_back({own(desc.on, 0), own(desc.off, 1)});
  }
}

void EventPixels::begin(std::uint32_t pixel, double light) {
  const double output = std::log(light + desc_.darkness);
  const double below = desc_.leak_hz > 0 ? thresholds_[pixel].on * pattern_.uniform(0, pixel, 2) : 0;
  states_[pixel] = {.reference = output - below, .output = output, .blocked_s = 0};
}

// Without a refractory time the reference is within the thresholds of a pixel: each distance beyond them is an event,
// of which a stranger's numbers must not make more than light does.
void EventPixels::archive(StateArchive& state, std::int64_t time_ns) {
  for (std::uint32_t pixel = 0; pixel < states_.size(); ++pixel) {
    auto& [reference, output, blocked_s] = states_[pixel];
    state.finite(reference, output, blocked_s);
    state.require(std::abs(output) <= kMaxLogarithm);
    state.require(blocked_s >= 0 && blocked_s <= desc_.refractory_s + kSumRounding);
    if (state.is_reading()) state.require(std::abs(output - reference) <= most_missed(pixel, time_ns));
  }
}

// The largest distance of the output from the reference. A blocked pixel misses changes of light, leaks since the first
// measurement and Brownian motion, whose deviation is largest where the light is the darkness.
double EventPixels::most_missed(std::uint32_t pixel, std::int64_t time_ns) const {
  const Thresholds& own = thresholds_[pixel];
  const double threshold = std::max(own.on, own.off) + kSumRounding;
  if (desc_.refractory_s == 0) return threshold;
  const double time_s = static_cast<double>(time_ns) / 1e9;
  const double leak = (desc_.leak_hz + desc_.leak_light_hz * kMaxWhites) * own.on;
  const double deviation = desc_.brownian * std::sqrt(desc_.white / desc_.darkness) / 2 + desc_.brownian_dark;
  return threshold + 2 * kMaxLogarithm + leak * time_s + kMaxDeviations * deviation * std::sqrt(time_s);
}

bool EventPixels::acts_in_constant_light() const {
  return desc_.refractory_s > 0 || desc_.leak_hz > 0 || desc_.cutoff_hz > 0 || desc_.shot_noise_hz > 0 || is_brownian();
}

double EventPixels::Piece::at(double time_s) const {
  return tau_s == 0 ? std::log(start + slope * time_s) : start + slope * time_s + decay * std::exp(-time_s / tau_s);
}

// Returns the time of the extremum of the output minus a reference that falls at the rate `leak`.
double EventPixels::Piece::extremum_s(double leak) const {
  if (tau_s == 0) return slope < 0 && leak > 0 ? -1 / leak - start / slope : kNever;
  const double share = (slope + leak) * tau_s / decay;
  return share > 0 ? -tau_s * std::log(share) : kNever;
}

void EventPixels::send(Walk& walk, double time_s, bool on) {
  State& state = states_[walk.pixel];
  state.reference += on ? thresholds_[walk.pixel].on : -thresholds_[walk.pixel].off;
  walk.sent.emplace_back(time_s, on);
}

void EventPixels::follow_piece(Walk& walk, double begin_s, const Piece& piece) {
  State& state = states_[walk.pixel];
  const double on = thresholds_[walk.pixel].on, off = thresholds_[walk.pixel].off;
  const double leak = desc_.leak_hz * on, turn_s = piece.extremum_s(leak);
  const auto beyond = [&](double time_s) { return piece.at(time_s) - state.reference + leak * time_s; };
  double now_s = std::min(state.blocked_s, piece.length_s);
  while (state.blocked_s <= piece.length_s) {
    // The next crossing from now_s on: between now_s, the extremum and the end the difference is monotonic.
    std::optional<std::pair<double, bool>> found;
    const double first = beyond(now_s);
    if (first >= on || first <= -off) found = {now_s, first >= on};
    double from_s = now_s;
    for (const double to_s : {turn_s, piece.length_s}) {
      if (found || !(to_s > from_s) || to_s > piece.length_s) continue;
      const double last = beyond(to_s);
      if (last >= on || last <= -off) {
        const bool is_on = last >= on;
        const double level = state.reference + (is_on ? on : -off);
        if (piece.tau_s == 0 && leak == 0) {
          found = {std::clamp((std::exp(level) - piece.start) / piece.slope, from_s, to_s), is_on};
        } else {
          found = {find_root(from_s, to_s,
                             [&](double time_s) { return is_on ? beyond(time_s) - on : -off - beyond(time_s); }),
                   is_on};
        }
      }
      from_s = to_s;
    }
    if (!found) break;
    send(walk, begin_s + found->first, found->second);
    now_s = found->first;
    if (desc_.refractory_s > 0) {
      state.blocked_s = now_s + desc_.refractory_s;
      now_s = std::min(state.blocked_s, piece.length_s);
    }
  }
  state.blocked_s = std::max(state.blocked_s - piece.length_s, 0.0);
  state.reference -= leak * piece.length_s;
  state.output = piece.at(piece.length_s);
}

/// A piece in about constant light.
void EventPixels::follow_brownian(Walk& walk, double begin_s, const Piece& piece, double light) {
  State& state = states_[walk.pixel];
  const double share = light / desc_.white;
  const double deviation =
      desc_.brownian * std::sqrt(share) * desc_.white / (light + desc_.darkness) + desc_.brownian_dark;  // in a second
  const double leak = (desc_.leak_hz + desc_.leak_light_hz * share) * thresholds_[walk.pixel].on;
  const double longest_s =
      std::pow(kMotionStep * std::min(thresholds_[walk.pixel].on, thresholds_[walk.pixel].off) / deviation, 2);
  const double steps = std::max(1.0, std::ceil(piece.length_s / longest_s));
  for (double step = 0; step < steps; ++step) {
    const double at_s = step / steps * piece.length_s, next_s = (step + 1) / steps * piece.length_s,
                 length_s = next_s - at_s;
    const double moved = deviation * std::sqrt(length_s) * motions_.gaussian(walk.frame, walk.pixel, walk.draw++);
    const double from = piece.at(at_s) - state.reference, to = piece.at(next_s) - state.reference;
    const double end = follow_bridge(walk, begin_s + at_s, length_s, from, to + leak * length_s + moved, deviation);
    state.reference = piece.at(next_s) - end;
  }
  state.output = piece.at(piece.length_s);
}

/// Follows the difference to the reference. Returns that at the end, less the thresholds of the events.
double EventPixels::follow_bridge(Walk& walk, double begin_s, double length_s, double from, double to,
                                  double deviation) {
  State& state = states_[walk.pixel];
  const double on = thresholds_[walk.pixel].on, off = thresholds_[walk.pixel].off;
  double now_s = 0;
  while (state.blocked_s <= length_s) {
    if (state.blocked_s > now_s) {  // where it is when the pixel may send again
      const double left_s = length_s - now_s, share = (state.blocked_s - now_s) / left_s;
      from += share * (to - from) + deviation * std::sqrt(share * (1 - share) * left_s) *
                                        motions_.gaussian(walk.frame, walk.pixel, walk.draw++);
      now_s = state.blocked_s;
    }
    bool is_on = from >= on;
    if (from < on && from > -off) {
      const double variance = deviation * deviation * (length_s - now_s);
      const BrownianBridge up{on - from, on - to, variance}, down{off + from, off + to, variance};
      const double chosen = motions_.uniform(walk.frame, walk.pixel, walk.draw++);
      is_on = chosen < chance_of(up);
      if (!is_on && chosen < 1 - chance_of(down)) break;
      const double normal = motions_.gaussian(walk.frame, walk.pixel, walk.draw++);
      now_s += (length_s - now_s) *
               first_time(is_on ? up : down, normal, motions_.uniform(walk.frame, walk.pixel, walk.draw++));
      from = is_on ? on : -off;
    }
    send(walk, begin_s + now_s, is_on);
    from -= is_on ? on : -off;
    to -= is_on ? on : -off;
    if (desc_.refractory_s > 0) state.blocked_s = now_s + desc_.refractory_s;
  }
  state.blocked_s = std::max(state.blocked_s - length_s, 0.0);
  return to;
}

// Light on a straight line, darkness included.
void EventPixels::follow_line(Walk& walk, double begin_s, double length_s, double from, double to) {
  if (desc_.cutoff_hz == 0 && (!is_brownian() || length_s == 0)) {
    return follow_piece(walk, begin_s,
                        {.length_s = length_s, .start = from, .slope = length_s > 0 ? (to - from) / length_s : 0});
  }
  if (length_s == 0) return;
  const auto pieces = static_cast<std::size_t>(std::ceil(std::abs(std::log(to / from)) / std::log(kLightRatio))) + 1;
  const double piece_s = length_s / static_cast<double>(pieces);
  for (std::size_t i = 0; i < pieces; ++i) {
    const auto light = [&](double step) { return from + step / static_cast<double>(pieces) * (to - from); };
    const double a = light(static_cast<double>(i)), b = light(static_cast<double>(i) + 1);
    const double piece_begin_s = begin_s + static_cast<double>(i) * piece_s, mean = (a + b) / 2 - desc_.darkness;
    if (desc_.cutoff_hz == 0) {
      follow_brownian(walk, piece_begin_s, {.length_s = piece_s, .start = a, .slope = (b - a) / piece_s}, mean);
      continue;
    }
    const double tau_s = desc_.white / (2 * std::numbers::pi * desc_.cutoff_hz * (a + b) / 2);
    const double slope = (std::log(b) - std::log(a)) / piece_s, lag = slope * tau_s;
    const Piece piece{.length_s = piece_s,
                      .start = std::log(a) - lag,
                      .slope = slope,
                      .decay = states_[walk.pixel].output - std::log(a) + lag,
                      .tau_s = tau_s};
    if (is_brownian()) {
      follow_brownian(walk, piece_begin_s, piece, mean);
    } else {
      follow_piece(walk, piece_begin_s, piece);
    }
  }
}

void EventPixels::follow(std::uint32_t pixel, std::uint64_t frame, const LightOverTime& light,
                         std::vector<PixelEvent>& events) {
  Walk walk{.pixel = pixel, .frame = frame};
  const double duration_ns = static_cast<double>(light.end_ns - light.begin_ns), duration_s = duration_ns / 1e9;
  for (std::size_t i = 0; i + 1 < light.knots.size(); ++i) {
    const LightKnot &a = light.knots[i], &b = light.knots[i + 1];
    if (a.time == b.time) {
      if (desc_.cutoff_hz == 0) follow_line(walk, a.time * duration_s, 0, b.light + desc_.darkness, 0);
      continue;
    }
    follow_line(walk, a.time * duration_s, (b.time - a.time) * duration_s, a.light + desc_.darkness,
                b.light + desc_.darkness);
  }
  const std::size_t first = events.size();
  for (const auto& [time_s, is_on] : walk.sent) {
    events.push_back({static_cast<double>(light.begin_ns) + time_s * 1e9, pixel, is_on});
  }
  if (desc_.shot_noise_hz > 0) add_shot_noise(pixel, frame, light, events);
  if (desc_.latency_s == 0 && desc_.latency_noise_s == 0) return;
  for (std::size_t i = first; i < events.size(); ++i) {
    const double noise = delays_.gaussian(frame, pixel, static_cast<std::uint32_t>(i - first));
    events[i].time_ns += std::max(0.0, desc_.latency_s + desc_.latency_noise_s * noise) * 1e9;
  }
}

// Of a process of the rate in darkness each event is kept with the share of that rate that its light leaves.
void EventPixels::add_shot_noise(std::uint32_t pixel, std::uint64_t frame, const LightOverTime& light,
                                 std::vector<PixelEvent>& events) const {
  const double duration_ns = static_cast<double>(light.end_ns - light.begin_ns);
  std::uint32_t draw = 0;
  for (const bool is_on : {true, false}) {
    const double threshold = is_on ? desc_.on / on(pixel) : desc_.off / off(pixel);
    const double rate_per_ns = desc_.shot_noise_hz / 2 * threshold / 1e9;
    for (double time_ns = 0;;) {
      time_ns -= std::log1p(-shots_.uniform(frame, pixel, draw++)) / rate_per_ns;
      const double keep = shots_.uniform(frame, pixel, draw++);
      if (!(time_ns < duration_ns)) break;
      const double bright = std::min(light_at(light.knots, time_ns / duration_ns) / desc_.white, 1.0);
      if (keep < 1 - (1 - kShotInLight) * bright) {
        events.push_back({static_cast<double>(light.begin_ns) + time_ns, pixel, is_on});
      }
    }
  }
}

}  // namespace simvis
