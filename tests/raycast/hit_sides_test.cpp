// Rays that pass the backs of single-sided surfaces. The reference is a cast into the same list without the triangles
// whose backs face the sensor, which the test finds in long double.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>
#include "scenegraph/height_map.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/infinity.h"
#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

using Real = long double;
using Vector = glm::vec<3, Real>;

std::vector<RayHit> cast_sides(const RayEngine& engine, const DrawList& list, const glm::dmat4& pose,
                               const std::vector<glm::dvec3>& directions, HitSides sides,
                               const std::vector<double>& t_min_m = {}) {
  std::vector<RayHit> hits(directions.size());
  engine.caster->set_world(list);
  engine.caster->cast(pose, directions, hits, t_min_m, {}, sides);
  return hits;
}

/// Whether the sensor sees the back of a triangle, from the signed volume of both.
bool shows_back(const DrawList& list, const DrawItem& item, std::size_t triangle, const glm::dmat4& pose) {
  const Mesh& mesh = *list.meshes[item.mesh];
  const glm::mat<4, 4, Real> world(list.world_from_node[item.transform]);
  const glm::mat<3, 3, Real> linear(world);
  const auto corner = [&](std::size_t k) {
    const Vector in_mesh(mesh.positions[mesh.indices[3 * triangle + k]]);
    return linear * in_mesh + (Vector(world[3]) - Vector(glm::dvec3(pose[3])));
  };
  const Vector a = corner(0), normal = glm::cross(corner(1) - a, corner(2) - a);
  return (glm::dot(normal, a) > 0) != (glm::determinant(linear) < 0);
}

/// The list without the single-sided triangles whose backs the sensor sees: their corners become one.
DrawList without_backs(DrawList list, const glm::dmat4& pose, std::size_t& removed) {
  for (DrawItem& item : list.items) {
    if (list.materials[item.material]->double_sided) continue;
    auto fronts = std::make_shared<Mesh>(*list.meshes[item.mesh]);
    for (std::size_t i = 0; i < fronts->indices.size() / 3; ++i) {
      if (!shows_back(list, item, i, pose)) continue;
      fronts->indices[3 * i + 1] = fronts->indices[3 * i + 2] = fronts->indices[3 * i];
      ++removed;
    }
    item.mesh = static_cast<std::uint32_t>(list.meshes.size());
    list.meshes.push_back(std::move(fronts));
  }
  return list;
}

std::uint32_t add_material(DrawList& list, Material material) {
  list.materials.push_back(std::make_shared<Material>(std::move(material)));
  list.material_revision.push_back(0);
  return static_cast<std::uint32_t>(list.materials.size() - 1);
}

Material sided(bool double_sided) {
  Material material;
  material.double_sided = double_sided;
  return material;
}

constexpr float kApart[] = {0, 0, 1, -1};  // of two faces, in units in the last place of their depth

/// Triangles of which each lies on another one, from another corner on and the same way round or the other; some pairs
/// are one unit in the last place apart.
Mesh pairs_of_triangles(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<float> unit(-1, 1);
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 middle(unit(random), unit(random), unit(random));
    glm::vec3 corners[3];
    for (glm::vec3& corner : corners) corner = middle + 0.4f * glm::vec3(unit(random), unit(random), unit(random));
    const bool around = random() % 2 == 0;
    const std::size_t first = random() % 3;
    const float apart = kApart[random() % std::size(kApart)];
    for (const bool other : {false, true}) {
      for (std::size_t k = 0; k < 3; ++k) {
        glm::vec3 at = corners[other ? (first + (around ? 3 - k : k)) % 3 : k];
        if (other && apart != 0) at.x = std::nextafter(at.x, apart * std::numeric_limits<float>::infinity());
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        mesh.positions.push_back(at);
      }
    }
  }
  return mesh;
}

/// Adds the first triangles of all pairs as one item and the second ones as another, in this order or the other.
void add_pairs(DrawList& list, const Mesh& pairs, const glm::dmat4& pose, bool reversed, std::uint32_t material) {
  for (const std::size_t half : {std::size_t{reversed ? 1u : 0u}, std::size_t{reversed ? 0u : 1u}}) {
    Mesh mesh;
    mesh.positions = pairs.positions;
    for (std::size_t i = half; i < pairs.indices.size() / 3; i += 2) {
      for (std::size_t k = 0; k < 3; ++k) mesh.indices.push_back(pairs.indices[3 * i + k]);
    }
    add_item(list, mesh, pose);
    list.items.back().material = material;
  }
}

/// Directions into the list, and bundles that are so narrow that their rays form packets.
std::vector<glm::dvec3> directions_and_bundles(const DrawList& list, const glm::dmat4& pose, std::mt19937& random) {
  constexpr std::size_t kWide = 2000, kBundles = 60, kRays = 32;
  constexpr double kNarrow = 1e-3;
  std::vector<glm::dvec3> directions = directions_into(list, pose, kWide, random);
  std::uniform_real_distribution<double> unit(-kNarrow, kNarrow);
  for (std::size_t i = 0; i < kBundles; ++i) {
    const glm::dvec3 middle = directions[random() % kWide];
    for (std::size_t k = 0; k < kRays; ++k) {
      directions.push_back(glm::normalize(middle + glm::dvec3(unit(random), unit(random), unit(random))));
    }
  }
  return directions;
}

