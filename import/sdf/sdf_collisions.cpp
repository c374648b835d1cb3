#include "import/sdf/sdf_collisions.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/sdf/sdf_geometry.h"
#include "import/sdf/sdf_polyline.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

using Kind = ModelCollision::Kind;

std::shared_ptr<const Mesh> shared(Mesh mesh) { return std::make_shared<const Mesh>(std::move(mesh)); }

Mesh scaled(Mesh mesh, const glm::dvec3& scale) {
  for (glm::vec3& position : mesh.positions) position *= glm::vec3(scale);
  return mesh;
}

void read_mesh(const SdfElement& mesh, SdfFiles& files, ImportReport& report, ModelCollision& collision) {
  collision.kind = Kind::mesh;
  collision.size = mesh.child("scale").vector(glm::dvec3(1));
  if (mesh.child("submesh")) report.leave_out("<submesh> of a collision, whose whole mesh counts", mesh.at());
  std::string why;
  const auto file = files.find(mesh.child("uri") ? mesh.child("uri").text() : "", mesh, why);
  if (!file) mesh.fail("names a file that is not there: " + why);
  collision.file = *file;
}

void read_geometry(const SdfElement& shape, SdfFiles& files, ImportReport& report, ModelCollision& collision) {
  const std::string_view tag = shape.tag();
  if (tag == "box") {
    collision.size = sdf_sizes(shape, "size", glm::dvec3(1));
  } else if (tag == "sphere") {
    collision.kind = Kind::sphere;
    collision.size.x = sdf_size(shape, "radius", 1);
  } else if (tag == "cylinder") {
    collision.kind = Kind::cylinder;
    collision.size = {sdf_size(shape, "radius", 1), 0, sdf_size(shape, "length", 1)};
  } else if (tag == "capsule") {
    collision.kind = Kind::capsule;
    collision.size = {sdf_size(shape, "radius", 0.5), 0, sdf_size(shape, "length", 1)};
  } else if (tag == "plane") {
    collision.kind = Kind::plane;
    collision.link_from_shape = collision.link_from_shape * sdf_plane_turn(shape);
  } else if (tag == "mesh") {
    read_mesh(shape, files, report, collision);
  } else {
    collision.kind = Kind::surface;
    if (tag == "cone") {
      collision.surface = shared(cone_mesh(sdf_size(shape, "radius", 0.5), sdf_size(shape, "length", 1)));
    } else if (tag == "ellipsoid") {
      collision.surface = shared(scaled(sphere_mesh(1), sdf_sizes(shape, "radii", glm::dvec3(1))));
    } else if (tag == "polyline") {
      collision.surface = shared(sdf_polyline_mesh(shape));
    } else if (tag == "heightmap") {
      glm::dmat4 place(1);
      place[3] = glm::dvec4(shape.child("pos").vector(glm::dvec3(0)), 1);
      collision.link_from_shape = collision.link_from_shape * place;
      collision.surface = shared(mesh_in_place(sdf_height_map(shape, files)));
    } else {
      shape.fail(
          "does not collide, expected box, sphere, cylinder, capsule, cone, ellipsoid, plane, heightmap, "
          "polyline or mesh");
    }
  }
}

double within(const SdfElement& element, double most) {
  const double value = element.number(0);
  if (!(value >= 0 && value <= most)) {
    element.fail("is " + format_number(value) + ", expected a number from 0 to " + format_number(most));
  }
  return value;
}

void read_surface(const SdfElement& surface, ImportReport& report, ModelCollision& collision) {
  const SdfElement friction = surface.child("friction"), ode = friction.child("ode"),
                   bullet = friction.child("bullet").child("friction"), bounce = surface.child("bounce"),
                   restitution = bounce.child("restitution_coefficient");
  const SdfElement coefficient = ode.child("mu") ? ode.child("mu") : bullet;
  // Files write 1e10 and inf for what never slips.
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (coefficient) collision.friction = std::min(within(coefficient, kAny), kMaxSdfFriction);
  if (restitution) collision.restitution = within(restitution, 1);
  const SdfElement second = ode.child("mu2");
  if (second && collision.friction && std::min(second.number(0), kMaxSdfFriction) != *collision.friction) {
    report.leave_out("second coefficient of friction, <mu2>", second.at());
  }
  for (const char* const tag : {"slip1", "slip2"}) {
    if (ode.child(tag).number(0) != 0) report.leave_out("slip of a surface", ode.child(tag).at());
  }
  if (friction.child("torsional").child("coefficient").number(0) != 0) {
    report.leave_out("torsional friction", friction.child("torsional").at());
  }
  for (const char* const tag : {"contact", "soft_contact"}) {
    if (surface.child(tag)) report.leave_out("<" + std::string(tag) + "> of a surface", surface.child(tag).at());
  }
}

}  // namespace

std::optional<ModelCollision> read_sdf_collision(const SdfElement& element, const glm::dmat4& link_from_collision,
                                                 SdfFiles& files, ImportReport& report) {
  const SdfElement geometry = element.child("geometry");
  const std::vector<SdfElement> shapes = geometry ? geometry.children() : std::vector<SdfElement>();
  if (shapes.empty()) report.leave_out("collision without geometry", element.at());
  if (shapes.empty() || shapes.front().tag() == "empty") return std::nullopt;
  ModelCollision collision;
  collision.link_from_shape = link_from_collision;
  collision.where = element.at();
  read_geometry(shapes.front(), files, report, collision);
  if (shapes.size() > 1) report.leave_out("further shape of a collision", shapes[1].at());
  if (const SdfElement surface = element.child("surface")) read_surface(surface, report, collision);
  return collision;
}

}  // namespace simvis
