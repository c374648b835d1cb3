#include "simvis/selected_items.h"

#include <map>
#include <string>
#include <string_view>

namespace simvis {
namespace {

// The selections of an insertion point, without a material and by material.
struct PointSelections {
  std::uint32_t all = 0;
  std::map<std::string, std::uint32_t, std::less<>> of_material;
};

}  // namespace

std::vector<std::uint32_t> selections_of_items(std::span<const ShapeSelection* const> selections,
                                               std::span<const ItemSource> sources) {
  std::map<std::string_view, PointSelections> by_point;
  for (std::uint32_t i = 0; i < selections.size(); ++i) {
    for (const std::string& point : selections[i]->points) {
      PointSelections& of_point = by_point[point];
      if (selections[i]->materials.empty()) of_point.all = i + 1;
      for (const std::string& material : selections[i]->materials) of_point.of_material[material] = i + 1;
    }
  }
  std::vector<std::uint32_t> found(sources.size());
  for (std::size_t item = 0; item < sources.size(); ++item) {
    const ItemSource& source = sources[item];
    const auto of_point = source.point == nullptr ? by_point.end() : by_point.find(source.point->name);
    if (of_point == by_point.end()) continue;
    found[item] = of_point->second.all;
    if (source.material == nullptr) continue;
    const auto of_material = of_point->second.of_material.find(source.material->name);
    if (of_material != of_point->second.of_material.end()) found[item] = of_material->second;
  }
  return found;
}

}  // namespace simvis
