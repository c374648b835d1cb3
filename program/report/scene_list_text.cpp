#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/decimal.h"
#include "program/report/output_table.h"
#include "program/report/scene_list.h"

namespace simvis {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxIndent = 40;
constexpr std::string_view kJointTypes[] = {"joint", "mimic_joint"};

// Six digits are for people; the JSON has all of them.
std::string rounded(double value) { return decimal(value + 0.0, 6); }

std::string three(const glm::dvec3& v, std::string_view separator) {
  return rounded(v.x) + std::string(separator) + rounded(v.y) + std::string(separator) + rounded(v.z);
}

std::string shapes_text(const ListedShapes& shapes) {
  if (!shapes.any) return "";
  std::string text = ", " + std::to_string(shapes.triangles) + " triangles, " +
                     three(shapes.box_max_m - shapes.box_min_m, " x ") + " m, from (" + three(shapes.box_min_m, " ") +
                     ") to (" + three(shapes.box_max_m, " ") + ")";
  std::string names;
  for (const Material* material : shapes.materials) {
    if (!material->name.empty()) names += (names.empty() ? "" : ", ") + material->name;
  }
  return names.empty() ? text : text + "; materials: " + names;
}

std::string limits_text(const AttributeSpec& spec) {
  const bool has_min = spec.min != -kNoLimit, has_max = spec.max != kNoLimit;
  if (!has_min && !has_max) return "";
  const std::string min = has_min ? (spec.open_min ? "above " : "") + rounded(spec.min) : "any";
  const std::string max = has_max ? (spec.open_max ? "below " : "") + rounded(spec.max) : "any";
  return " [" + min + " to " + max + "]";
}

std::string element_text(const ListedElement& element) {
  std::string text = "element " + element.name + " (" + element.type + ") at " + element.insert_at;
  const char* separator = ": ";
  for (const ListedParameter& parameter : element.parameters) {
    text += separator + std::string(parameter.spec.name) + " = " + format_number(parameter.value);
    if (!parameter.spec.unit.empty()) text += " " + std::string(parameter.spec.unit);
    text += limits_text(parameter.spec);
    separator = ", ";
  }
  return text + shapes_text(element.shapes);
}

std::string sensor_text(const ListedSensor& sensor) {
  std::string text = "sensor " + sensor.name + " (" + sensor.type + ", " + sensor.method + ") at " + sensor.insert_at;
  if (sensor.world_from_sensor) {
    const glm::dmat4& frame = *sensor.world_from_sensor;
    text += ", stands at (" + three(frame[3], " ") + "), looks along (" + three(frame[0], " ") + ")";
  }
  const char* separator = ": ";
  for (const auto& [name, value] : sensor.attributes) {
    text += separator + name + "=\"" + value + "\"";
    separator = " ";
  }
  return text;
}

std::string output_text(const OutputSpec& output) {
  std::string text = "gives " + output.name + ": " + std::string(to_string(output.kind)) + ", " +
                     std::string(to_string(output.value_type)) + ", " + to_string(output.shape);
  return output.unit.empty() ? text : text + ", " + output.unit;
}

std::string part_text(const ListedPart& part) {
  std::string text = part.name;
  if (part.depth > 0) text += " (" + part.source + ") at " + part.insert_at;
  text += shapes_text(part.shapes);
  const char* separator = "; insertion points: ";
  for (const std::string& point : part.insertion_points) {
    text += separator + point;
    separator = ", ";
  }
  return text;
}

Json to_array(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json limit(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

void add_shapes(Json& object, const ListedShapes& shapes) {
  object["triangles"] = shapes.triangles;
  object["box_m"] = nullptr;
  if (shapes.any) object["box_m"] = {{"min", to_array(shapes.box_min_m)}, {"max", to_array(shapes.box_max_m)}};
  object["materials"] = Json::array();
  for (const Material* material : shapes.materials) {
    const glm::vec4& color = material->base_color;
    object["materials"].push_back({{"name", material->name},
                                   {"base_color", {color.r, color.g, color.b, color.a}},
                                   {"texture", material->base_color_texture != nullptr}});
  }
}

Json part_json(const ListedPart& part) {
  Json object = {{"name", part.name},
                 {"insert_at", part.depth == 0 ? Json(nullptr) : Json(part.insert_at)},
                 {"source", part.source},
                 {"insertion_points", part.insertion_points}};
  add_shapes(object, part.shapes);
  return object;
}

Json element_json(const ListedElement& element) {
  Json object = {{"name", element.name}, {"type", element.type}, {"insert_at", element.insert_at}};
  object["parameters"] = Json::array();
  for (const ListedParameter& parameter : element.parameters) {
    object["parameters"].push_back({{"name", std::string(parameter.spec.name)},
                                    {"value", parameter.value},
                                    {"unit", std::string(parameter.spec.unit)},
                                    {"min", limit(parameter.spec.min)},
                                    {"max", limit(parameter.spec.max)}});
  }
  add_shapes(object, element.shapes);
  return object;
}

Json sensor_json(const ListedSensor& sensor) {
  Json object = {{"name", sensor.name},     {"type", sensor.type},         {"insert_at", sensor.insert_at},
                 {"method", sensor.method}, {"position_m", nullptr},       {"forward", nullptr},
                 {"up", nullptr},           {"attributes", Json::object()}};
  if (sensor.world_from_sensor) {
    object["position_m"] = to_array((*sensor.world_from_sensor)[3]);
    object["forward"] = to_array((*sensor.world_from_sensor)[0]);
    object["up"] = to_array((*sensor.world_from_sensor)[2]);
  }
  for (const auto& [name, value] : sensor.attributes) object["attributes"][name] = value;
  object["outputs"] = Json::array();
  for (const OutputSpec& output : sensor.outputs) object["outputs"].push_back(output_json(output));
  return object;
}

}  // namespace

std::string to_text(const SceneList& list) {
  std::string text;
  const auto line = [&](std::size_t depth, const std::string& content) {
    text += std::string(2 * std::min(depth, kMaxIndent), ' ') + content + "\n";
  };
  for (const ListedPart& part : list.parts) {
    line(part.depth, part_text(part));
    for (const std::size_t i : part.elements) line(part.depth + 1, element_text(list.elements[i]));
    for (const std::size_t i : part.sensors) {
      line(part.depth + 1, sensor_text(list.sensors[i]));
      for (const OutputSpec& output : list.sensors[i].outputs) line(part.depth + 2, output_text(output));
    }
  }
  for (const std::string& warning : list.warnings) line(0, "warning: " + warning);
  return text;
}

std::string to_json(const SceneList& list) {
  Json json = {{"parts", Json::array()},
               {"elements", Json::array()},
               {"joints", Json::array()},
               {"sensors", Json::array()},
               {"warnings", list.warnings}};
  for (const ListedPart& part : list.parts) json["parts"].push_back(part_json(part));
  for (const ListedElement& element : list.elements) {
    json["elements"].push_back(element_json(element));
    if (std::ranges::count(kJointTypes, element.type) > 0) json["joints"].push_back(element.name);
  }
  for (const ListedSensor& sensor : list.sensors) json["sensors"].push_back(sensor_json(sensor));
  // Names from files may contain any bytes: invalid UTF-8 is replaced.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace simvis
