#include "exchange/messages/description.h"

#include <map>

#include "engine/base/sha256.h"

namespace simvis::ros {

namespace {

using TypesByName = std::map<std::string_view, const TypeDescription*>;

void add_used(const TypeDescription& type, TypesByName& used) {
  for (const FieldDescription& field : type.fields) {
    const TypeDescription* const nested = field.type.nested;
    if (nested != nullptr && used.emplace(nested->name, nested).second) add_used(*nested, used);
  }
}

/// All types that the type uses, directly or not, by name.
TypesByName used_types(const TypeDescription& type) {
  TypesByName used;
  add_used(type, used);
  return used;
}

/// "std_msgs/Header": the name in .msg files.
std::string short_name(std::string_view name) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t middle = name.find(kMiddle);
  if (middle == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, middle)) + "/" + std::string(name.substr(middle + kMiddle.size()));
}

std::string field_lines(const TypeDescription& type) {
  std::string text(type.constants);
  for (const FieldDescription& field : type.fields) {
    text += short_name(field.type.name);
    if (field.shape == Shape::array) text += "[" + std::to_string(field.count) + "]";
    if (field.shape == Shape::sequence) text += "[]";
    text += " " + std::string(field.name) + "\n";
  }
  return text;
}

// In FieldType, the arrays and the sequences of a type have numbers of their own.
constexpr int kArrayIds = 48, kSequenceIds = 144;

std::string json_of(const FieldDescription& field) {
  const int shape = field.shape == Shape::array ? kArrayIds : field.shape == Shape::sequence ? kSequenceIds : 0;
  const std::string_view nested = field.type.nested != nullptr ? field.type.name : "";
  return R"({"name": ")" + std::string(field.name) + R"(", "type": {"type_id": )" +
         std::to_string(field.type.id + shape) + R"(, "capacity": )" + std::to_string(field.count) +
         R"(, "string_capacity": 0, "nested_type_name": ")" + std::string(nested) + R"("}})";
}

std::string json_of(const TypeDescription& type) {
  std::string fields;
  for (const FieldDescription& field : type.fields) fields += (fields.empty() ? "" : ", ") + json_of(field);
  return R"({"type_name": ")" + std::string(type.name) + R"(", "fields": [)" + fields + "]}";
}

}  // namespace

std::string msg_text(const TypeDescription& type) {
  std::string text = field_lines(type);
  for (const auto& [name, used] : used_types(type)) {
    text += std::string(80, '=') + "\nMSG: " + short_name(name) + "\n" + field_lines(*used);
  }
  return text;
}

std::string type_hash(const TypeDescription& type) {
  std::string used;
  for (const auto& [name, each] : used_types(type)) used += (used.empty() ? "" : ", ") + json_of(*each);
  const std::string json =
      R"({"type_description": )" + json_of(type) + R"(, "referenced_type_descriptions": [)" + used + "]}";
  return "RIHS01_" + sha256_of_text(json);
}

}  // namespace simvis::ros
