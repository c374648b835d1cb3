// Mass, centre of mass and inertia of solid shapes.
#pragma once

#include <span>

#include "elements/dynamics/world/world.h"

namespace simvis {

/// The properties of a solid of this density. Overlapping shapes count twice; a mesh or a plane has no volume and
/// counts nothing.
MassProperties mass_of(std::span<const CollisionShape> shapes, double density_kg_m3);

/// Both together.
MassProperties sum_of(const MassProperties& a, const MassProperties& b);

/// The properties in a frame in which the body's frame stands at `parent_from_body`, rigid.
MassProperties moved(const MassProperties& mass, const glm::dmat4& parent_from_body);

/// The same solid with another mass.
MassProperties with_mass(const MassProperties& mass, double mass_kg);

/// An inertia tensor along its own axes: inertia = axes * diagonal * transpose(axes); `axes` is a rotation. A tensor
/// that is diagonal already keeps its axes.
struct PrincipalInertia {
  glm::dmat3 axes{1.0};
  glm::dvec3 diagonal_kg_m2{0};
};
PrincipalInertia principal_inertia(const glm::dmat3& inertia_kg_m2);
glm::dmat3 inertia_of(const PrincipalInertia& inertia);

/// Whether a body can have this inertia: its moments are above 0, and none is above the sum of the two others.
bool is_possible(const PrincipalInertia& inertia);

/// The possible inertia that is nearest to a finite one by the Frobenius norm, along the same axes. Where that one has
/// a moment of almost 0, as that of a thin rod or a point, a ball of 1 mm radius and `mass_kg` is added.
PrincipalInertia nearest_possible(const PrincipalInertia& inertia, double mass_kg);

}  // namespace simvis
