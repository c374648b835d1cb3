#include "import/sdf/sdf_collisions.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/sdf/sdf_geometry.h"

namespace simvis {
namespace {

using Kind = ModelCollision::Kind;

void read_geometry(const SdfElement& shape, SdfFiles& files, ImportReport& report, ModelCollision& collision) {
  if (read_sdf_solid(shape, collision)) return;
  const std::string_view tag = shape.tag();
  if (tag == "plane") {
    collision.kind = Kind::plane;
    collision.link_from_shape = collision.link_from_shape * sdf_plane_turn(shape);
  } else if (tag == "mesh") {
    read_sdf_mesh(shape, files, collision);
    if (shape.child("submesh")) report.leave_out("<submesh> of a collision, whose whole mesh counts", shape.at());
  } else if (tag == "heightmap") {
    read_sdf_height_map(shape, files, collision);
  } else {
    shape.fail(
        "does not collide, expected box, sphere, cylinder, capsule, cone, ellipsoid, plane, heightmap, polyline or "
        "mesh");
  }
}

double within(const SdfElement& element, double most) {
  const double value = element.number(0);
  if (!(value >= 0 && value <= most)) {
    element.fail("is " + format_number(value) + ", expected a number from 0 to " + format_number(most));
  }
  return value;
}

std::uint32_t read_mask(const SdfElement& element, std::uint32_t fallback) {
  if (!element) return fallback;
  if (const std::optional<std::uint32_t> mask = parse_bitmask(element.text())) return *mask;
  element.fail("is " + in_quotes(element.text()) + ", expected " + std::string(kBitmaskExpected));
}

void read_masks(const SdfElement& contact, ImportReport& report, CollisionMask& mask) {
  if (!contact) return;
  mask.collides = read_mask(contact.child("collide_bitmask"), CollisionMask::kAll);
  mask.category = read_mask(contact.child("category_bitmask"), mask.collides);
  for (const SdfElement& child : contact.children()) {
    if (child.tag() == "collide_bitmask" || child.tag() == "category_bitmask") continue;
    report.leave_out("<" + std::string(child.tag()) + "> of the <contact> of a surface", child.at());
  }
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
  read_masks(surface.child("contact"), report, collision.mask);
  if (const SdfElement soft = surface.child("soft_contact")) report.leave_out("<soft_contact> of a surface", soft.at());
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
