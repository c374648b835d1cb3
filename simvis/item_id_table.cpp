#include "simvis/item_id_table.h"

#include <set>
#include <unordered_map>

#include "elements/label.h"
#include "engine/base/fnv1a.h"

namespace simvis {
namespace {

// The label of each insertion point, without a material and by material.
struct PointLabels {
  const Label* all = nullptr;
  std::map<std::string, const Label*, std::less<>> of_material;
};

std::uint32_t hash_of(const std::string& point, std::uint32_t number) {
  const std::uint64_t hash = fnv1a_step(fnv1a(point), number);
  return static_cast<std::uint32_t>(hash ^ hash >> 32);
}

}  // namespace

void ItemIdTable::update(const Scene& scene, const Flattener& flattener) {
  if (rebuilds_ == flattener.counters().rebuilds) return;
  rebuilds_ = flattener.counters().rebuilds;
  name_instances(flattener);
  name_classes(scene, flattener);
}

void ItemIdTable::name_instances(const Flattener& flattener) {
  std::unordered_map<const InsertionPoint*, std::uint32_t> count;
  std::vector<Key> keys;
  std::set<Key> unknown;
  for (const ItemSource& source : flattener.item_sources()) {
    Key key{source.point == nullptr ? "" : source.point->name, count[source.point]++};
    if (!id_of_.contains(key)) unknown.insert(key);
    keys.push_back(std::move(key));
  }
  for (const Key& key : unknown) {
    std::uint32_t id = hash_of(key.first, key.second);
    while (id == 0 || !taken_.insert(id).second) ++id;
    id_of_.emplace(key, id);
  }
  instances_.clear();
  for (const Key& key : keys) instances_.push_back(id_of_.at(key));
}

void ItemIdTable::name_classes(const Scene& scene, const Flattener& flattener) {
  class_names_.clear();
  std::map<std::string_view, PointLabels> labels;
  for (const Label* const label : labels_of(scene)) {
    class_names_[label->class_id] = label->class_name;
    for (const std::string& point : label->points) {
      PointLabels& of_point = labels[point];
      if (label->materials.empty()) of_point.all = label;
      for (const std::string& material : label->materials) of_point.of_material[material] = label;
    }
  }
  classes_.clear();
  for (const ItemSource& source : flattener.item_sources()) {
    const auto of_point = source.point == nullptr ? labels.end() : labels.find(source.point->name);
    const Label* label = nullptr;
    if (of_point != labels.end()) {
      label = of_point->second.all;
      const auto of_material = source.material == nullptr ? of_point->second.of_material.end()
                                                          : of_point->second.of_material.find(source.material->name);
      if (of_material != of_point->second.of_material.end()) label = of_material->second;
    }
    classes_.push_back(label == nullptr ? 0 : label->class_id);
  }
}

const std::string& ItemIdTable::class_name(std::uint32_t item) const {
  static const std::string kNone;
  const auto found = class_names_.find(classes_[item]);
  return found == class_names_.end() ? kNone : found->second;
}

}  // namespace simvis
