// The collisions of SDF links.
#pragma once

#include <optional>
#include <string>

#include "import/model/import_report.h"
#include "import/model/model_description.h"
#include "import/sdf/sdf_element.h"
#include "import/sdf/sdf_reader.h"

namespace simvis {

/// The geometry and the surface of a <collision>; `link_from_collision` is its place. A cone, an ellipsoid, a polyline
/// and a heightmap are surfaces, of the meshes that visuals have; a plane has no end, whatever its size. Empty: it has
/// no geometry, which is reported, or is <empty>.
///
/// Surface  friction is <mu> of ODE, else <friction> of Bullet, and at most kMaxSdfFriction, which holds any robot;
///          restitution is <restitution_coefficient>. The rest of <surface> is reported as left out.
/// Throws   InputError for wrong numbers, missing files and an unknown geometry.
std::optional<ModelCollision> read_sdf_collision(const SdfElement& collision, const glm::dmat4& link_from_collision,
                                                 SdfFiles& files, ImportReport& report);
inline constexpr double kMaxSdfFriction = 1000;

}  // namespace simvis
