// Checks the error bounds of laser scans with many random beams: every method, worlds of every kind (see
// random_worlds.h), planar scanners and lidars at several resolutions.
//
//   bound_soak [BEAMS_PER_METHOD [SEED [WORLD]]]
//
// The truth is the ray caster in double. For `raycast`, whose ranges come from that caster, the truth is a cast from a
// sensor with another orientation: with other matrices, other roundings and another tree. (The tests compare the caster
// itself with a ray cast of every triangle.)
//
// Prints CSV, one line per method and kind of world. A violation is a beam whose true range lies outside its bound.
// Violations of rendered ranges on surfaces that the bound does not cover (see depth_range.h: less than three pixels
// wide, or shown by needles) are counted separately. The exit status is 1 if there is any other violation.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/device.h>
#include <simvis/error.h>
#include <simvis/ray_caster.h>
#include "bench/random_worlds.h"
#include "engine/geometry/view_projection.h"
#include "engine/raycast/ray_triangle.h"
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/laser_scanner.h"

namespace {

using namespace simvis;

/// Quantiles of positive numbers with a relative resolution of one part in 45.
class Quantiles {
 public:
  void add(double value) {
    const double place = value > 0 ? (std::log2(value) - kLowest) * kPerOctave : 0;
    ++counts_[static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(counts_.size() - 1)))];
    ++total_;
  }
  double at(double share) const {
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      below += counts_[i];
      if (below > share * static_cast<double>(total_)) return std::exp2(kLowest + (i + 0.5) / kPerOctave);
    }
    return 0;
  }

 private:
  static constexpr double kLowest = -60, kPerOctave = 32;
  std::array<std::uint64_t, 80 * 32> counts_{};
  std::uint64_t total_ = 0;
};

struct Tally {
  std::uint64_t beams = 0, uncertain = 0, wrong_kind = 0, violations = 0, narrow = 0, needles = 0, contours = 0;
  double worst_error = 0, worst_use = 0;  ///< relative; error / bound, of certain beams within it
  Quantiles errors, bounds;               ///< relative; the bounds of certain beams
};

struct Method {
  const char *name, *max_error_rel;
  ScanMethod method;
};
constexpr Method kMethods[] = {
    {"nearest", "", ScanMethod::nearest},   {"planar", "", ScanMethod::planar},
    {"hybrid", "1e-3", ScanMethod::hybrid}, {"hybrid", "1e-4", ScanMethod::hybrid},
    {"hybrid", "1e-5", ScanMethod::hybrid}, {"hybrid", "1e-6", ScanMethod::hybrid},
    {"raycast", "", ScanMethod::raycast},
};

glm::dvec3 direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

/// The drawn meshes of a world: round shapes have flat sides in them.
struct DrawnWorld {
  explicit DrawnWorld(const DrawList& world) : list(world), caster(make_host_ray_caster()) {
    for (std::shared_ptr<const Mesh>& mesh : list.meshes) {
      auto sides = std::make_shared<Mesh>(*mesh);
      sides->surface.reset();
      mesh = std::move(sides);
    }
    caster->set_world(list);
  }

  DrawList list;
  std::unique_ptr<RayCaster> caster;
};

/// Determines if the bound of a rendered range covers a beam, from ray casts around the beam into what is drawn.
class Surroundings {
 public:
  Surroundings(const DrawnWorld& drawn, const glm::dmat4& world_from_sensor, const ScanLayout& layout)
      : list_(drawn.list), caster_(*drawn.caster), world_from_sensor_(world_from_sensor), layout_(layout) {}

