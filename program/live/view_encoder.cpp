#include "program/live/view_encoder.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "engine/base/binary_numbers.h"
#include "program/live/glb_file.h"
#include "program/live/glb_materials.h"
#include "scenegraph/array_bytes.h"
#include "scenegraph/pictures/png_file.h"
#include "scenegraph/scan_arrays.h"

namespace simvis::live {
namespace {

using Json = nlohmann::ordered_json;

/// Names from files may contain any bytes: invalid UTF-8 is replaced.
std::string to_text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// The first eight bytes: the kind, three zeros, a number such as that of the sensor.
void begin(std::string& bytes, std::uint8_t kind, std::uint32_t number) {
  append_binary(bytes, std::uint32_t{kind});
  append_binary(bytes, number);
}

/// The length of a description, zeros, and its text, filled up with spaces to a multiple of eight bytes.
void append_description(std::string& bytes, const Json& description) {
  std::string text = to_text(description);
  text.resize((text.size() + 7) / 8 * 8, ' ');
  append_binary(bytes, static_cast<std::uint32_t>(text.size()));
  append_binary(bytes, std::uint32_t{0});
  bytes += text;
}

/// The upper three rows.
void append_rows(std::string& bytes, const glm::dmat4& matrix) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) append_binary(bytes, matrix[column][row]);
  }
}

// Stands for a missing id, or for a missing body.
constexpr std::uint32_t kNoNumber = std::numeric_limits<std::uint32_t>::max();

/// Whether a column of a scan is sent as u32, which keeps all digits: its numbers are whole, such as ids, and none is
/// negative. Other columns are sent as f32.
bool is_sent_whole(const MeasuredArray& column) {
  if (!is_integer(column.value_type) && column.format != "%.0f") return false;
  for (std::size_t i = 0; i < column.count(); ++i) {
    const double value = column.number(i);
    if (value < 0 || (std::isfinite(value) && value >= kNoNumber)) return false;
  }
  return true;
}

void append_column(std::string& bytes, const MeasuredArray& column, bool whole) {
  for (std::size_t i = 0; i < column.count(); ++i) {
    const double value = column.number(i);
    if (whole) {
      append_binary(bytes, std::isfinite(value) ? static_cast<std::uint32_t>(value) : kNoNumber);
    } else {
      append_binary(bytes, static_cast<float>(value));
    }
  }
}

Json sensor_json(const ViewSensor& sensor, const std::optional<std::uint32_t>& transform) {
  Json json = {{"name", sensor.name},           {"type", sensor.type},
               {"insert_at", sensor.insert_at}, {"visualization", sensor.visualization},
               {"beams", sensor.beams},         {"transform", transform ? Json(*transform) : Json(nullptr)},
               {"attributes", Json::object()}};
  for (const auto& [name, value] : sensor.attributes) json["attributes"][name] = value;
  return json;
}

Json parameter_json(const ViewParameter& parameter) {
  if (parameter.removed) return nullptr;
  return {{"element", parameter.element}, {"type", parameter.type},   {"insert_at", parameter.insert_at},
          {"name", parameter.name},       {"unit", parameter.unit},   {"min", number(parameter.min)},
          {"max", number(parameter.max)}, {"value", parameter.value}, {"full_turn", parameter.full_turn},
          {"summary", parameter.summary}};
}

Json table_json(const ViewTable& table) {
  Json json = {
      {"sensor", table.sensor}, {"one_row", table.one_row}, {"columns", Json::array()}, {"rows", Json::array()}};
  for (const TableColumn& column : table.columns) json["columns"].push_back({column.name, column.unit});
  for (std::size_t i = 0; i < table.values.size(); i += table.columns.size()) {
    Json row = Json::array();
    for (std::size_t c = 0; c < table.columns.size(); ++c) row.push_back(number(table.values[i + c]));
    json["rows"].push_back(std::move(row));
  }
  return json;
}

Json material_json(std::size_t index, const Material& m) {
  return {index,        m.base_color.r, m.base_color.g, m.base_color.b, shown_alpha(m),
          m.emissive.r, m.emissive.g,   m.emissive.b,   m.roughness,    m.metallic};
}

Json rows_json(const glm::dmat4& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) rows.push_back(matrix[column][row]);
  }
  return rows;
}

Json vector_json(const glm::dvec3& vector) { return {vector.x, vector.y, vector.z}; }

