// Texture coordinates of round shapes: rays give those of the mesh, in both sets.
#include <doctest/doctest.h>

#include <cmath>

#include "engine/draw/round_mesh.h"
#include "engine/raycast/ray_surface.h"
#include "engine/raycast/ray_triangle.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

// A vertex of 2 m is rounded to float32, and so are its coordinates; the angle of a latitude changes by 2^-24 * 2 m
// over the radius of 0.5 m.
constexpr double kSamePoint_m = 1e-6, kCoordinate = 1e-5;

TEST_CASE("a ray to a vertex of a round shape has the texture coordinates of the vertex") {
  const glm::dvec3 sensor(3, 2, 1.5);
  glm::dmat4 world_from_sensor(1);
  world_from_sensor[3] = glm::dvec4(sensor, 1);
  for (const SurfaceKind kind : {SurfaceKind::sphere, SurfaceKind::cylinder, SurfaceKind::cone, SurfaceKind::capsule}) {
    CAPTURE(static_cast<int>(kind));
    const Mesh mesh = round_mesh({.kind = kind, .radius_m = 0.5, .length_m = 1.25}, kSidesAround);
    const auto seen = see_shape(*mesh.surface, place_mesh(glm::dmat4(1), world_from_sensor), 0);
    REQUIRE(seen);
    int compared = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::dvec3 way = glm::dvec3(mesh.positions[i]) - sensor, direction = glm::normalize(way);
      const SurfaceHits hits = intersect(*seen, direction, false);
      const VertexAttributes& vertex = mesh.attributes[i];
      const bool is_side = std::abs(std::abs(vertex.normal.z) - 1) > 1e-3;
      for (unsigned h = 0; h < hits.count; ++h) {
        const SurfaceHit& hit = hits.at[h];
        const bool is_at_vertex = std::abs(hit.range_m - glm::length(way)) < kSamePoint_m;
        // Edges have two normals, and the seam and the poles have several u.
        const double u = vertex.uv[0].x, y = mesh.positions[i].y;
        if (!is_at_vertex || (hit.face == kRoundFace) != is_side || u == 0 || u == 1 || std::abs(y) < 1e-3) continue;
        for (int set = 0; set < 2; ++set) {
          const glm::dvec2 uv = shape_uv(*seen, direction, hit.range_m, hit.face, set);
          CHECK(glm::distance(uv, glm::dvec2(vertex.uv[set])) < kCoordinate);
        }
        ++compared;
      }
    }
    CHECK(compared > kSidesAround / 2);  // of a cone, those of the base that are seen
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
