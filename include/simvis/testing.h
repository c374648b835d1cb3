// Tests of robot software in C++: matchers that use the error bounds of measurements, for any test framework, and
// <simvis/test_run.h>, which needs simvis::testing. docs/testing.md has examples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <string>

#include <simvis/error.h>
#include <simvis/image.h>
#include <simvis/measurement.h>
#include <simvis/pictures_near.h>
#include <simvis/scan.h>
#include <simvis/test_run.h>
#include <simvis/verdict.h>

namespace simvis::test_kit {

namespace detail {

/// The text of a verdict on a scan that has not been measured yet.
inline constexpr const char* kEmptyScan = "the scan has no beams: nothing was measured yet";

/// "beam BEAM", of a scan with several rings "beam BEAM of ring RING".
inline std::string beam_text(const Scan& scan, std::size_t i) {
  const std::size_t beams = scan.beams;
  return "beam " + std::to_string(i % beams) + (scan.rings > 1 ? " of ring " + std::to_string(i / beams) : "");
}

/// The text that follows an allowed difference.
inline std::string slack_text(double slack_m) { return slack_m == 0 ? "" : " and " + short_number(slack_m) + " m"; }

/// depths_near() for rows of `width` numbers of any type.
template <typename One, typename Other>
Verdict compare_depths(std::size_t width, const One& one, const Other& other, double allowed_m) {
  std::size_t wrong = 0, worst = 0;
  double most = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double a = one[i], b = other[i];
    const double apart = a == b ? 0 : std::abs(a - b);
    wrong += !(apart <= allowed_m);
    if (apart > most) {
      most = apart;
      worst = i;
    }
  }
  if (one.empty()) return {true, "the images have no pixels"};
  return {wrong == 0, std::to_string(wrong) + " of " + std::to_string(one.size()) + " pixels differ by more than " +
                          short_number(allowed_m) + " m; farthest: pixel (" + std::to_string(worst % width) + ", " +
                          std::to_string(worst / width) + "), " + number(one[worst]) + " and " + number(other[worst]) +
                          " m"};
}

}  // namespace detail

/// Whether the range of beam i = ring * beams + beam is the expected one, within the beam's own error bound and
/// `slack_m`, which is for noise and for what the expectation itself is uncertain by.
///
/// Units    metres along the ray; `expected_m` is infinite if the beam meets nothing.
/// Errors   InputError: there is no such beam.
inline Verdict range_near(const Scan& scan, std::size_t i, double expected_m, double slack_m = 0) {
  if (i >= scan.range_m.size()) {
    throw InputError("the scan has " + std::to_string(scan.range_m.size()) + " beams, and no beam " +
                     std::to_string(i));
  }
  const double measured = scan.range_m[i], bound = scan.error_bound_m[i];
  const double apart = measured == expected_m ? 0 : std::abs(measured - expected_m);  // both may be infinite
  return {apart == 0 || (std::isfinite(apart) && apart <= bound + slack_m),
          detail::beam_text(scan, i) + " measures " + detail::number(measured) + " m, expected " +
              detail::number(expected_m) + " m: " + detail::short_number(apart) + " m apart, allowed " +
              detail::short_number(bound) + " m" + detail::slack_text(slack_m),
          {scan.range_m.data(), i}};
}

/// Whether all beams of two scans agree within the sum of their error bounds and `slack_m`, in metres. A beam whose
/// bound is infinite in one of them decides nothing; a range that is not a number is near nothing. False for scans
/// without beams.
inline Verdict scans_near(const Scan& one, const Scan& other, double slack_m = 0) {
  if (one.rings != other.rings || one.beams != other.beams || one.range_m.size() != other.range_m.size()) {
    return {false, "the scans have different beams"};
  }
  if (one.range_m.empty()) return {false, detail::kEmptyScan};
  std::size_t wrong = 0, worst = 0;
  double most = 0;
  for (std::size_t i = 0; i < one.range_m.size(); ++i) {
    const double a = one.range_m[i], b = other.range_m[i];
    const double allowed = static_cast<double>(one.error_bound_m[i]) + other.error_bound_m[i] + slack_m;
    double excess = a == b || std::isinf(allowed) ? 0 : std::abs(a - b) - allowed;
    if (std::isnan(excess)) excess = std::numeric_limits<double>::infinity();
    wrong += excess > 0;
    if (excess > most) {
      most = excess;
      worst = i;
    }
  }
  const std::string count = std::to_string(wrong) + " of " + std::to_string(one.range_m.size());
  if (wrong == 0) return {true, count + " beams differ by more than their bounds"};
  const double allowed = static_cast<double>(one.error_bound_m[worst]) + other.error_bound_m[worst];
  return {false,
          count + " beams differ by more than their bounds; worst: " + detail::beam_text(one, worst) + ", " +
              detail::number(one.range_m[worst]) + " and " + detail::number(other.range_m[worst]) + " m, allowed " +
              detail::short_number(allowed) + " m" + detail::slack_text(slack_m),
          {one.range_m.data(), worst}};
}