Json shape_json(const DrawnShape& shape) {
  constexpr const char* kKinds[] = {"box", "sphere", "capsule", "cylinder", "hull", "plane"};
  Json json = {{"kind", kKinds[static_cast<std::size_t>(shape.kind)]},
               {"rows", rows_json(shape.body_from_shape)},
               {"half_m", vector_json(shape.half_m)}};
  if (shape.kind != DrawnShape::Kind::hull) return json;
  json["points"] = Json::array();
  for (const glm::dvec3& point : shape.points) json["points"].push_back(vector_json(point));
  json["triangles"] = shape.triangles;
  return json;
}

Json body_json(const DrawnBody& body) {
  constexpr const char* kMotions[] = {"static", "kinematic", "dynamic"};
  constexpr const char* kJoints[] = {"fixed", "revolute", "prismatic", "ball"};
  glm::dmat4 body_from_axes(body.axes);
  body_from_axes[3] = glm::dvec4(body.center_m, 1);
  Json json = {{"element", body.element},
               {"name", body.name},
               {"kind", kMotions[static_cast<std::size_t>(body.motion)]},
               {"mass_kg", number(body.mass_kg)},
               {"axes", rows_json(body_from_axes)},
               {"half_m", vector_json(body.half_m)},
               {"joint", nullptr},
               {"shapes", Json::array()}};
  if (body.joint) {
    json["joint"] = {{"kind", kJoints[static_cast<std::size_t>(body.joint->kind)]},
                     {"axis", vector_json(body.joint->axis)}};
  }
  for (const DrawnShape& shape : body.shapes) json["shapes"].push_back(shape_json(shape));
  return json;
}

bool same_scene(const ViewFrame* before, const ViewFrame& frame) {
  return before != nullptr && before->scene->structure == frame.scene->structure;
}

bool same_bits(const glm::dmat4& a, const glm::dmat4& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

std::string scene_message(const ViewScene& scene, std::string_view glb) {
  Json json = {{"op", "scene"},
               {"name", scene.name},
               {"structure", scene.structure},
               {"glb", glb},
               {"list", Json::parse(scene.list_json)},
               {"sensors", Json::array()},
               {"parameters", Json::array()},
               {"items", Json::array()},
               {"objects", Json::array()},
               {"points", Json::object()},
               {"elements", Json::object()}};
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    json["sensors"].push_back(sensor_json(scene.sensors[i], scene.transforms.sensors[i]));
  }
  for (const ViewParameter& parameter : scene.parameters) json["parameters"].push_back(parameter_json(parameter));
  for (const SceneItem& item : scene.items)
    json["items"].push_back({item.part, item.mesh, item.instance, item.semantic, item.label, item.shape});
  for (const SceneObject& each : scene.objects) {
    json["objects"].push_back(
        {each.name, each.path, to_string(each.kind), each.instance, each.parent, each.semantic, each.label});
  }
  for (const auto& [name, transform] : scene.transforms.points) json["points"][name] = transform;
  for (const auto& [name, transform] : scene.transforms.elements) json["elements"][name] = transform;
  return to_text(json);
}

std::string frame_message(const ViewFrame& frame, const ViewTime& time) {
  constexpr const char* kHosts[] = {"runs", "stands", "ended"};  // in the order of ViewTime::Host
  Json json = {{"op", "frame"},
               {"frame", frame.index},
               {"time_s", static_cast<double>(frame.time_ns) / 1e9},
               {"speed", number(time.speed)},
               {"step_ms", number(frame.step_ms)},
               {"playing", time.playing},
               {"recorded", time.recorded},
               {"host", kHosts[static_cast<std::size_t>(time.host)]},
               {"warnings", frame.warnings},
               {"tables", Json::array()}};
  for (const ViewTable& table : frame.tables) json["tables"].push_back(table_json(table));
  if (!frame.plan.empty()) json["plan"] = frame.plan;
  return to_text(json);
}

std::string values_message(const ViewFrame* before, const ViewFrame& frame) {
  Json changed = Json::array();
  const bool same = same_scene(before, frame);
  for (std::size_t i = 0; i < frame.values.size(); ++i) {
    if (same && before->values[i] == frame.values[i]) continue;
    changed.push_back({i, frame.values[i]});
  }
  return changed.empty() ? "" : to_text({{"op", "values"}, {"values", std::move(changed)}});
}

