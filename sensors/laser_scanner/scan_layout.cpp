#include "sensors/laser_scanner/scan_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/assert.h"

namespace simvis {

namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;

std::vector<double> spread(double min, double max, std::uint32_t count) {
  std::vector<double> values(count, min);
  for (std::uint32_t i = 1; i < count; ++i) values[i] = min + i * (max - min) / (count - 1);
  return values;
}

std::vector<double> to_radians(std::vector<double> angles_deg) {
  for (double& angle : angles_deg) angle = glm::radians(angle);
  return angles_deg;
}

std::vector<double> to_degrees(std::vector<double> angles_rad) {
  for (double& angle : angles_rad) angle = glm::degrees(angle);
  return angles_rad;
}

// The rows of the result are right, down and forward of a level face whose optical axis has this azimuth.
glm::dmat3 level_face(double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  return glm::transpose(glm::dmat3(glm::dvec3(s, -c, 0), glm::dvec3(0, 0, -1), glm::dvec3(c, s, 0)));
}

glm::dmat3 upright_face(double up) {
  return glm::transpose(glm::dmat3(glm::dvec3(0, -1, 0), glm::dvec3(up, 0, 0), glm::dvec3(0, 0, up)));
}

struct Extent {
  double min_u = std::numeric_limits<double>::infinity(), max_u = -min_u, min_v = min_u, max_v = -min_u;

  void add(double u, double v) {
    min_u = std::min(min_u, u);
    max_u = std::max(max_u, u);
    min_v = std::min(min_v, v);
    max_v = std::max(max_v, v);
  }
};

// The faces: level faces side by side, then one that looks straight up and one that looks straight down.
class Faces {
 public:
  explicit Faces(const ScanPattern& pattern) : min_azimuth_(pattern.min_azimuth_rad) {
    const double span = pattern.max_azimuth_rad - pattern.min_azimuth_rad;
    // Rounding must not add a face.
    level_count_ = std::max(1, static_cast<int>(std::ceil(span / kQuarterTurn - 1e-9)));
    width_ = span / level_count_;
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(level_count_) + 2; }

  glm::dmat3 face_from_sensor(std::uint32_t face) const {
    const int index = static_cast<int>(face) - level_count_;
    return index < 0 ? level_face(centre(face)) : upright_face(index == 0 ? 1 : -1);
  }

  // Face and tangents of a beam: the level face of its azimuth, unless the beam is steeper than that face's 45 degrees.
  BeamTap aim(double azimuth, double elevation) const {
    BeamTap tap;
    const double place = width_ > 0 ? std::floor((azimuth - min_azimuth_) / width_) : 0.0;
    tap.face = static_cast<std::uint32_t>(std::clamp(static_cast<int>(place), 0, level_count_ - 1));
    const double off_axis = centre(tap.face) - azimuth;
    const double slope = std::tan(elevation) / std::cos(off_axis);
    if (std::abs(slope) <= 1) {
      tap.tangent_x = std::tan(off_axis);
      tap.tangent_y = -slope;
    } else {
      const double up = elevation > 0 ? 1 : -1;
      const double reach = std::tan(kQuarterTurn - std::abs(elevation));
      tap.face = static_cast<std::uint32_t>(level_count_ + (up > 0 ? 0 : 1));
      tap.tangent_x = -reach * std::sin(azimuth);
      tap.tangent_y = up * reach * std::cos(azimuth);
    }
    tap.ray_per_depth = std::sqrt(1 + tap.tangent_x * tap.tangent_x + tap.tangent_y * tap.tangent_y);
    return tap;
  }

 private:
  double centre(std::uint32_t face) const { return min_azimuth_ + (face + 0.5) * width_; }

  double min_azimuth_, width_;
  int level_count_;
};

void mark_columns(ScanLayout& layout) {
  std::vector<std::vector<std::uint32_t>> columns(layout.faces.size());
  for (const BeamTap& tap : layout.taps) {
    for (std::uint32_t x = tap.x - kPixelsBefore; x <= tap.x + kPixelsAfter; ++x) columns[tap.face].push_back(x);
  }
  for (std::size_t f = 0; f < columns.size(); ++f) {
    std::ranges::sort(columns[f]);
    columns[f].erase(std::unique(columns[f].begin(), columns[f].end()), columns[f].end());
    layout.faces[f].columns = std::make_shared<const std::vector<std::uint32_t>>(std::move(columns[f]));
  }
}

}  // namespace

