#include "simvis/item_heat_table.h"

#include "elements/thermal_surroundings.h"
#include "simvis/selected_items.h"

namespace simvis {

void ItemHeatTable::update(const Scene& scene, const Flattener& flattener) {
  if (rebuilds_ != flattener.counters().rebuilds) {
    rebuilds_ = flattener.counters().rebuilds;
    elements_ = temperatures_of(scene);
    around_ = thermal_surroundings_of(scene);
    std::vector<const ShapeSelection*> selections;
    for (const SelectedHeat* const each : elements_) selections.push_back(&each->shapes);
    selection_.clear();
    for (const SelectedItem& each : selections_of_items(selections, flattener)) selection_.push_back(each.selection);
  }
  surroundings_ = around_ == nullptr ? ThermalSurroundings{} : *around_;
  surfaces_.assign(1, {.temperature_k = surroundings_.ambient_k});
  for (const SelectedHeat* const each : elements_) surfaces_.push_back(each->heat);
}

}  // namespace simvis
