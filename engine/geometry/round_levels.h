// Which mesh of a round shape a view draws: as coarse as its picture allows.
//
// A round shape has meshes of several numbers of sides, see engine/draw/round_mesh.h. A view draws the coarsest one
// whose distance from the shape appears smaller than a limit, or the finest one if none does. The choice depends on the
// view and on the item alone, so that no result depends on other views, on earlier frames or on the number of threads.
// The bound of a depth image comes from the same choice.
#pragma once

#include <array>
#include <cstddef>

#include <simvis/mesh.h>
#include "engine/geometry/projected_error.h"

namespace simvis {

/// The numbers of sides, coarse to fine: each mesh of a sphere has about twice the triangles of the one before.
inline constexpr std::array kRoundSides{8, 12, 16, 24, 32, 44, 60, 88, 120, 176, 240};

/// The limit in pixels of a view without View::max_error_px.
inline constexpr double kRoundError_px = 0.1;

/// The limit in pixels of a view.
inline double round_limit_px(const View& view) { return view.max_error_px > 0 ? view.max_error_px : kRoundError_px; }

/// Whether a mesh stands for a closed round shape, and so has levels.
inline bool has_round_levels(const Mesh& mesh) {
  return mesh.topology == Topology::triangles && mesh.surface && mesh.surface->kind != SurfaceKind::plane;
}

/// The number of levels: spheres and capsules, whose triangles grow with the square of the sides, have fewer. They are
/// the first entries of kRoundSides.
std::size_t round_levels_of(const ExactSurface& shape);

/// A level, with bounds on the distance of its mesh from the shape.
struct RoundLevel {
  std::size_t number = 0;  ///< in kRoundSides
  double error_m = 0;      ///< in the world
  double error_px = 0;     ///< in the view; infinite where the shape may reach the near plane
};

/// The level that a view draws. `error` is that of the item in the view.
RoundLevel choose_round_level(const ExactSurface& shape, const ProjectedError& error, double limit_px);

}  // namespace simvis
