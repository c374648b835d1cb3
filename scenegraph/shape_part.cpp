#include "scenegraph/shape_part.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

// A shape, and the attributes that it requires.
struct ShapeKind {
  std::string_view name;
  std::size_t sizes = 0;  // numbers of `size`
  bool radius = false, length = false;
};
constexpr ShapeKind kShapeKinds[] = {{.name = "box", .sizes = 3},
                                     {.name = "sphere", .radius = true},
                                     {.name = "cylinder", .radius = true, .length = true},
                                     {.name = "cone", .radius = true, .length = true},
                                     {.name = "capsule", .radius = true, .length = true},
                                     {.name = "plane", .sizes = 2}};
constexpr std::string_view kMeasures[] = {kSizeRow.name, kRadiusRow.name, kLengthRow.name};
constexpr std::string_view kOfFilesOnly[] = {"up", "scale", "unit", "xacro_arguments"};

const ShapeKind& kind_of(const AttributeValues& attributes) {
  const auto found = std::ranges::find(kShapeKinds, attributes.choice(kShapeRow.name), &ShapeKind::name);
  SIMVIS_ASSERT(found != std::end(kShapeKinds));
  return *found;
}

bool takes(const ShapeKind& kind, std::string_view measure) {
  if (measure == kSizeRow.name) return kind.sizes > 0;
  return measure == kRadiusRow.name ? kind.radius : kind.length;
}

std::string measures_of(const ShapeKind& kind) {
  std::string list;
  for (const std::string_view measure : kMeasures) {
    if (takes(kind, measure)) list += (list.empty() ? "" : " and ") + std::string(measure);
  }
  return list;
}

// Reads `size`: as many numbers as the shape needs, each within the limits of a radius.
std::array<double, 3> size_of(const AttributeValues& attributes, const ShapeKind& kind) {
  std::array<double, 3> size_m{};
  const std::span<double> values(size_m.data(), kind.sizes);
  const std::string& text = attributes.text(kSizeRow.name);
  const bool valid = parse_numbers(text, values) && std::ranges::all_of(values, [](double value) {
                       return value >= kRadiusRow.min && value <= kRadiusRow.max;
                     });
  if (!valid) {
    fail_at(attributes.where(kSizeRow.name), "attribute \"size\": " + in_quotes(text) + " is not allowed, expected " +
                                                 (kind.sizes == 3 ? "three numbers x y z" : "two numbers x y") +
                                                 " from " + format_number(kRadiusRow.min) + " to " +
                                                 format_number(kRadiusRow.max) + " (m)");
  }
  return size_m;
}

[[noreturn]] void refuse(const CommandAttribute& attribute, const std::string& why) {
  fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + ": " + why);
}

Mesh mesh_of(const AttributeValues& attributes) {
  const ShapeKind& kind = kind_of(attributes);
  if (kind.sizes > 0) {
    const auto [x, y, z] = size_of(attributes, kind);
    return kind.sizes == 3 ? box_mesh({x, y, z}) : plane_mesh({x, y});
  }
  const double radius_m = attributes.number(kRadiusRow.name);
  if (!kind.length) return sphere_mesh(radius_m);
  const double length_m = attributes.number(kLengthRow.name);
  if (kind.name == "cone") return cone_mesh(radius_m, length_m);
  return kind.name == "capsule" ? capsule_mesh(radius_m, length_m) : cylinder_mesh(radius_m, length_m);
}

}  // namespace

void check_shape_attributes(const Command& part, const AttributeValues& attributes) {
  const CommandAttribute* const shape = part.find(kShapeRow.name);
  const bool has_file = part.find("file") != nullptr;
  if (shape != nullptr && has_file) refuse(*shape, "the part has a file already, expected a file or a shape, not both");
  for (const CommandAttribute& attribute : part.attributes) {
    const bool measures = std::ranges::count(kMeasures, attribute.name) > 0;
    if (shape == nullptr && (measures || attribute.name == kColorRow.name)) {
      refuse(attribute, "it describes a shape, and the part has no attribute \"shape\"");
    }
    if (!has_file && std::ranges::count(kOfFilesOnly, attribute.name) > 0) {
      refuse(attribute, "it says how a file is read, and the part has no attribute \"file\"");
    }
    if (shape == nullptr && !has_file && attribute.name == "opacity") {
      refuse(attribute, "it is that of materials, and the part has neither a file nor a shape");
    }
    if (shape == nullptr || !measures || takes(kind_of(attributes), attribute.name)) continue;
    refuse(attribute, "a " + shape->value + " has none, expected " + measures_of(kind_of(attributes)));
  }
  if (shape == nullptr) return;
  const ShapeKind& kind = kind_of(attributes);
  for (const std::string_view measure : kMeasures) {
    if (!takes(kind, measure) || attributes.is_set(measure)) continue;
    fail_at(part.where,
            "a " + shape->value + " without attribute " + in_quotes(measure) + ", expected " + measures_of(kind));
  }
  if (kind.sizes > 0) size_of(attributes, kind);
}

std::string shape_key(const AttributeValues& attributes) {
  if (!attributes.is_set(kShapeRow.name)) return "frame";
  const ShapeKind& kind = kind_of(attributes);
  std::string key = "shape " + std::string(kind.name);
  if (kind.sizes > 0) {
    for (const double size : size_of(attributes, kind)) key += " " + format_number(size);
  }
  if (kind.radius) key += " " + format_number(attributes.number(kRadiusRow.name));
  if (kind.length) key += " " + format_number(attributes.number(kLengthRow.name));
  if (!attributes.is_set(kColorRow.name)) return key;
  key += " color";
  for (const double share : attributes.vector(kColorRow.name)) key += " " + format_number(share);
  return key;
}

PartContent make_shape(const AttributeValues& attributes, ContentPool& pool) {
  const auto root = std::make_shared<Separator>();
  PartContent content;
  content.root = root;
  if (!attributes.is_set(kShapeRow.name)) return content;
  Material material;
  material.name = root->name = attributes.choice(kShapeRow.name);
  material.double_sided = true;
  if (attributes.is_set(kColorRow.name)) {
    const double(&color)[3] = attributes.vector(kColorRow.name);
    material.base_color = {color[0], color[1], color[2], 1};
  }
  const auto node = std::make_shared<MaterialNode>(pool.intern(std::move(material)));
  node->name = root->name;
  root->add(node);
  const auto shape = std::make_shared<Shape>(pool.intern(mesh_of(attributes)));
  shape->name = root->name;
  root->add(shape);
  return content;
}

}  // namespace simvis