TEST_CASE("rays pass the backs of single-sided triangles, and meet fronts that coincide with them") {
  const RayEngine engine = each_engine();
  std::mt19937 random(31);
  const glm::dvec3 scales[] = {{1, 1, 1}, {-1, 1, 1}, {1, 2, 0.3}, {-2, -2, -2}};
  std::size_t removed = 0, on_pairs = 0, wrong_ranges = 0, backs = 0, changed = 0;
  for (int world = 0; world < 24; ++world) {
    DrawList list;
    add_item(list, half_box_mesh({20, 20, 20}), at(0, 0, 0));  // seen from inside: its backs
    const std::uint32_t materials[] = {add_material(list, sided(false)), add_material(list, sided(true)),
                                       add_material(list, *leaves(random))};
    for (int i = 0; i < 6; ++i) {
      glm::dmat4 place = at(0, 0, 0) * random_pose(random, 2);
      place = glm::scale(place, scales[random() % std::size(scales)]);
      const std::uint32_t material = materials[random() % std::size(materials)];
      const Mesh pairs = pairs_of_triangles(random, 1 + random() % 12);
      if (i % 2 == 0) {
        add_item(list, pairs, place);
        list.items.back().material = material;
      } else {
        add_pairs(list, pairs, place, random() % 2 == 0, material);
      }
    }
    list.items.front().material = materials[world % 2];
    const glm::dmat4 pose = random_pose(random, 1);
    const std::vector<glm::dvec3> directions = directions_and_bundles(list, pose, random);
    std::vector<double> behind_m;
    for (std::size_t i = 0; i < directions.size() && world % 3 == 0; ++i) behind_m.push_back(i % 2 == 0 ? 0 : 0.5);
    const DrawList fronts = without_backs(list, pose, removed);
    const auto expected = cast_sides(engine, fronts, pose, directions, HitSides::both, behind_m),
               of_both = cast_sides(engine, list, pose, directions, HitSides::both, behind_m),
               found = cast_sides(engine, list, pose, directions, HitSides::front, behind_m);
    for (std::size_t i = 0; i < found.size(); ++i) {
      wrong_ranges += found[i].range_m != expected[i].range_m;
      changed += found[i].range_m != of_both[i].range_m;
      if (std::isinf(found[i].range_m)) continue;
      on_pairs += found[i].range_m == of_both[i].range_m && found[i] != of_both[i];
      const DrawItem& item = list.items[found[i].item];
      const bool passes = !list.materials[item.material]->double_sided;
      backs += passes && shows_back(list, item, found[i].primitive, pose);
    }
  }
  CHECK(wrong_ranges == 0);
  CHECK(backs == 0);
  CHECK(removed > 300);
  CHECK(changed > 1000);
  CHECK(on_pairs > 100);  // a back is hit first, at the same range
}

// A disc or a ball at the origin, as the one point of a cloud.
Mesh one_point(SurfaceKind kind) {
  Mesh mesh;
  mesh.topology = Topology::points;
  mesh.surface = ExactSurface{.kind = kind, .radius_m = 1};
  mesh.positions = {{0, 0, 0}};
  mesh.attributes = {{.normal = {0, 0, 1}}};
  mesh.indices = {0};
  return mesh;
}

Mesh flat_grid() {
  constexpr std::uint32_t kCells = 512;
  const HeightPicture flat{kCells + 1, kCells + 1, std::vector<float>(std::size_t{kCells + 1} * (kCells + 1), 0.5f)};
  return height_map(flat, {2, 2}, -1, 1).mesh;
}

TEST_CASE("shapes, clouds and grids that are single-sided show their fronts alone") {
  struct Shape {
    const char* name;
    Mesh mesh;
    double top_m;  // where a ray down the axis z meets it
    bool is_closed, has_back;
  };
  const Shape shapes[] = {
      {"sphere", sphere_mesh(1), 1, true, true},
      {"cylinder", cylinder_mesh(1, 1), 0.5, true, true},
      {"cone", cone_mesh(1, 2), 1, true, true},
      {"capsule", capsule_mesh(1, 1), 1.5, true, true},
      {"plane", plane_mesh({2, 2}), 0, false, true},
      {"plane without end", endless_plane_mesh(glm::dvec2(kInfinity)), 0, false, true},
      {"ball of a cloud", one_point(SurfaceKind::sphere), 1, true, true},
      {"disc of a cloud", one_point(SurfaceKind::disc), 0, false, false},
      {"grid of heights", flat_grid(), 1, false, true},
  };
  const RayEngine engine = each_engine();
  constexpr double kFar_m = 3;
  for (const Shape& shape : shapes) {
    for (const bool mirrored : {false, true}) {
      for (const bool double_sided : {false, true}) {
        CAPTURE(shape.name);
        CAPTURE(mirrored);
        CAPTURE(double_sided);
        DrawList list;
        const std::uint32_t material = add_material(list, sided(double_sided));
        add_item(list, shape.mesh, glm::scale(glm::dmat4(1), glm::dvec3(mirrored ? -1 : 1, 1, 1)));
        list.items.back().material = material;
        const auto range_m = [&](double z_m, double way, HitSides sides) {
          // Beside the axis, where triangles meet.
          const glm::dmat4 pose = at(0.001, 0.002, z_m);
          return cast_sides(engine, list, pose, {{0, 0, way}}, sides).front().range_m;
        };
        // The cone is twice as high as its radius, so that a ray beside its axis hits it twice as much lower.
        constexpr double kLower_m = 2 * 0.00224;
        const auto is_at = [](double expected_m) {
          return doctest::Approx(expected_m).scale(0).epsilon(kLower_m / expected_m);
        };
        CHECK(range_m(kFar_m, -1, HitSides::front) == is_at(kFar_m - shape.top_m));
        const double behind_m = shape.is_closed ? 0 : -kFar_m;
        const bool is_seen = double_sided || !shape.has_back;
        CHECK(range_m(behind_m, 1, HitSides::both) == is_at(shape.top_m - behind_m));
        const double seen_m = range_m(behind_m, 1, HitSides::front);
        CHECK((is_seen ? seen_m == is_at(shape.top_m - behind_m) : std::isinf(seen_m)));
      }
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