  /// True if no square of three by three pixels around or beside the beam shows one plane only.
  bool is_narrow(const BeamTap& tap) const {
    constexpr int kSteps = 4, kSide = 3 * kSteps;  // per pixel, and per side of the square
    constexpr double kSamePlane = 1e-9;
    constexpr int kWidth = 2 * kSide + 1;
    std::vector<glm::dvec3> directions;
    for (int y = -kSide; y <= kSide; ++y) {
      for (int x = -kSide; x <= kSide; ++x) {
        directions.push_back(beside(tap, static_cast<double>(x) / kSteps, static_cast<double>(y) / kSteps));
      }
    }
    const std::vector<RayHit> hits = cast(directions);
    constexpr std::size_t centre = std::size_t{kSide} * kWidth + kSide;
    const bool nothing = !std::isfinite(hits[centre].range_m);  // the same width is required of a gap
    std::vector<char> on_plane;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (nothing) {
        on_plane.push_back(!std::isfinite(hits[i].range_m));
        continue;
      }
      const double expected = range_of_plane(corners_of(hits[centre]), directions[i]);
      on_plane.push_back(std::abs(hits[i].range_m - expected) <= kSamePlane * std::abs(expected));
    }
    for (int y = -kSide; y <= 0; ++y) {
      for (int x = -kSide; x <= 0; ++x) {
        bool whole = true;
        for (int v = y + kSide; v <= y + 2 * kSide && whole; ++v) {
          for (int u = x + kSide; u <= x + 2 * kSide && whole; ++u) whole = on_plane[v * kWidth + u] != 0;
        }
        if (whole) return false;
      }
    }
    return true;
  }

  /// Directions of the centres of the surrounding pixels.
  std::vector<glm::dvec3> pixels(const BeamTap& tap) const {
    std::vector<glm::dvec3> directions;
    for (int y = -kPixelsBefore; y <= kPixelsAfter; ++y) {
      for (int x = -kPixelsBefore; x <= kPixelsAfter; ++x) {
        directions.push_back(beside(tap, x - tap.fraction_x, y - tap.fraction_y));
      }
    }
    return directions;
  }

  /// True if one of the surrounding pixels shows a needle.
  bool is_at_needle(const BeamTap& tap) const {
    for (const RayHit& hit : cast(pixels(tap))) {
      if (std::isfinite(hit.range_m) && is_needle(corners_of(hit), layout_.faces[tap.face])) return true;
    }
    return false;
  }

 private:
  using Triangle = std::array<glm::dvec3, 3>;

  std::vector<RayHit> cast(const std::vector<glm::dvec3>& directions) const {
    std::vector<RayHit> hits(directions.size());
    caster_.cast(world_from_sensor_, directions, hits);
    return hits;
  }

  glm::dvec3 beside(const BeamTap& tap, double x_px, double y_px) const {
    const ScanFace& face = layout_.faces[tap.face];
    return glm::normalize(glm::transpose(face.face_from_sensor) * glm::dvec3(tap.tangent_x + x_px / face.pinhole.fx_px,
                                                                             tap.tangent_y + y_px / face.pinhole.fy_px,
                                                                             1));
  }

  Triangle corners_of(const RayHit& hit) const {
    const DrawItem& item = list_.items[hit.item];
    return place_corners(*list_.meshes[item.mesh], hit.primitive,
                         place_mesh(list_.world_from_node[item.transform], world_from_sensor_));
  }

  static double range_of_plane(const Triangle& t, const glm::dvec3& direction) {
    const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    return glm::dot(normal, t[0]) / glm::dot(normal, direction);
  }

  // k D > |gx| V + |gy| H in the terms of plane_rounding.h, for the part of the triangle within the view.
  static bool is_needle(const Triangle& triangle, const ScanFace& face) {
    View view;
    view.width_px = face.width_px;
    view.height_px = face.height_px;
    const double width = face.width_px, height = face.height_px, guard = guard_rows(view);
    const glm::dvec2 f(face.pinhole.fx_px, face.pinhole.fy_px);
    std::vector<glm::dvec3> polygon;
    for (const glm::dvec3& corner : triangle) polygon.push_back(face.face_from_sensor * corner);
    const glm::dvec3 normal = glm::cross(polygon[1] - polygon[0], polygon[2] - polygon[0]);
    const glm::dvec3 m = normal / glm::dot(normal, polygon[0]);
    const glm::dvec3 planes[] = {{f.x, 0, face.pinhole.cx_px},
                                 {-f.x, 0, width - face.pinhole.cx_px},
                                 {0, f.y, face.pinhole.cy_px + guard},
                                 {0, -f.y, height + guard - face.pinhole.cy_px}};
    for (const glm::dvec3& plane : planes) {
      std::vector<glm::dvec3> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = glm::dot(plane, a), db = glm::dot(plane, b);
        if (da >= 0) kept.push_back(a);
        if ((da >= 0) != (db >= 0)) kept.push_back(glm::mix(a, b, da / (da - db)));
      }
      polygon = kept;
    }
    // A clipped triangle is drawn as triangles around its first corner.
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[0], &b = polygon[i], &c = polygon[i + 1];
      const glm::dvec2 p = f * glm::dvec2(a) / a.z, q = f * glm::dvec2(b) / b.z, r = f * glm::dvec2(c) / c.z;
      const glm::dvec2 box = glm::max(p, glm::max(q, r)) - glm::min(p, glm::min(q, r));
      const double area = std::abs((q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y));
      const double difference = std::max({1 / a.z, 1 / b.z, 1 / c.z}) - std::min({1 / a.z, 1 / b.z, 1 / c.z});
      const double allowed = std::abs(m.x) * width / f.x + std::abs(m.y) * (height + 2 * guard) / f.y;
      if (box.x * box.y * difference > area * allowed) return true;
    }
    return false;
  }

  const DrawList& list_;
  RayCaster& caster_;
  glm::dmat4 world_from_sensor_;
  const ScanLayout& layout_;
};