std::vector<double> azimuths(const ScanPattern& pattern) {
  if (pattern.degrees) return to_radians(azimuths_deg(pattern));
  return spread(pattern.min_azimuth_rad, pattern.max_azimuth_rad, pattern.beams);
}

std::vector<double> elevations(const ScanPattern& pattern) {
  if (pattern.degrees) return to_radians(elevations_deg(pattern));
  return spread(pattern.min_elevation_rad, pattern.max_elevation_rad, pattern.rings);
}

std::vector<double> azimuths_deg(const ScanPattern& pattern) {
  if (!pattern.degrees) return to_degrees(azimuths(pattern));
  return spread(pattern.degrees->min_azimuth_deg, pattern.degrees->max_azimuth_deg, pattern.beams);
}

std::vector<double> elevations_deg(const ScanPattern& pattern) {
  if (!pattern.degrees) return to_degrees(elevations(pattern));
  return spread(pattern.degrees->min_elevation_deg, pattern.degrees->max_elevation_deg, pattern.rings);
}

ScanLayout make_scan_layout(const ScanPattern& pattern, double resolution_px) {
  SIMVIS_ASSERT(pattern.beams >= 1 && pattern.rings >= 1 && resolution_px >= 1);
  const bool level = pattern.rings == 1 && pattern.min_elevation_rad == 0;
  const double focal_x_px = resolution_px / 2;  // 90 degrees: tangents from -1 to 1
  const double focal_y_px = level ? kRowsPerPixel * focal_x_px : focal_x_px;
  const Faces faces(pattern);
  ScanLayout layout;
  layout.taps.reserve(std::size_t{pattern.beams} * pattern.rings);
  std::vector<Extent> extents(faces.count());
  std::vector<std::uint32_t> beams(faces.count());
  for (const double elevation : elevations(pattern)) {
    for (const double azimuth : azimuths(pattern)) {
      const BeamTap tap = faces.aim(azimuth, elevation);
      extents[tap.face].add(focal_x_px * tap.tangent_x, focal_y_px * tap.tangent_y);
      ++beams[tap.face];
      layout.taps.push_back(tap);
    }
  }

  std::vector<std::uint32_t> number(faces.count());
  std::vector<glm::ivec2> origin;  // of each kept face: the grid coordinates of its first pixel
  for (std::uint32_t f = 0; f < faces.count(); ++f) {
    if (beams[f] == 0) continue;
    const Extent& e = extents[f];
    const glm::ivec2 first(static_cast<int>(std::floor(e.min_u)) - kPixelsBefore,
                           static_cast<int>(std::floor(e.min_v)) - kPixelsBefore);
    const glm::ivec2 last(static_cast<int>(std::floor(e.max_u)) + kPixelsAfter,
                          static_cast<int>(std::floor(e.max_v)) + kPixelsAfter);
    number[f] = static_cast<std::uint32_t>(layout.faces.size());
    origin.push_back(first);
    layout.faces.push_back({faces.face_from_sensor(f),
                            {focal_x_px, focal_y_px, 0.5 - first.x, 0.5 - first.y},
                            static_cast<std::uint32_t>(last.x - first.x + 1),
                            static_cast<std::uint32_t>(last.y - first.y + 1),
                            beams[f],
                            nullptr});
  }
  for (BeamTap& tap : layout.taps) {
    tap.face = number[tap.face];
    const double u = focal_x_px * tap.tangent_x, v = focal_y_px * tap.tangent_y;
    tap.x = static_cast<std::uint32_t>(static_cast<int>(std::floor(u)) - origin[tap.face].x);
    tap.y = static_cast<std::uint32_t>(static_cast<int>(std::floor(v)) - origin[tap.face].y);
    tap.fraction_x = u - std::floor(u);
    tap.fraction_y = v - std::floor(v);
  }
  mark_columns(layout);
  return layout;
}

}  // namespace simvis