/// Whether nothing can be nearer to the scanner than `distance_m`: each range less its error bound is at least that. A
/// beam whose bound is infinite may have met a surface at any range.
/// False for a scan without beams.
inline Verdict clear_of(const Scan& scan, double distance_m) {
  if (scan.range_m.empty()) return {false, detail::kEmptyScan};
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const double range = scan.range_m[i];
    const double bound = scan.error_bound_m[i];
    const bool known = !std::isinf(bound) && !std::isnan(range - bound);
    const double low = known ? range - bound : -std::numeric_limits<double>::infinity();
    if (low < least) {
      least = low;
      nearest = i;
    }
  }
  return {least >= distance_m,
          detail::beam_text(scan, nearest) + " measures " + detail::number(scan.range_m[nearest]) + " m +- " +
              detail::short_number(scan.error_bound_m[nearest]) + " m, the nearest of all; expected at least " +
              detail::number(distance_m) + " m",
          {scan.range_m.data(), nearest}};
}

/// Whether a sensor of type contact, bumper or touch touches nothing, by its last reading.
///
/// Errors   InputError: the reading is of another type of sensor.
inline Verdict no_contact(const Reading& reading) {
  const auto has = [&](const char* name) {
    return std::any_of(reading.arrays.begin(), reading.arrays.end(),
                       [&](const MeasuredArray& column) { return column.name == name; });
  };
  const bool has_pressed = has("pressed");
  if (!has_pressed && !(has("depth_m") && has("force_n"))) {
    throw InputError("the reading is not of a contact, a bumper or a touch");
  }
  std::size_t touches = 0;  // of a contact, a row is a point that touches
  for (std::size_t row = 0; row < reading.rows(); ++row) touches += !has_pressed || *reading.find("pressed", row) != 0;
  return {touches == 0, "the sensor has " + std::to_string(touches) + " contacts, expected none"};
}

/// Whether two rigid poses are at most so far apart: of their origins in metres, and of the turn between them in
/// degrees.
inline Verdict pose_near(const glm::dmat4& one, const glm::dmat4& other, double position_m, double angle_deg) {
  const double apart = glm::length(glm::dvec3(one[3] - other[3]));
  const glm::dmat3 turn = glm::transpose(glm::dmat3(one)) * glm::dmat3(other);
  // The sine is exact for small turns, the cosine for large ones.
  const double sine =
      glm::length(glm::dvec3(turn[1][2] - turn[2][1], turn[2][0] - turn[0][2], turn[0][1] - turn[1][0])) / 2;
  const double angle = glm::degrees(std::atan2(sine, (turn[0][0] + turn[1][1] + turn[2][2] - 1) / 2));
  return {apart <= position_m && angle <= angle_deg,
          "the poses are " + detail::number(apart) + " m and " + detail::number(angle) + " deg apart, allowed " +
              detail::number(position_m) + " m and " + detail::number(angle_deg) + " deg"};
}

/// Whether a point lies within `distance_m` of a path of straight pieces between points, all in metres and in one
/// frame.
inline Verdict near_path(const glm::dvec3& point, std::span<const glm::dvec3> path, double distance_m) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const glm::dvec3 way = path[std::min(i + 1, path.size() - 1)] - path[i];
    const double length = glm::dot(way, way);
    const double along = length > 0 ? std::clamp(glm::dot(point - path[i], way) / length, 0.0, 1.0) : 0;
    least = std::min(least, glm::length(point - (path[i] + along * way)));
  }
  return {least <= distance_m, "the position is " + detail::number(least) + " m beside the path, allowed " +
                                   detail::number(distance_m) + " m"};
}

/// Whether a depth image is the expected one, within `bound_m` (Simulation::value(CAMERA, "depth_error_bound_m")) and
/// `slack_m`. Metres along the optical axis.
inline Verdict depths_near(const Image& one, const Image& other, double bound_m, double slack_m = 0) {
  if (one.width != other.width || one.height != other.height || one.channels != 1 || other.channels != 1) {
    return {false, "the images have different shapes, or are no depth images"};
  }
  return detail::compare_depths(one.width, one.pixels, other.pixels, bound_m + slack_m);
}

}  // namespace simvis::test_kit