/// A world whose masks are reduced or enlarged by the tolerance of a texture filter: the weights of Vulkan's linear
/// filter have subTexelPrecisionBits bits along either axis, 8 on lavapipe.
class Contours {
 public:
  explicit Contours(const DrawList& list)
      : lists_{list, list}, casters_{make_host_ray_caster(), make_host_ray_caster()} {
    constexpr float kFilter = 2 * 0x1p-8f;
    for (int i = 0; i < 2; ++i) {
      for (auto& material : lists_[i].materials) {
        auto shifted = std::make_shared<Material>(*material);
        shifted->alpha_cutoff += i == 0 ? -kFilter : kFilter;
        material = shifted;
      }
      casters_[i]->set_world(lists_[i]);
    }
  }

  /// True if the casts into the two worlds differ in any of these directions.
  bool cross(const glm::dmat4& world_from_sensor, const std::vector<glm::dvec3>& directions) {
    std::array<std::vector<RayHit>, 2> hits;
    for (int i = 0; i < 2; ++i) {
      hits[i].resize(directions.size());
      casters_[i]->cast(world_from_sensor, directions, hits[i]);
    }
    return hits[0] != hits[1];
  }

 private:
  std::array<DrawList, 2> lists_;
  std::array<std::unique_ptr<RayCaster>, 2> casters_;
};

struct Setting {
  ScanPattern pattern;
  double resolution_px;
};

Setting random_setting(std::mt19937& random) {
  using random_worlds::between;
  Setting setting;
  ScanPattern& pattern = setting.pattern;
  const double half = std::numbers::pi * (random() % 2 == 0 ? 1 : between(random, 0.1, 1));
  pattern.min_azimuth_rad = -half;
  pattern.max_azimuth_rad = half;
  if (random() % 2 == 0) {
    pattern.beams = 20011;
    setting.resolution_px = std::array{512.0, 2048.0, 4096.0, 8192.0}[random() % 4];
  } else {
    pattern.rings = random() % 2 == 0 ? 16 : 64;
    pattern.beams = 24000 / pattern.rings + 1;
    const double up = random() % 4 == 0 ? std::numbers::pi / 2 : between(random, 0.02, 0.5);
    pattern.min_elevation_rad = -up;
    pattern.max_elevation_rad = up * between(random, 0.3, 1);
    setting.resolution_px = std::array{256.0, 720.0, 1024.0}[random() % 3];
  }
  return setting;
}

void compare(const Scan& scan, std::span<const RayHit> truth, const ScanLayout& layout,
             const Surroundings& surroundings, const std::function<bool(std::size_t)>& at_contour, Tally& tally) {
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double expected = truth[i].range_m, range = scan.range_m[i], bound = scan.error_bound_m[i];
    const bool same_kind = std::isfinite(expected) == std::isfinite(range);
    const double error = expected == range ? 0 : std::abs(range - expected);
    ++tally.beams;
    tally.uncertain += std::isinf(bound);
    tally.wrong_kind += !same_kind;
    if (!(error <= bound + truth[i].error_bound_m)) {
      const bool rendered = !layout.taps.empty();
      if (rendered && surroundings.is_narrow(layout.taps[i])) {
        ++tally.narrow;
      } else if (rendered && surroundings.is_at_needle(layout.taps[i])) {
        ++tally.needles;
      } else if (rendered && at_contour(i)) {
        ++tally.contours;
      } else {
        constexpr int kPrinted = 5;
        if (tally.violations++ < kPrinted) {
          std::fprintf(stderr, "beam %zu of %u rings: true %.9g m, read %.9g m, bound %.3g m\n", i, scan.rings,
                       expected, range, bound);
        }
      }
    } else if (std::isfinite(bound) && bound > 0) {
      tally.worst_use = std::max(tally.worst_use, error / bound);
    }
    if (same_kind && std::isfinite(expected) && expected > 0) {
      tally.errors.add(error / expected);
      tally.worst_error = std::max(tally.worst_error, error / expected);
      if (std::isfinite(bound)) tally.bounds.add(bound / expected);
    }
  }
}

