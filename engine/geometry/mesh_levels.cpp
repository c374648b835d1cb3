#include "engine/geometry/mesh_levels.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "engine/geometry/mesh_cache.h"
#include "engine/geometry/submesh.h"
#include "engine/geometry/surface_deviation.h"
#include "engine/geometry/thinning.h"

namespace simvis {
namespace {

// The version of the result of coarser_corners() and of the file format of words_of_levels().
constexpr char kLevelsVersion = '3';

constexpr std::size_t kMaxLevels = 6;

// A level with a larger share of the triangles of the level before is not worth its memory.
constexpr double kWorthALevel = 0.8;

// A level that keeps less of the area of the level before has lost whole parts: meshoptimizer weighs the leaves of a
// crown by their size alone.
constexpr double kKeptArea = 0.9;

// The largest error of a level, as a share of the longest side of the mesh's box.
constexpr double kMaxShare = 0.2;

// Errors below this share of the longest side are treated as equal: a mesh is exact to a sixteenth of a pixel where it
// spans 4096 pixels.
constexpr double kMinShare = 1.0 / 65536;

using LevelIndices = std::vector<std::uint32_t>;

/// The corners of a level's triangles, as indices of the mesh's vertices, and its error.
struct CoarserCorners {
  LevelIndices indices;
  float error_m = 0;
  float enlarged = 1;  ///< factor of the lengths of its parts, see ThinnedParts
};

/// A triangle regardless of the side that it shows, and which side that is.
struct SidedTriangle {
  std::array<std::uint32_t, 3> corners;  ///< ascending
  std::uint32_t number = 0;
  bool turned = false;

