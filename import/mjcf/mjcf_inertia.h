// The shapes of MJCF geoms as solids and as surfaces that collide.
#pragma once

#include <optional>

#include "import/mjcf/mjcf_assets.h"
#include "import/mjcf/mjcf_tree.h"
#include "import/model/model_description.h"

namespace simvis {

/// <inertial>: empty where the geoms count, by <compiler inertiafromgeom>. Throws InputError for a mass or moments that
/// are negative, and for an orientation without length.
std::optional<ModelInertial> read_mjcf_inertial(const MjcfBody& body);

/// <compiler> boundmass, boundinertia and balanceinertia, for this body. Empty if they change nothing. Throws
/// InputError for a balanceinertia that is neither true nor false.
std::optional<ModelMassBounds> read_mjcf_mass_bounds(const MjcfBody& body);

class MjcfShapes {
 public:
  MjcfShapes(const MjcfModel& model, MjcfAssets& assets, ImportReport& report);

  /// A geom that cannot be read, or is of another type, is left out with a warning. Throws InputError for a mass or
  /// density below 0.
  void add_solid(const MjcfGeom& geom, ModelLink& link);
  void add_collision(const MjcfGeom& geom, ModelLink& link);

 private:
  bool read_shape(const MjcfGeom& geom, ModelShape& shape);

  MjcfAssets& assets_;
  ImportReport& report_;
  double first_group_ = 0, last_group_ = 5;  // of geoms that have mass
};

}  // namespace simvis