std::string materials_message(const ViewFrame* before, const ViewFrame& frame) {
  const bool same = same_scene(before, frame);
  if (same && before->materials == frame.materials) return "";
  Json changed = Json::array();
  for (std::size_t i = 0; i < frame.materials->size(); ++i) {
    const std::shared_ptr<const Material>& now = (*frame.materials)[i];
    if (same ? (*before->materials)[i] == now : frame.scene->list.materials[i] == now) continue;
    changed.push_back(material_json(i, *now));
  }
  return changed.empty() ? "" : to_text({{"op", "materials"}, {"materials", std::move(changed)}});
}

std::string lights_message(const ViewFrame* before, const ViewFrame& frame) {
  if (same_scene(before, frame) && before->lights == frame.lights) return "";
  Json lights = Json::array();
  for (const LightItem& item : *frame.lights) {
    const Light& light = item.light;
    constexpr const char* kKinds[] = {"directional", "point", "spot"};
    lights.push_back({{"kind", kKinds[static_cast<std::size_t>(light.kind)]},
                      {"transform", item.transform},
                      {"color", {light.color.r, light.color.g, light.color.b}},
                      {"intensity", light.intensity},
                      {"range_m", light.range_m},
                      {"inner_cone_rad", light.inner_cone_rad},
                      {"outer_cone_rad", light.outer_cone_rad},
                      {"direction", {light.direction.x, light.direction.y, light.direction.z}}});
  }
  return to_text({{"op", "lights"}, {"lights", std::move(lights)}});
}

std::string hidden_message(const ViewFrame* before, const ViewFrame& frame) {
  if (same_scene(before, frame) && before->hidden == frame.hidden) return "";
  return to_text({{"op", "hidden"}, {"items", *frame.hidden}});
}

std::string environment_message(const ViewFrame* before, const ViewFrame& frame) {
  if (same_scene(before, frame) && before->environment == frame.environment) return "";
  const auto& [ambient, background] = frame.environment;
  return to_text({{"op", "environment"},
                  {"background", {background.r, background.g, background.b}},
                  {"ambient", {ambient.r, ambient.g, ambient.b}}});
}

std::string bodies_message(const ViewScene& scene) {
  if (scene.bodies.empty()) return "";
  Json bodies = Json::array();
  for (const DrawnBody& body : scene.bodies) bodies.push_back(body_json(body));
  return to_text({{"op", "bodies"}, {"bodies", std::move(bodies)}});
}

std::string error_message(std::string_view about, std::string_view message) {
  return to_text({{"op", "error"}, {"about", about}, {"message", message}});
}

std::string saved_message(std::string_view xml) { return to_text({{"op", "saved"}, {"xml", xml}}); }

std::string transforms_message(const ViewFrame* before, const ViewFrame& frame) {
  const bool same = same_scene(before, frame);
  if (same && before->world_from_node == frame.world_from_node) return "";
  const std::vector<glm::dmat4>& now = *frame.world_from_node;
  std::string bytes;
  begin(bytes, 1, 0);
  append_binary(bytes, static_cast<std::uint64_t>(frame.time_ns));
  append_binary(bytes, std::uint64_t{0});
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (same && same_bits((*before->world_from_node)[i], now[i])) continue;
    append_binary(bytes, std::uint64_t{i});
    append_rows(bytes, now[i]);
    ++count;
  }
  if (count == 0) return "";
  std::memcpy(bytes.data() + 2 * sizeof(std::uint64_t), &count, sizeof count);
  return bytes;
}

std::string shapes_message(const ViewFrame* before, const ViewFrame& frame) {
  const bool same = same_scene(before, frame);
  const auto& of_scene = frame.scene->list.meshes;
  if (same ? *before->meshes == *frame.meshes : of_scene == *frame.meshes) return "";
  std::string bytes;
  begin(bytes, 5, 0);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < of_scene.size(); ++i) {
    const Mesh& mesh = *(*frame.meshes)[i];
    if (&mesh == of_scene[i].get()) continue;
    append_binary(bytes, static_cast<std::uint32_t>(i));
    append_binary(bytes, static_cast<std::uint32_t>(mesh.positions.size()));
    append_binary_all<glm::vec3>(bytes, mesh.positions);
    for (const VertexAttributes& vertex : mesh.attributes) append_binary(bytes, glb_normal(vertex));
    ++count;
  }
  std::memcpy(bytes.data() + sizeof count, &count, sizeof count);
  return bytes;
}

