// The rows of attribute tables that say how a body of one part is made, and what they mean.
#pragma once

#include <string_view>
#include <vector>

#include <simvis/element.h>
#include "elements/dynamics/world/world.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

inline constexpr AttributeSpec kBodyShapeRow{
    .name = "shape",
    .kind = AttributeKind::choice,
    .text =
        "what collides: a box, sphere, capsule or cylinder around the part's meshes, their convex hull, a hull "
        "for each connected piece that is not flat, convex pieces into which concave ones are divided, or the mesh "
        "itself; default: hull, or mesh for a static body",
    .choices = "box sphere capsule cylinder hull pieces decomposition mesh"};
inline constexpr AttributeSpec kBodyConcavityRow{
    .name = "concavity",
    .unit = "m",
    .text =
        "of a decomposition: depth of a hollow that a convex piece may fill; default: 1/50 of the diagonal of the "
        "meshes' box",
    .min = 0,
    .open_min = true};
inline constexpr AttributeSpec kBodyMassRow{.name = "mass",
                                            .unit = "kg",
                                            .text = "mass; a dynamic body has either mass or density",
                                            .min = 0,
                                            .open_min = true};
inline constexpr AttributeSpec kBodyDensityRow{
    .name = "density", .unit = "kg/m^3", .text = "density of the solid that collides", .min = 0, .open_min = true};
inline constexpr AttributeSpec kBodyInertiaRow{
    .name = "inertia",
    .kind = AttributeKind::vector,
    .unit = "kg m^2",
    .text = "moments of inertia about axes through the centre of mass, along x, y and z; default: of a solid"};
inline constexpr AttributeSpec kBodyCenterRow{.name = "center",
                                              .kind = AttributeKind::vector,
                                              .unit = "m",
                                              .text = "centre of mass in the part's frame; default: of a solid"};
inline constexpr std::string_view kFrictionName = "friction", kRestitutionName = "restitution";
inline constexpr AttributeLimits kFrictionLimits{.min = 0, .max = 1e3}, kRestitutionLimits{.min = 0, .max = 1};

inline constexpr AttributeSpec kCategoryBitmaskRow{
    .name = "category_bitmask",
    .kind = AttributeKind::integer,
    .text =
        "32 bits of what the surface is; two surfaces collide if one has a bit with which the other one collides; "
        "default: what the file says, else collide_bitmask",
    .min = 0,
    .max = CollisionMask::kAll};
inline constexpr AttributeSpec kCollideBitmaskRow{
    .name = "collide_bitmask",
    .kind = AttributeKind::integer,
    .text = "32 bits with which the surface collides, see category_bitmask; default: what the file says, else all bits",
    .min = 0,
    .max = CollisionMask::kAll};

/// The rows of the collision shape and of the mass. A table gets them by join_tables().
inline std::vector<AttributeSpec> body_rows() {
  return {kBodyShapeRow, kBodyConcavityRow, kBodyMassRow, kBodyDensityRow, kBodyInertiaRow, kBodyCenterRow};
}
/// The rows of friction, restitution and masks. A table gets them by join_tables().
std::vector<AttributeSpec> surface_rows();

struct BodyShapes {
  std::vector<CollisionShape> collision;
  std::vector<CollisionShape> solid;  ///< what has the mass
};

/// The shapes of the part at which the command stands, as `shape` says; `by_default` if it is not given. The solid is
/// what collides, but that of a decomposition, whose pieces may overlap, is the closed mesh itself.
/// What lies below z = `lowest_m` is raised to it.
/// Throws InputError: the insertion point is no part's, the part has no triangles, a hull is flat, a concavity without
/// a decomposition.
BodyShapes read_shapes(const ElementContext& context, std::string_view by_default, double lowest_m = -kNoLimit);

/// Replaces an inertia that no body has by the nearest possible one, with a warning at `where` about `whose`, such as
/// "link \"arm\"". The mass is above 0. Throws InputError: the inertia is not finite, or the scene is strict.
void correct_inertia(Scene& scene, const Location& where, const std::string& whose, MassProperties& mass);

/// The mass of a dynamic body with these shapes; its inertia is possible, see correct_inertia(). Throws InputError:
/// neither or both of mass and density, a mesh, a shape without volume.
MassProperties read_mass(const ElementContext& context, const BodyShapes& shapes);

/// The unit vector of an attribute that is a direction. Throws InputError at the attribute: it has no length.
glm::dvec3 unit_axis(const ElementContext& context, std::string_view attribute);

/// A mask that is not given has all bits; a category that is not given is that with which the surface collides.
SurfaceProperties read_surface(const AttributeValues& attributes);

}  // namespace simvis
