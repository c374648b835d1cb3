// Closed rooms with things in them, as DrawLists: worlds for tests that compare a sensor with geometry.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <utility>

#include <simvis/draw_list.h>

namespace simvis {

double between(std::mt19937& random, double low, double high);

/// Turned by up to 3 rad either way about any axis.
glm::dmat4 random_turn(std::mt19937& random);

/// Adds triangles with a plain material; the mesh's bounds and attributes are filled in.
void add_item(DrawList& list, Mesh mesh, const glm::dmat4& world_from_mesh);

/// An axis-aligned box about the origin.
Mesh half_box_mesh(const glm::vec3& half_size);

/// A sphere about the origin, `segments` around and half as many from pole to pole.
Mesh sphere_mesh(double radius_m, int segments);

/// A room of 10 x 8 x 3 m with its floor at z = 0 and its middle at the origin, with turned boxes and spheres at
/// random places, none within half a metre of the middle.
DrawList random_room(std::uint32_t seed, int primitives, int sphere_segments);

}  // namespace simvis