std::string physics_message(const ViewFrame& frame) {
  if (!frame.physics) return "";
  const DrawnPhysics& physics = *frame.physics;
  std::string bytes;
  begin(bytes, 4, static_cast<std::uint32_t>(physics.world_from_body.size()));
  append_binary(bytes, static_cast<std::uint64_t>(frame.time_ns));
  append_binary(bytes, std::uint64_t{physics.contacts.size()});
  for (const glm::dmat4& world_from_body : physics.world_from_body) append_rows(bytes, world_from_body);
  for (const DrawnContact& each : physics.contacts) {
    append_binary(bytes, each.contact.point_m);
    append_binary(bytes, each.contact.normal);
    append_binary(bytes, each.contact.depth_m);
    append_binary(bytes, each.contact.force_n);
    for (const std::optional<std::size_t>& body : {each.a, each.b}) {
      append_binary(bytes, body ? static_cast<std::uint32_t>(*body) : kNoNumber);
    }
  }
  return bytes;
}

std::string scan_message(const ViewScan& view) {
  const Scan& scan = view.scan;
  std::string bytes;
  begin(bytes, 2, view.sensor);
  append_binary(bytes, static_cast<std::uint64_t>(scan.time_ns));
  append_rows(bytes, scan.world_from_sensor);
  append_binary(bytes, scan.rings);
  append_binary(bytes, scan.beams);
  std::vector<std::pair<const MeasuredArray*, bool>> columns;  // each with is_sent_whole()
  Json described = Json::array();
  for (const MeasuredArray& each : scan.arrays) {
    if (each.kind != OutputKind::scan_column || is_beam_layout(each)) continue;
    columns.emplace_back(&each, is_sent_whole(each));
    described.push_back({each.name, each.unit, columns.back().second ? "u32" : "f32"});
  }
  const bool has_origins = !scan.origin_m.empty();
  append_description(bytes, {{"columns", std::move(described)}, {"origins", has_origins}});
  for (const auto& [column, whole] : columns) append_column(bytes, *column, whole);
  for (const glm::dvec3& point : scan.points()) append_binary(bytes, glm::vec3(point));
  if (!has_origins) return bytes;
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) append_binary(bytes, glm::vec3(scan.origin(i)));
  return bytes;
}

std::string image_message(const ViewImage& image) {
  const MeasuredArray& array = image.array;
  const bool is_color = array.content == ImageContent::color;
  std::string bytes;
  begin(bytes, 3, image.sensor);
  append_binary(bytes, static_cast<std::uint64_t>(image.time_ns));
  append_description(bytes, {{"name", array.name},
                             {"unit", array.unit},
                             {"form", is_color ? "png" : std::string(to_string(array.value_type))},
                             {"width", array.shape.columns},
                             {"height", array.shape.rows},
                             {"channels", array.shape.channels}});
  if (is_color) return bytes + encode_png(*to_image(array));
  const std::size_t end = bytes.size();
  bytes.resize(end + own_size(array));
  copy_numbers(array, bytes.data() + end);
  return bytes;
}

std::vector<ViewMessage> view_messages(const ViewFrame* before, const ViewFrame& frame, const ViewTime& time,
                                       std::string_view glb) {
  std::vector<ViewMessage> messages;
  const auto add = [&](bool binary, std::string bytes) {
    if (!bytes.empty()) messages.push_back({binary, std::move(bytes)});
  };
  if (!same_scene(before, frame)) add(false, scene_message(*frame.scene, glb));
  if (frame.physics && !same_scene(before, frame)) add(false, bodies_message(*frame.scene));
  add(true, transforms_message(before, frame));
  add(true, shapes_message(before, frame));
  add(false, materials_message(before, frame));
  add(false, lights_message(before, frame));
  add(false, hidden_message(before, frame));
  add(false, environment_message(before, frame));
  add(false, values_message(before, frame));
  add(true, physics_message(frame));
  for (const ViewScan& scan : frame.scans) add(true, scan_message(scan));
  for (const ViewImage& image : frame.images) add(true, image_message(image));
  add(false, frame_message(frame, time));
  return messages;
}

}  // namespace simvis::live
