#include "tests/support/random_room.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include "tests/support/reference_directions.h"

namespace simvis {

double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

glm::dmat4 random_turn(std::mt19937& random) {
  const glm::dvec3 axis(between(random, -1, 1), between(random, -1, 1), between(random, 0.1, 1));
  return glm::rotate(glm::dmat4(1.0), between(random, -3, 3), glm::normalize(axis));
}

void add_item(DrawList& list, Mesh mesh, const glm::dmat4& world_from_mesh) {
  if (list.world_from_node.empty()) list.world_from_node.push_back(glm::dmat4(1.0));
  if (list.materials.empty()) {
    list.materials.push_back(std::make_shared<Material>());
    list.material_revision.push_back(0);
  }
  mesh.attributes.resize(mesh.positions.size());
  compute_bounds(mesh);
  list.items.push_back(
      {static_cast<std::uint32_t>(list.meshes.size()), 0, static_cast<std::uint32_t>(list.world_from_node.size())});
  list.meshes.push_back(std::make_shared<Mesh>(std::move(mesh)));
  list.world_from_node.push_back(world_from_mesh);
  ++list.revisions.structure;
}

Mesh half_box_mesh(const glm::vec3& half_size) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back(half_size * glm::vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  }
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

Mesh sphere_mesh(double radius_m, int segments) {
  Mesh mesh;
  const int rows = segments / 2;
  for (int r = 0; r <= rows; ++r) {
    for (int s = 0; s <= segments; ++s) {
      const double e = kPi * r / rows - kPi / 2, a = 2 * kPi * (s % segments) / segments;
      mesh.positions.push_back(radius_m * reference::beam_direction(a, e));
      if (r == rows || s == segments) continue;
      const auto i = static_cast<std::uint32_t>(r * (segments + 1) + s), above = i + segments + 1;
      mesh.indices.insert(mesh.indices.end(), {i, i + 1, above, i + 1, above + 1, above});
    }
  }
  return mesh;
}

DrawList random_room(std::uint32_t seed, int primitives, int sphere_segments) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) { return simvis::between(random, low, high); };
  DrawList list;
  add_item(list, half_box_mesh({5, 4, 1.5}), glm::translate(glm::dmat4(1.0), {0, 0, 1.5}));
  for (int primitive = 0; primitive < primitives; ++primitive) {
    glm::dvec3 place;
    do {
      place = {between(-4.5, 4.5), between(-3.5, 3.5), between(0.2, 2.5)};
    } while (std::hypot(place.x, place.y) < 1);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(between(-1, 1), between(-1, 1), between(0.1, 1)));
    const glm::dmat4 pose = glm::rotate(glm::translate(glm::dmat4(1.0), place), between(0, 6), axis);
    if (primitive % 2) {
      add_item(list, half_box_mesh({between(0.05, 0.3), between(0.05, 0.3), between(0.05, 0.3)}), pose);
    } else {
      add_item(list, sphere_mesh(between(0.1, 0.4), sphere_segments), pose);
    }
  }
  return list;
}

}  // namespace simvis