  auto operator<=>(const SidedTriangle&) const = default;
};

SidedTriangle sided(const std::uint32_t* corner, std::uint32_t number) {
  std::array<std::uint32_t, 3> corners{corner[0], corner[1], corner[2]};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  const bool turned = corners[1] > corners[2];
  if (turned) std::swap(corners[1], corners[2]);
  return {corners, number, turned};
}

// The triangles of one side, if each stands twice with opposite windings; else none.
std::optional<LevelIndices> one_side(const LevelIndices& indices) {
  std::vector<SidedTriangle> triangles;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    triangles.push_back(sided(&indices[i], static_cast<std::uint32_t>(i / 3)));
  }
  std::ranges::sort(triangles);
  std::vector<bool> stays(triangles.size());
  for (std::size_t i = 0; i < triangles.size();) {
    const std::array<std::uint32_t, 3>& corners = triangles[i].corners;
    int unpaired = 0;  // above 0: of those that are not turned
    for (; i < triangles.size() && triangles[i].corners == corners; ++i) {
      const int one = triangles[i].turned ? -1 : 1;
      stays[triangles[i].number] = unpaired * one >= 0;
      unpaired += one;
    }
    if (unpaired != 0) return {};
  }
  LevelIndices side;
  for (std::size_t t = 0; t < stays.size(); ++t) {
    if (stays[t]) side.insert(side.end(), &indices[3 * t], &indices[3 * t] + 3);
  }
  return side;
}

// Half of the triangles, or as few as meshoptimizer reaches.
CoarserCorners simplified(const Mesh& mesh, const CoarserCorners& finer, LevelBorders borders) {
  const float* const points = &mesh.positions[0].x;
  const std::size_t count = mesh.positions.size(), corners = finer.indices.size();
  CoarserCorners level{.indices = LevelIndices(corners), .enlarged = finer.enlarged};
  const unsigned options = borders == LevelBorders::kept ? meshopt_SimplifyLockBorder : 0;
  level.indices.resize(meshopt_simplify(level.indices.data(), finer.indices.data(), corners, points, count,
                                        sizeof(glm::vec3), corners / 6 * 3, static_cast<float>(kMaxShare), options,
                                        nullptr));
  return level;
}

bool is_worth_it(const CoarserCorners& level, const CoarserCorners& finer) {
  const auto size = static_cast<double>(level.indices.size()), before = static_cast<double>(finer.indices.size());
  return size > 0 && size <= kWorthALevel * before;
}

// Where a surface can be no simpler, as that of a leaf, every second of its parts stays. All stay where borders do.
std::optional<CoarserCorners> coarser(const Mesh& mesh, const CoarserCorners& finer, LevelBorders borders) {
  CoarserCorners level = simplified(mesh, finer, borders);
  if (is_worth_it(level, finer) && surface_area(mesh, level.indices) >= kKeptArea * surface_area(mesh, finer.indices)) {
    return level;
  }
  if (borders == LevelBorders::kept) return {};
  std::optional<ThinnedParts> fewer = thinned(mesh, finer.indices);
  if (!fewer) return {};
  level = {.indices = std::move(fewer->indices), .enlarged = static_cast<float>(finer.enlarged * fewer->enlarged)};
  if (is_worth_it(level, finer)) return level;
  return {};
}

void add_other_side(LevelIndices& indices) {
  for (std::size_t i = 0, end = indices.size(); i < end; i += 3) {
    indices.insert(indices.end(), {indices[i], indices[i + 2], indices[i + 1]});
  }
}

double longest_side(const Mesh& mesh) {
  const glm::vec3 size = mesh.bounds_max - mesh.bounds_min;
  return std::max({size.x, size.y, size.z});
}

// Each level is made of the one before, and its error is that of the level before and their distance together.
std::vector<CoarserCorners> coarser_corners(const Mesh& mesh, LevelBorders borders, ThreadPool* pool) {
  std::vector<CoarserCorners> levels;
  const double longest_m = longest_side(mesh);
  if (!(longest_m > 0)) return levels;
  const std::optional<LevelIndices> side = one_side(mesh.indices);
  CoarserCorners finer{.indices = side ? *side : mesh.indices};
  std::optional<SurfaceTree> finer_surface;  // not made for a mesh without levels
  double error_m = 0;
  while (levels.size() < kMaxLevels && finer.indices.size() >= 3 * kMinLevelledTriangles) {
    std::optional<CoarserCorners> level = coarser(mesh, finer, borders);
    if (!level) break;
    if (!finer_surface) finer_surface.emplace(mesh.positions, finer.indices, pool);
    SurfaceTree surface(enlarged_positions(mesh, level->indices, level->enlarged), level->indices, pool);
    error_m += surface_deviation(*finer_surface, surface, kMinShare * longest_m, pool);
    if (error_m > kMaxShare * longest_m) break;
    // Rounded up: the error stays a bound.
    level->error_m = std::nextafter(static_cast<float>(error_m), std::numeric_limits<float>::infinity());
    finer = *level;
    finer_surface = std::move(surface);
    if (side) add_other_side(level->indices);
    levels.push_back(std::move(*level));
  }
  return levels;
}

// For each level its number of indices, its error, the factor of its parts and its indices.
std::vector<std::uint32_t> words_of_levels(const std::vector<CoarserCorners>& levels) {
  std::vector<std::uint32_t> words;
  for (const CoarserCorners& level : levels) {
    words.push_back(static_cast<std::uint32_t>(level.indices.size()));
    words.push_back(std::bit_cast<std::uint32_t>(level.error_m));
    words.push_back(std::bit_cast<std::uint32_t>(level.enlarged));
    words.insert(words.end(), level.indices.begin(), level.indices.end());
  }
  words.push_back(0);  // the end, so that a mesh without levels has a file too
  return words;
}

// None if the words are not those of levels of the mesh.
std::optional<std::vector<CoarserCorners>> levels_in(std::span<const std::uint32_t> words, const Mesh& mesh) {
  std::vector<CoarserCorners> levels;
  while (words.size() > 3 && levels.size() < kMaxLevels) {
    const std::size_t count = words[0];
    const auto error_m = std::bit_cast<float>(words[1]), enlarged = std::bit_cast<float>(words[2]);
    words = words.subspan(3);
    if (count == 0 || count % 3 != 0 || count > words.size()) return {};
    if (!(std::isfinite(error_m) && error_m > 0 && std::isfinite(enlarged) && enlarged >= 1)) return {};
    const auto indices = words.first(count);
    if (*std::ranges::max_element(indices) >= mesh.positions.size()) return {};
    levels.push_back({{indices.begin(), indices.end()}, error_m, enlarged});
    words = words.subspan(count);
  }
  if (words.size() == 1 && words[0] == 0) return levels;
  return {};
}

std::vector<CoarserCorners> coarser_corners_cached(const Mesh& mesh, LevelBorders borders,
                                                   const std::filesystem::path& folder, ThreadPool* pool) {
  if (folder.empty()) return coarser_corners(mesh, borders, pool);
  const MeshCacheFile file(folder, borders == LevelBorders::kept ? "tile" : "levels", kLevelsVersion, mesh);
  if (std::optional<std::vector<CoarserCorners>> kept = levels_in(file.read(), mesh)) return std::move(*kept);
  std::vector<CoarserCorners> levels = coarser_corners(mesh, borders, pool);
  file.write(words_of_levels(levels));
  return levels;
}

}  // namespace

std::vector<MeshLevel> make_levels(const Mesh& mesh, LevelBorders borders, const std::filesystem::path& folder,
                                   ThreadPool* pool) {
  std::vector<MeshLevel> levels;
  if (mesh.topology != Topology::triangles || mesh.short_lived || mesh.indices.size() < 3 * kMinLevelledTriangles)
    return levels;
  for (const CoarserCorners& level : coarser_corners_cached(mesh, borders, folder, pool)) {
    const std::vector<glm::vec3> positions = enlarged_positions(mesh, level.indices, level.enlarged);
    levels.push_back({submesh(mesh, positions, level.indices), static_cast<double>(level.error_m)});
  }
  return levels;
}

}  // namespace simvis
