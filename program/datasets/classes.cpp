#include "program/datasets/classes.h"

#include <simvis/error.h>

namespace simvis {

Record classes_record(std::span<const SceneItem> items) {
  std::map<std::uint32_t, std::string> classes;
  for (const SceneItem& item : items) {
    if (item.semantic != 0) classes[item.semantic] = item.label;
  }
  Record record = Record::array();
  for (const auto& [id, name] : classes) record.push_back({id, name});
  return record;
}

std::map<std::uint32_t, std::string> all_classes(std::span<const Record> records) {
  std::map<std::uint32_t, std::string> classes;
  for (const Record& record : records) {
    for (const Record& each : record.at("classes")) {
      const auto id = each.at(0).get<std::uint32_t>();
      const auto name = each.at(1).get<std::string>();
      const auto [known, is_new] = classes.try_emplace(id, name);
      if (is_new || known->second == name) continue;
      throw InputError("class " + std::to_string(id) + " is \"" + known->second + "\" in one frame and \"" + name +
                       "\" in another, expected one name");
    }
  }
  return classes;
}

}  // namespace simvis
