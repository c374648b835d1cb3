// Compares the recording of a real laser scanner with the same scanner in a scene: what its angles, ranges,
// intensities and lost beams say of the parameters of the simulated one.
//
// Beams    each recorded beam is cast into the scene, from where the device says that it starts and in the direction
//          that the device says. Beams within kEdge_rad of an edge, that meet their surface at less than about six
//          degrees, or that read something else than the surface of the scene are counted and left out.
// Ranges   range = true range + bias, along the corrected direction; the corrections are an azimuth and an elevation of
//          each ring and, if asked for, the sensor's position and tilt. A surface with the normal n at the angle of
//          incidence t moves the range by n . displacement / cos t, which Gauss and Newton's method follows.
// Noise    variance of the residuals = range_noise^2 + (range_noise_rel range)^2 + (angular_noise slope)^2, where the
//          slope is how fast the range changes with the angles; that of the device's rounding is taken off.
// Intensity = gain reflectance cos(t)^p / range^q, with the reflectance of the scene's materials.
// Lost     a beam of power P = reflectance cos(t) / range^2 is lost with the probability of the effect `dropout`.
// Intervals of 95 % are those of the normal distribution; exchange/fidelity/least_squares.h says what they allow for.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/program_api.h"
#include "exchange/fidelity/compared_scanner.h"
#include "exchange/fidelity/fitted_number.h"
#include "exchange/packets/beam_recording.h"

namespace simvis {

struct FittedParameter {
  std::string name, unit;
  std::string text;  ///< what it is
  FittedNumber fitted;
};

struct FittedRing {
  std::uint32_t ring = 0;
  std::size_t beams = 0;                        ///< that the fit has used
  FittedNumber azimuth_deg{}, elevation_deg{};  ///< to add to what the device says
  double residual_m = 0;                        ///< root of the mean square of what is left
};

/// A measured value with its interval of 95 %, and the model there.
struct CurvePoint {
  double x = 0, y = 0, low = 0, high = 0;
  double model = 0;  ///< NaN: none
};
struct ComparedCurve {
  std::string name, x_label, y_label;
  std::vector<CurvePoint> points{};
};

struct FidelityReport {
  std::string scanner, source;
  std::uint32_t scans = 0;
  std::size_t beams = 0;  ///< recorded; the sum of the following
  std::size_t used = 0, lost = 0, at_edges = 0, grazing = 0, other_surface = 0, outside = 0;
  bool fitted_pose = false;
  double residual_m = 0;  ///< root of the mean square of what is left of the ranges
  std::vector<FittedParameter> parameters{};
  std::vector<FittedRing> rings{};
  std::vector<ComparedCurve> curves{};
  std::vector<std::string> notes{};  ///< what could not be compared, and why

  /// The parameter of this name; null if it was not fitted.
  const FittedParameter* find(std::string_view parameter) const;
};

struct FidelityDesc {
  bool fit_pose = false;  ///< the scene's pose of the sensor is not exact: fit position and tilt as well
};

/// Throws InputError if no recorded beam meets a surface of the scene.
SIMVIS_PROGRAM_API FidelityReport compare_recording(BeamRecording recording, const ComparedScanner& scanner,
                                                    const FidelityDesc& desc);

/// Reads a capture file or an MCAP file, by its extension, see exchange/fidelity/recordings.h, and compares it. `topic`
/// chooses one of an MCAP file. Throws InputError, also if a capture file comes with a scanner whose packets are not
/// known.
SIMVIS_PROGRAM_API FidelityReport compare_recording_file(const std::string& file, const std::string& topic,
                                                         std::uint32_t scans, const ComparedScanner& scanner,
                                                         const FidelityDesc& desc);

}  // namespace simvis