/// Takes one scan of each method from one pose; returns the number of beams of each.
std::size_t scan_all(const RandomWorld& world, const DrawnWorld& drawn, std::mt19937& random, Renderer& renderer,
                     RayCaster& caster, std::optional<Contours>& contours, std::span<Tally> tallies) {
  const Setting setting = random_setting(random);
  const glm::dmat4 pose = world.somewhere(random);
  const std::vector<double> azimuth = azimuths(setting.pattern), elevation = elevations(setting.pattern);
  const glm::dmat4 turn = random_worlds::turned(random);
  std::vector<glm::dvec3> directions, turned;
  for (const double e : elevation) {
    for (const double a : azimuth) {
      directions.push_back(direction(a, e));
      turned.push_back(glm::transpose(glm::dmat3(turn)) * directions.back());
    }
  }
  std::array<std::vector<RayHit>, 2> truth;  // from the sensor's pose; from another orientation
  for (int other = 0; other < 2; ++other) {
    truth[other].resize(directions.size());
    caster.cast(other ? pose * turn : pose, other ? turned : directions, truth[other]);
  }
  for (std::size_t m = 0; m < std::size(kMethods); ++m) {
    LaserScannerDesc desc;
    desc.pattern = setting.pattern;
    desc.range_min_m = 0;
    desc.range_max_m = 1e12;
    desc.method = kMethods[m].method;
    if (*kMethods[m].max_error_rel != 0) desc.max_error_rel = std::atof(kMethods[m].max_error_rel);
    desc.resolution_px = setting.resolution_px;
    LaserScanner scanner("S", desc);
    FramePlan plan;
    scanner.plan(pose, world.list, plan);
    scanner.collect({}, plan, renderer.render(world.list, plan));
    try {
      scanner.cast(caster);
    } catch (const InputError&) {
      continue;  // even cast beams do not meet this tolerance here, for example at 10^7 m from the origin
    }
    const bool renders = !plan.passes.empty();
    const ScanLayout layout = renders ? make_scan_layout(desc.pattern, desc.resolution_px) : ScanLayout{};
    const Surroundings surroundings(drawn, pose, layout);
    const std::uint64_t before = tallies[m].violations;
    const auto at_contour = [&](std::size_t beam) {
      if (!contours) contours.emplace(world.list);
      return contours->cross(pose, surroundings.pixels(layout.taps[beam]));
    };
    compare(*scanner.scan(), truth[desc.method == ScanMethod::raycast], layout, surroundings, at_contour, tallies[m]);
    if (tallies[m].violations > before) {
      std::fprintf(stderr, "^ %s %s, %.0f px\n", kMethods[m].name, kMethods[m].max_error_rel, setting.resolution_px);
    }
  }
  return directions.size();
}

}  // namespace

int main(int argc, char** argv) {
  const double beams = argc > 1 ? std::atof(argv[1]) : 1e7;
  const auto seed = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 1);
  Device device;
  bool violated = false;
  const char* only = argc > 3 ? argv[3] : nullptr;
  std::printf(
      "method,max_error_rel,world,beams,median_error,p99,p99.9,max,median_bound,bound_by_error,wrong_hit_or_miss,"
      "share_uncertain,worst_error_by_bound,violations,violations_under_3_px,violations_at_needles,"
      "violations_at_contours_of_masks\n");
  for (const WorldKind& kind : kWorldKinds) {
    if (only && std::string(only) != kind.name) continue;
    std::vector<Tally> tallies(std::size(kMethods));
    const double share = beams / std::size(kWorldKinds);
    constexpr double kWorlds = 40;  // of each kind
    for (std::uint32_t number = 0; static_cast<double>(tallies[0].beams) < share; ++number) {
      std::mt19937 random(seed * 1000003 + number);
      const RandomWorld world = kind.make(random);
      Renderer renderer(device);
      const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
      caster->set_world(world.list);
      const DrawnWorld drawn(world.list);
      std::optional<Contours> contours;
      for (double done = 0; done < share / kWorlds;) {
        done += static_cast<double>(scan_all(world, drawn, random, renderer, *caster, contours, tallies));
      }
    }
    for (std::size_t m = 0; m < tallies.size(); ++m) {
      const Tally& t = tallies[m];
      const auto of_all = [&](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(t.beams); };
      std::printf("%s,%s,%s,%llu,%.3g,%.3g,%.3g,%.3g,%.3g,%.3g,%llu,%.3g,%.3g,%llu,%llu,%llu,%llu\n", kMethods[m].name,
                  kMethods[m].max_error_rel, kind.name, static_cast<unsigned long long>(t.beams), t.errors.at(0.5),
                  t.errors.at(0.99), t.errors.at(0.999), t.worst_error, t.bounds.at(0.5),
                  t.bounds.at(0.5) / t.errors.at(0.5), static_cast<unsigned long long>(t.wrong_kind),
                  of_all(t.uncertain), t.worst_use, static_cast<unsigned long long>(t.violations),
                  static_cast<unsigned long long>(t.narrow), static_cast<unsigned long long>(t.needles),
                  static_cast<unsigned long long>(t.contours));
      violated |= t.violations > 0;
    }
    std::fflush(stdout);
  }
  return violated ? 1 : 0;
}
