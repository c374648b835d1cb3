// Round shapes of part files: rays meet what the file says, not the flat sides that are drawn of it.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/infinity.h"
#include "tests/support/parts/inventor_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Ranges here are below 200 m and poses are products of few matrices: some roundings of double.
constexpr double kSomeRoundings_m = 1e-12;

double range_in(const DrawList& list, const glm::dvec3& from, const glm::dvec3& to) {
  const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
  glm::dmat4 pose(1);
  pose[3] = glm::dvec4(from, 1);
  const std::vector<glm::dvec3> directions{glm::normalize(to - from)};
  std::vector<RayHit> hits(1);
  caster->set_world(list);
  caster->cast(pose, directions, hits);
  return hits[0].range_m;
}

// The range to a part file that stands in the world's origin.
double range_in(const std::string& name, const std::string& text, const glm::dvec3& from, const glm::dvec3& to) {
  TemporaryFolder folder;
  write_text(folder / name, text);
  const BuiltScene built =
      build_scene(parse_commands("<part file='" + name + "' name='P' insert_at='ROOT'/>", "s.xml", folder.path()));
  Flattener flattener(built.scene.root());
  return range_in(flattener.update(), from, to);
}

// Along +x at the height z, 3 degrees beside a corner of the polygon.
const glm::dvec3 kBeside(std::cos(glm::radians(3.0)), std::sin(glm::radians(3.0)), 0);

double range_beside(const std::string& name, const std::string& text) {
  return range_in(name, text, 4.0 * kBeside, {});
}

std::string mjcf(const std::string& geom) { return "<mujoco><worldbody><geom " + geom + "/></worldbody></mujoco>"; }
std::string sdf(const std::string& shape) {
  return "<sdf version='1.9'><model name='m'><link name='l'><visual name='v'><geometry>" + shape +
         "</geometry></visual></link></model></sdf>";
}
std::string urdf(const std::string& shape) {
  return "<robot name='r'><link name='l'><visual><geometry>" + shape + "</geometry></visual></link></robot>";
}

}  // namespace

// The middle of a flat side is 0.14 % of the radius inside.
TEST_CASE("spheres, cylinders and capsules of URDF, SDF and MJCF are round") {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"s.urdf", urdf("<sphere radius='0.5'/>")},
      {"c.urdf", urdf("<cylinder radius='0.5' length='1'/>")},
      {"s.sdf", sdf("<sphere><radius>0.5</radius></sphere>")},
      {"c.sdf", sdf("<cylinder><radius>0.5</radius><length>1</length></cylinder>")},
      {"p.sdf", sdf("<capsule><radius>0.5</radius><length>1</length></capsule>")},
      {"o.sdf", sdf("<cone><radius>1</radius><length>1</length></cone>")},  // of half the radius at half the height
      {"s.xml", mjcf("size='0.5'")},
      {"c.xml", mjcf("type='cylinder' size='0.5 1'")},
      {"p.xml", mjcf("type='capsule' size='0.5 1'")}};
  for (const auto& [name, text] : files) {
    CAPTURE(text);
    CHECK(std::abs(range_beside(name, text) - 3.5) <= kSomeRoundings_m);
  }
}

// x = a cos, y = b sin at the ray from the middle: 1 / r^2 = (cos / a)^2 + (sin / b)^2.
TEST_CASE("ellipsoids of SDF and MJCF are exact") {
  const double radius_m = 1 / std::hypot(kBeside.x / 0.5, kBeside.y / 2.0);
  CHECK(std::abs(range_beside("e.sdf", sdf("<ellipsoid><radii>0.5 2 1</radii></ellipsoid>")) - (4 - radius_m)) <=
        kSomeRoundings_m);
  CHECK(std::abs(range_beside("e.xml", mjcf("type='ellipsoid' size='0.5 2 1'")) - (4 - radius_m)) <= kSomeRoundings_m);
}

