#include "simvis/item_id_table.h"

#include <set>
#include <unordered_map>

#include "elements/label.h"
#include "engine/base/fnv1a.h"
#include "simvis/selected_items.h"

namespace simvis {
namespace {

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
  const std::vector<const Label*> labels = labels_of(scene);
  std::vector<const ShapeSelection*> selections;
  for (const Label* const label : labels) {
    class_names_[label->class_id] = label->class_name;
    selections.push_back(&label->shapes);
  }
  classes_.clear();
  for (const std::uint32_t selection : selections_of_items(selections, flattener)) {
    classes_.push_back(selection == 0 ? 0 : labels[selection - 1]->class_id);
  }
}

const std::string& ItemIdTable::class_name(std::uint32_t item) const {
  static const std::string kNone;
  const auto found = class_names_.find(classes_[item]);
  return found == class_names_.end() ? kNone : found->second;
}

}  // namespace simvis
