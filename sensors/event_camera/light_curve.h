// The light of a pixel over time as a broken line, close enough to the light itself for the times of its crossings.
//
// Method   The time is divided so that no surface moves by more than a step in an interval, and each interval is halved
//          until the parabola through its ends and its middle agrees with the light at two more places, kOffCentre of
//          the interval from its ends: the light of a straight edge that crosses a square at constant speed consists of
//          parabolas. Each parabola is then divided until its chords agree with it. Light agrees if a level that is
//          crossed there is crossed at the right time to within half of `time_error_s`, or if the light itself is right
//          to within kLightError of itself and of the darkness. No interval becomes shorter than time_error_s, and
//          one whose light is the same at both ends is not divided if no edge comes into the pixel.
//          Light that agrees does not show an edge that comes in and leaves between two of these times. Where there is
//          one, the light at its deepest time must agree too, or the interval is divided there.
// Source   ESIM (Rebecq, Gehrig, Scaramuzza, CoRL 2018) interpolates the logarithm of the light between pictures.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace simvis {

/// The light at one time.
struct LightKnot {
  double time = 0;   ///< share of the time between two measurements, from 0 to 1
  double light = 0;  ///< luminance
};

struct LightCurveDesc {
  double duration_s = 0;    ///< of the whole curve, above 0
  double time_error_s = 0;  ///< above 0
  double darkness = 0;      ///< luminance that is added to all light before its logarithm is taken
};

/// The functions that give the light of one pixel. Times are those of the curve.
struct LightSource {
  /// The light at a time.
  std::function<double(double time)> light;
  /// Whether an edge of something may come into the pixel between two times.
  std::function<bool(double begin, double end)> has_edges;
  /// Appends the times at which one of the edges that has_edges() found last is best seen, if none of the times
  /// `looked_at`, ascending, shows it.
  std::function<void(std::span<const double> looked_at, std::vector<double>& times)> touches;
};

inline constexpr double kLightError = 1e-6, kOffCentre = 0.2764;

/// Appends the knots of a curve that begins with `intervals` equal ones, its first and its last point included.
void add_light_curve(const LightCurveDesc& desc, std::uint32_t intervals, const LightSource& source,
                     std::vector<LightKnot>& knots);

}  // namespace simvis
