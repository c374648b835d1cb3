// Coarser levels of a mesh, with a bound on how far each is from the mesh.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

class ThreadPool;

/// A mesh that stands in for another one. Its vertices are vertices of that mesh, with their attributes; where parts
/// are left out, those that stay are enlarged about their middles.
struct MeshLevel {
  std::shared_ptr<const Mesh> mesh;
  /// In the mesh's frame: no point of either surface is farther from the other.
  double error_m = 0;
};

/// A mesh with fewer triangles has no levels: its instances cost more than its triangles.
inline constexpr std::size_t kMinLevelledTriangles = 64;

/// Whether levels keep the borders of their mesh, as tiles of a larger mesh must, or simplify them too.
enum class LevelBorders : std::uint8_t { free, kept };

/// The levels of a mesh of triangles, each with about half the triangles of the one before. None for lines, points,
/// small meshes and meshes that are short-lived, nor where the error would be large for the mesh's size.
///
/// Surface  meshoptimizer leaves out vertices where that displaces the surface least; it keeps the seams of
///          texture coordinates. What it reports is a root mean square and no bound.
/// Leaves   where that comes to an end and the mesh has many parts, every second part stays, enlarged so that the parts
///          cover the same area. The error bounds how far a leaf is from the next one that stays. It does not bound
///          which leaf covers a pixel: that is only measured. Not where borders are kept.
/// Error    of each level, the bound on its distance from the level before, see surface_deviation(), is added to the
///          error of that level.
/// Sides    where every triangle stands twice, once for each side, as those of leaves do, the levels are as well.
/// Cache    the corners of the levels are kept in `folder` between runs, and checked when they are read; empty for no
///          cache. `pool` has the threads to use, null for the calling thread alone; the result does not depend on it.
std::vector<MeshLevel> make_levels(const Mesh& mesh, LevelBorders borders, const std::filesystem::path& folder,
                                   ThreadPool* pool = nullptr);

}  // namespace simvis