// The drawn part ends 50 m away.
TEST_CASE("a plane of MJCF has no end along each axis whose size is 0") {
  const glm::dvec3 from(0, 0, 1);
  CHECK(std::abs(range_in("p.xml", mjcf("type='plane' size='0 0 1'"), from, {150, 0, 0}) - std::hypot(150, 1)) <=
        kSomeRoundings_m);
  const std::string strip = mjcf("type='plane' size='0 2 1'");
  CHECK(std::abs(range_in("s.xml", strip, from, {150, 0, 0}) - std::hypot(150, 1)) <= kSomeRoundings_m);
  CHECK(std::abs(range_in("s.xml", strip, from, {150, 1.9, 0}) - std::hypot(150, 1.9, 1)) <= kSomeRoundings_m);
  CHECK(range_in("s.xml", strip, from, {150, 2.1, 0}) == kInfinity);
  CHECK(range_in("f.xml", mjcf("type='plane' size='60 60 1'"), from, {150, 0, 0}) == kInfinity);
}

TEST_CASE("spheres, cylinders and cones of Inventor and VRML are round, about y") {
  if (!has_coin()) return;
  InventorFiles files;
  const auto range_of = [&](const LoadedPart& part, const glm::dvec3& from) { return range_in(part.list, from, {}); };
  const auto about_y = [](double deg) {
    return glm::dvec3(std::sin(glm::radians(deg)), 0, std::cos(glm::radians(deg)));
  };
  for (double deg = 0; deg < 20; deg += 0.7) {
    const glm::dvec3 from = 4.0 * about_y(deg);
    CAPTURE(deg);
    CHECK(std::abs(range_of(files.iv("Sphere { radius 0.5 }"), from) - 3.5) <= kSomeRoundings_m);
    CHECK(std::abs(range_of(files.iv("Cylinder { radius 0.5 height 1 }"), from) - 3.5) <= kSomeRoundings_m);
    CHECK(std::abs(range_of(files.iv("Cone { bottomRadius 1 height 1 }"), from) - 3.5) <= kSomeRoundings_m);
    CHECK(std::abs(range_of(files.vrml("Shape { geometry Sphere { radius 0.5 } }"), from) - 3.5) <= kSomeRoundings_m);
    CHECK(std::abs(range_of(files.vrml("Shape { geometry Cylinder { radius 0.5 height 1 } }"), from) - 3.5) <=
          kSomeRoundings_m);
    CHECK(std::abs(range_of(files.vrml("Shape { geometry Cone { bottomRadius 1 height 1 } }"), from) - 3.5) <=
          kSomeRoundings_m);
  }
}

TEST_CASE("a tube of Inventor stays open, and the mesh of a shape deviates by what it says") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart tube = files.iv("Cylinder { parts SIDES radius 0.5 height 1 }");
  CHECK(!mesh_of(tube, 0).surface);
  CHECK(range_in(tube.list, {0.1, 4, 0}, {0.1, -4, 0}) == kInfinity);
  for (const std::string shape : {"Sphere { radius 2 }", "Cylinder { radius 2 height 1 }"}) {
    const LoadedPart part = files.iv(shape);
    const Mesh& mesh = mesh_of(part, 0);
    REQUIRE(mesh.surface.has_value());
    CHECK(mesh.surface->axis == 1);
    CHECK(mesh.surface->deviation_m > 0);
    CHECK(mesh.surface->deviation_m < 0.1);
    std::size_t sides = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      glm::dvec3 middle(0);
      double high = -kInfinity, low = kInfinity;
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 corner(mesh.positions[mesh.indices[i + k]]);
        middle += corner / 3.0;
        high = std::max(high, corner.y);
        low = std::min(low, corner.y);
      }
      const bool is_sphere = mesh.surface->kind == SurfaceKind::sphere;
      if (!is_sphere && high == low) continue;  // of an end
      const double out = is_sphere ? glm::length(middle) : std::hypot(middle.x, middle.z);
      CHECK(2 - out <= mesh.surface->deviation_m);
      ++sides;
    }
    CHECK(sides > 20);
  }
}
