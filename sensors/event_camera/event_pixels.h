// The sensor behind the optics of an event camera: what each pixel makes of its light over time.
//
// Ideal     A pixel compares the logarithm of its light with a reference. When it is `on` above the reference,
//           the pixel sends an event of positive polarity and the reference rises by `on`; when it is `off` below, a
//           negative one, and the reference falls by `off` (Lichtsteiner, Posch, Delbruck, IEEE JSSC 43(2), 2008).
//           Light is a broken line in time, so a crossing has a closed form: the time when the light is exp(level) -
//           darkness.
// Pattern   Each pixel has thresholds of its own, normally distributed about the nominal ones and at least
//           kMinThreshold, the same in all frames (v2e: Hu, Liu, Delbruck, CVPR Workshops 2021).
// Refractory time  After an event the pixel sends none for this time. The reference stays, so that a change of light in
//           the meantime is not lost: the next event comes at the end of that time, if the light is beyond a threshold.
// Leak      The reference falls by `on` `leak_hz` times a second, which gives positive events in constant light
//           (Nozaki, Delbruck, IEEE Trans. Electron Devices 64(8), 2017; v2e). At the first measurement it lies below
//           the light by a share of `on` that is evenly distributed over the pixels.
// Photoreceptor  The logarithm passes a low-pass of one pole, whose time constant is inversely proportional to
//           the light (v2e): 1 / tau = 2 pi cutoff_hz (light + darkness) / white. Within kLightRatio of light the
//           logarithm is taken as linear in time and tau as constant, which has a closed form.
// Shot noise  Events of both polarities, each a Poisson process of the rate
//               shot_noise_hz / 2 (1 - (1 - kShotInLight) min(light / white, 1)) nominal threshold / own threshold
//           (rates of v2e). They leave the reference as it is; those of v2e move it.
// Brownian motion  DVS-Voltmeter (Lin, Ma, Guo, Wen, ECCV 2022): the difference to the reference is a Brownian motion,
//           whose drift is the change of the logarithm and the leak, and whose standard deviation in a second is
//               brownian sqrt(light / white) / ((light + darkness) / white) + brownian_dark,
//           with a leak that is faster by leak_light_hz in white light, in proportion to the light. Within kLightRatio
//           of light, and within times in which the motion has a standard deviation of less than kMotionStep of a
//           threshold, its first crossing of either threshold is exact, see brownian_bridge.h. That model's numbers are
//           in units of a threshold, of 8-bit codes and of microseconds: its K1 to K6 are here the thresholds 1 / K1,
//           the darkness K2 / 255, brownian 1000 K3 / (K1 sqrt 255), leak_hz 10^6 K4, leak_light_hz 255 10^6 K5 and
//           brownian_dark 1000 K6 / K1. (The authors' program uses what it calls a variance as
//           a standard deviation, as is done here.)
// Latency   Events are sent after a normally distributed delay, at least 0 (IEBCS: Joubert et al., Frontiers in
//           Neuroscience 15, 2021). Refractory times begin at the crossing itself.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <simvis/philox.h>
#include <simvis/state_archive.h>
#include "scenegraph/language/attribute_rows.h"
#include "sensors/event_camera/light_curve.h"

namespace simvis {

inline constexpr double kMinThreshold = 0.01, kShotInLight = 0.25, kLightRatio = 1.02, kMotionStep = 0.25;

struct EventModelDesc {
  double on = 0.2, off = 0.2;  ///< of the natural logarithm, above 0
  double threshold_noise = 0;  ///< standard deviation of both over the pixels
  double darkness = 1e-3;      ///< luminance, above 0
  double white = 1;            ///< luminance, above 0
  double refractory_s = 0;     ///< 0: none
  double leak_hz = 0;          ///< 0: none
  double cutoff_hz = 0;        ///< in white light; 0: the photoreceptor follows at once
  double shot_noise_hz = 0;    ///< in darkness; 0: none
  double latency_s = 0, latency_noise_s = 0;
  double brownian = 0, brownian_dark = 0;  ///< of the natural logarithm, in the square root of a second
  double leak_light_hz = 0;                ///< more leak in white light

  static AttributeRows<EventModelDesc> rows();
};

struct PixelEvent {
  double time_ns = 0;  ///< simulated time
  std::uint32_t pixel = 0;
  bool on = false;  ///< brighter

  void archive(StateArchive& state) {
    state.finite(time_ns);
    state(pixel, on);
  }
};

/// Light between two measurements.
struct LightOverTime {
  std::int64_t begin_ns = 0, end_ns = 0;
  std::span<const LightKnot> knots;  ///< ascending in time; one that repeats a time is a step
};

class EventPixels {
 public:
  EventPixels(const EventModelDesc& desc, std::size_t pixels, std::uint64_t seed, const std::string& sensor);

  /// Makes all pixels as they are before their first measurement.
  void reset() { states_.assign(states_.size(), State()); }
  /// The first measurement of a pixel.
  void begin(std::uint32_t pixel, double light);
  /// Whether a pixel may send events while its light is constant.
  bool acts_in_constant_light() const;
  /// Appends the events of a pixel, by time of their crossings. `frame` names random numbers. Several threads may
  /// follow different pixels at a time.
  void follow(std::uint32_t pixel, std::uint64_t frame, const LightOverTime& light, std::vector<PixelEvent>& events);

  /// As that of Stateful. `time_ns` is the time of the last measurement.
  void archive(StateArchive& state, std::int64_t time_ns);

  /// Thresholds of a pixel.
  double on(std::uint32_t pixel) const { return thresholds_[pixel].on; }
  double off(std::uint32_t pixel) const { return thresholds_[pixel].off; }

 private:
  struct Thresholds {
    double on, off;
  };
  struct State {
    double reference = 0, output = 0;  // logarithms of light; output: of the photoreceptor
    double blocked_s = 0;              // what is left of the refractory time
  };
  /// A piece of the output over time: log(start + slope t), or offset + slope t + decay exp(-t / tau) if tau is not 0.
  struct Piece {
    double length_s = 0, start = 0, slope = 0, decay = 0, tau_s = 0;
    double at(double time_s) const;
    double extremum_s(double leak) const;
  };
  /// What is known of a pixel while it is followed.
  struct Walk {
    std::uint32_t pixel = 0;
    std::uint64_t frame = 0;                      // of the random numbers of motions_
    std::uint32_t draw = 0;                       // the next one of them
    std::vector<std::pair<double, bool>> sent{};  // seconds since the beginning, polarity
  };
  void follow_line(Walk& walk, double begin_s, double length_s, double from, double to);
  void follow_piece(Walk& walk, double begin_s, const Piece& piece);
  bool is_brownian() const { return desc_.brownian > 0 || desc_.brownian_dark > 0 || desc_.leak_light_hz > 0; }
  void follow_brownian(Walk& walk, double begin_s, const Piece& piece, double light);
  double follow_bridge(Walk& walk, double begin_s, double length_s, double from, double to, double deviation);
  void send(Walk& walk, double time_s, bool on);
  double most_missed(std::uint32_t pixel, std::int64_t time_ns) const;
  void add_shot_noise(std::uint32_t pixel, std::uint64_t frame, const LightOverTime& light,
                      std::vector<PixelEvent>& events) const;

  EventModelDesc desc_;
  SensorRandom pattern_, shots_, delays_, motions_;
  std::vector<Thresholds> thresholds_;  // by pixel
  std::vector<State> states_;           // by pixel
};

}  // namespace simvis
