#include "simvis/selected_items.h"

#include <map>
#include <string>
#include <string_view>

namespace simvis {
namespace {

// By material; the empty name: any.
using OfMaterials = std::map<std::string, std::uint32_t, std::less<>>;
// The selections of an insertion point, by name of shapes; the empty name: any.
using OfNames = std::map<std::string, OfMaterials, std::less<>>;

const SelectedNames& or_any(const SelectedNames& names) {
  static const SelectedNames kAny{""};
  return names.empty() ? kAny : names;
}

// 0: none
std::uint32_t selection_of(const OfNames& selections, std::string_view name, std::string_view material) {
  const auto of_name = selections.find(name);
  if (of_name == selections.end()) return 0;
  for (const std::string_view each : {material, std::string_view()}) {
    const auto found = of_name->second.find(each);
    if (found != of_name->second.end()) return found->second;
  }
  return 0;
}

}  // namespace

std::vector<SelectedItem> selections_of_items(std::span<const ShapeSelection* const> selections,
                                              const Flattener& flattener) {
  std::map<std::string_view, OfNames> by_point;
  bool has_names = false;
  for (std::uint32_t i = 0; i < selections.size(); ++i) {
    const ShapeSelection& selection = *selections[i];
    has_names = has_names || !selection.names.empty();
    for (const auto& [point, object] : selection.points) {
      for (const std::string& name : or_any(selection.names)) {
        for (const std::string& material : or_any(selection.materials)) by_point[point][name][material] = i + 1;
      }
    }
  }
  std::vector<SelectedItem> found;
  for (const ItemSource& source : flattener.item_sources()) {
    found.emplace_back();
    const auto of_point = source.point == nullptr ? by_point.end() : by_point.find(source.point->name);
    if (of_point == by_point.end()) continue;
    const std::string_view material = source.material == nullptr ? std::string_view() : source.material->name;
    std::vector<ShapeName> names;
    if (has_names) names = flattener.names_of(source);
    names.emplace_back();
    for (auto name = names.begin(); found.back().selection == 0 && name != names.end(); ++name) {
      found.back() = {selection_of(of_point->second, name->name, material), *name};
    }
  }
  return found;
}

}  // namespace simvis
