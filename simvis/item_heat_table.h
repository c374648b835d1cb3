// The heat of the items of a draw list, for thermal cameras.
#pragma once

#include <cstdint>
#include <vector>

#include <simvis/scene.h>
#include <simvis/sensor_needs.h>
#include "elements/temperature.h"
#include "scenegraph/flattener.h"

namespace simvis {

/// The table of one flattener.
class ItemHeatTable {
 public:
  /// Follows the flattener's update(). Items are compared with selections only if a traversal has taken place since the
  /// last call; otherwise only the numbers of the elements are read.
  void update(const Scene& scene, const Flattener& flattener);

  /// By item of the last update(). Valid until the next one.
  SensedHeat heat() const { return {selection_, surfaces_, surroundings_}; }

 private:
  std::uint64_t rebuilds_ = 0;                   // of the flattener, at the last update()
  std::vector<const SelectedHeat*> elements_;    // as long as the graph is not changed
  const ThermalSurroundings* around_ = nullptr;  // the same; null: there is no such element
  std::vector<std::uint32_t> selection_;         // by item, in surfaces_
  std::vector<SurfaceHeat> surfaces_;
  ThermalSurroundings surroundings_;
};

}  // namespace simvis
