// Hard cases: scenes computed from geometry, measured by every method and compared with a closed form.
//
// Each case is one line of a table that the program prints at its end: by method, the largest relative error, and the
// number of beams that hit where they should miss or miss where they should hit. `nearest` is the method of other
// simulators: it is measured for that column, and the only requirement is that its bound holds.
#pragma once

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/draw_list.h>
#include "sensors/laser_scanner/laser_scanner.h"

namespace simvis {

/// The hit of a beam in this direction (unit, sensor frame): range along the ray in metres, +infinity for none.
using ClosedForm = std::function<double(const glm::dvec3& direction)>;

/// `hybrid` is measured with this max_error_rel unless a case has another one. With its default it would render nothing
/// and equal `raycast`.
inline constexpr double kHybridError = 1e-4;

/// XML attributes of a scanner: the method, and for `hybrid` kHybridError, with which it both renders and casts.
std::string method_attributes(std::string_view method);

struct HardCase {
  std::string name;  ///< for the table
  DrawList world{};
  LaserScannerDesc scanner{};  ///< the method is filled in
  glm::dmat4 world_from_sensor{1.0};
  ClosedForm truth{};
  /// The error of the closed form itself, relative to the range, for example rounding of the scene to float32. 0: exact
  /// to the rounding of double.
  double truth_error_rel = 0;
  double hybrid_error_rel = kHybridError;  ///< the max_error_rel that `hybrid` is measured with
  /// The scene has surfaces narrower than three pixels, which the bounds of `nearest` and `planar` do not cover.
  bool narrow = false;
};

/// The part of a table line for one method.
struct HardResult {
  Scan scan;
  double worst_error_rel = 0;  ///< of beams where reading and truth are both ranges
  std::size_t wrong_kind = 0;  ///< hits for misses, misses for hits
  std::size_t uncertain = 0;   ///< infinite bound
  std::size_t violations = 0;  ///< the truth lies outside the bound
  std::size_t cast = 0;        ///< beams that were cast
};

struct HardResults {
  HardResult nearest, planar, hybrid, raycast;
};

/// The largest relative error allowed for a cast range.
inline constexpr double kCastError = 1e-6;

/// Measures the case by every method, adds its line to the table, and checks what every case has to keep:
///   - the truth lies within the bound, for every method (for raster methods not where `narrow`);
///   - no method's error, and no method's count of wrong hits and misses, is above twice what is committed of it in
///     committed_errors.h;
///   - raycast: every range within kCastError of the truth, no hit for a miss, no miss for a hit, no infinite bound;
///   - hybrid: every range within kHybridError, and where not `narrow` no wrong hit or miss.
/// Both allow truth_error_rel besides. The results are for what a case checks beyond that.
HardResults measure(const HardCase& hard);

/// Several scans in one line: the worst error of all and the sum of wrong hits and misses; each is checked as above.
std::vector<HardResults> measure_together(const std::string& name, const std::vector<HardCase>& parts);

/// One scan of the case by one method, without checks.
HardResult measure(const HardCase& hard, ScanMethod method);

/// The raster methods of the case (compared with committed_errors.h likewise) at this many pixels across 90 degrees: a
/// line below the case's own. Other simulators commonly take 256 or 512. Checks that the truth lies within the bounds
/// (not where `narrow`).
void measure_raster(const HardCase& hard, double resolution_px);

/// Adds a line of another measure than the relative error, which the name has to say: cells for nearest, planar,
/// hybrid and raycast.
void add_line(const std::string& name, const std::array<std::string, 4>& cells);

/// Adds a line that is no scan, such as "10,000,000 beams inside closed meshes" with its outcome.
void add_line(const std::string& name, const std::string& outcome);

}  // namespace simvis
