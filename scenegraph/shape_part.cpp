#include "scenegraph/shape_part.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/read_error.h"
#include "scenegraph/error_word.h"
#include "scenegraph/height_map.h"
#include "scenegraph/picture_reader.h"
#include "scenegraph/primitive_meshes.h"
#include "scenegraph/wall_part.h"

namespace simvis {
namespace {

// A shape, the attributes that it requires, and those that it may have besides.
struct ShapeKind {
  std::string_view name;
  std::array<std::string_view, 3> required;
  std::array<std::string_view, 2> optional{};
  std::size_t sizes = 0;  // numbers of `size`
};
constexpr std::string_view kSize = kSizeRow.name, kRadius = kRadiusRow.name, kLength = kLengthRow.name,
                           kHeights = kHeightsRow.name, kZRange = kZRangeRow.name;
constexpr ShapeKind kShapeKinds[] = {
    {.name = "box", .required = {kSize}, .sizes = 3},
    {.name = "sphere", .required = {kRadius}},
    {.name = "cylinder", .required = {kRadius, kLength}},
    {.name = "cone", .required = {kRadius, kLength}},
    {.name = "capsule", .required = {kRadius, kLength}},
    {.name = "plane", .required = {kSize}, .sizes = 2},
    {.name = "heightmap", .required = {kSize, kHeights}, .optional = {kZRange}, .sizes = 2},
    {.name = "wall",
     .required = {kPointsRow.name, kHeightRow.name, kThicknessRow.name},
     .optional = {kDoorsRow.name, kWindowsRow.name}}};
constexpr std::string_view kMeasures[] = {kSize,          kRadius,         kLength,         kHeights,
                                          kZRange,        kPointsRow.name, kHeightRow.name, kThicknessRow.name,
                                          kDoorsRow.name, kWindowsRow.name};
constexpr std::string_view kLooks[] = {kColorRow.name, kTextureRow.name};
constexpr std::string_view kOfFilesOnly[] = {"up",          "scale",        "unit",        "xacro_arguments",
                                             "wall_height", "point_radius", "point_shape", "missing_visuals"};

const ShapeKind& kind_of(const AttributeValues& attributes) {
  const auto found = std::ranges::find(kShapeKinds, attributes.choice(kShapeRow.name), &ShapeKind::name);
  SIMVIS_ASSERT(found != std::end(kShapeKinds));
  return *found;
}

bool takes(const ShapeKind& kind, std::string_view measure) {
  return std::ranges::count(kind.required, measure) + std::ranges::count(kind.optional, measure) > 0;
}

std::string measures_of(const ShapeKind& kind) {
  std::string list;
  for (const std::string_view measure : kind.required) {
    if (!measure.empty()) list += (list.empty() ? "" : " and ") + std::string(measure);
  }
  return list;
}

// Reads `size`: as many numbers as the shape needs, each within the limits of a radius.
std::array<double, 3> size_of(const AttributeValues& attributes, const ShapeKind& kind) {
  std::array<double, 3> size_m{};
  const std::span<double> values(size_m.data(), kind.sizes);
  const std::string& text = attributes.text(kSize);
  const bool valid = parse_numbers(text, values) && std::ranges::all_of(values, [](double value) {
                       return value >= kMinShapeLength_m && value <= kMaxShapeLength_m;
                     });
  if (!valid) {
    fail_at(attributes.where(kSize), "attribute \"size\": " + in_quotes(text) + " is not allowed, expected " +
                                         (kind.sizes == 3 ? "three numbers x y z" : "two numbers x y") + " from " +
                                         format_number(kMinShapeLength_m) + " to " + format_number(kMaxShapeLength_m) +
                                         " (m)");
  }
  return size_m;
}

std::array<double, 2> z_range_of(const AttributeValues& attributes) {
  std::array<double, 2> range_m{};
  const std::string& text = attributes.text(kZRange);
  const bool valid = parse_numbers(text, range_m) &&
                     std::ranges::all_of(range_m, [](double z) { return std::abs(z) <= kMaxShapeLength_m; });
  if (!valid) {
    fail_at(attributes.where(kZRange), "attribute \"z_range\": " + in_quotes(text) +
                                           " is not allowed, expected two numbers of at most " +
                                           format_number(kMaxShapeLength_m) + " (m) either way");
  }
  return range_m;
}

[[noreturn]] void refuse(const CommandAttribute& attribute, const std::string& why) {
  fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + ": " + why);
}

std::filesystem::path picture_file(const Command& part, std::string_view attribute) {
  const CommandAttribute& name = part.require(attribute);
  std::filesystem::path file = (part.folder / name.value).lexically_normal();
  if (!is_input_file(file)) refuse(name, "there is no picture " + in_quotes(file.string()));
  return file;
}

HeightMap height_map_of(const Command& part, const AttributeValues& attributes, const ShapeKind& kind) {
  const std::array<double, 3> size_m = size_of(attributes, kind);
  const auto [low_m, high_m] = z_range_of(attributes);
  HeightPicture picture;
  try {
    picture = picture_reader().heights(picture_file(part, kHeights));
  } catch (const InputError& error) {
    if (std::string_view(error.what()).starts_with(to_string(attributes.where(kHeights)))) throw;
    refuse(part.require(kHeights), without_error_word(error.what()));
  }
  return height_map(picture, {size_m[0], size_m[1]}, low_m, high_m);
}

Mesh mesh_of(const AttributeValues& attributes, const ShapeKind& kind) {
  if (kind.name == "wall") return wall_mesh(wall_plan(attributes));
  if (kind.sizes > 0) {
    const auto [x, y, z] = size_of(attributes, kind);
    return kind.sizes == 3 ? box_mesh({x, y, z}) : plane_mesh({x, y});
  }
  const double radius_m = attributes.number(kRadius);
  if (kind.name == "sphere") return sphere_mesh(radius_m);
  const double length_m = attributes.number(kLength);
  if (kind.name == "cone") return cone_mesh(radius_m, length_m);
  return kind.name == "capsule" ? capsule_mesh(radius_m, length_m) : cylinder_mesh(radius_m, length_m);
}

// The mesh of a box is rounded to float32.
void add_box_scale(const std::array<double, 3>& size_m, Group& group) {
  const glm::dmat4 scale = exact_box_scale({size_m[0], size_m[1], size_m[2]});
  if (scale != glm::dmat4(1)) group.add(std::make_shared<Transform>(scale));
}

Material material_of(const Command& part, const AttributeValues& attributes, ContentPool& pool,
                     std::vector<std::string>& warnings) {
  Material material;
  material.name = attributes.choice(kShapeRow.name);
  material.double_sided = true;
  if (attributes.is_set(kColorRow.name)) {
    const double(&color)[3] = attributes.vector(kColorRow.name);
    material.base_color = {color[0], color[1], color[2], 1};
  }
  if (!attributes.is_set(kTextureRow.name)) return material;
  const auto read = [file = picture_file(part, kTextureRow.name),
                     where = attributes.where(kTextureRow.name)](std::vector<std::string>& found) {
    std::optional<Texture> texture;
    try {
      texture = picture_reader().texture(file);
      texture->name = file.filename().string();
    } catch (const InputError& error) {
      found.push_back(to_string(where) + ": the colour replaces the texture, " + without_error_word(error.what()));
    }
    return texture;
  };
  material.base_color_texture = pool.picture({.read = read}, warnings);
  return material;
}

// Refuses an attribute that the part's shape or file has no use for. `shape` is null without one.
void check_use(const CommandAttribute& attribute, const CommandAttribute* shape, bool has_file,
               const AttributeValues& attributes) {
  const bool measures = std::ranges::count(kMeasures, attribute.name) > 0;
  if (shape == nullptr && (measures || std::ranges::count(kLooks, attribute.name) > 0)) {
    refuse(attribute, "it describes a shape, and the part has no attribute \"shape\"");
  }
  if (!has_file && std::ranges::count(kOfFilesOnly, attribute.name) > 0) {
    refuse(attribute, "it says how a file is read, and the part has no attribute \"file\"");
  }
  if (shape == nullptr && !has_file && attribute.name == "opacity") {
    refuse(attribute, "it is that of materials, and the part has neither a file nor a shape");
  }
  if (shape == nullptr || !measures || takes(kind_of(attributes), attribute.name)) return;
  refuse(attribute, "a " + shape->value + " has none, expected " + measures_of(kind_of(attributes)));
}

}  // namespace

void check_shape_attributes(const Command& part, const AttributeValues& attributes) {
  const CommandAttribute* const shape = part.find(kShapeRow.name);
  const bool has_file = part.find("file") != nullptr;
  if (shape != nullptr && has_file) refuse(*shape, "the part has a file already, expected a file or a shape, not both");
  for (const CommandAttribute& attribute : part.attributes) check_use(attribute, shape, has_file, attributes);
  if (shape == nullptr) return;
  const ShapeKind& kind = kind_of(attributes);
  for (const std::string_view measure : kind.required) {
    if (measure.empty() || attributes.is_set(measure)) continue;
    fail_at(part.where,
            "a " + shape->value + " without attribute " + in_quotes(measure) + ", expected " + measures_of(kind));
  }
  if (kind.sizes > 0) size_of(attributes, kind);
  if (kind.name == "heightmap") z_range_of(attributes);
  if (kind.name == "wall") wall_plan(attributes);
}

std::string shape_key(const Command& part, const AttributeValues& attributes) {
  if (!attributes.is_set(kShapeRow.name)) return "frame";
  const ShapeKind& kind = kind_of(attributes);
  std::string key = "shape " + std::string(kind.name);
  if (kind.sizes > 0) {
    for (const double size : size_of(attributes, kind)) key += " " + format_number(size);
  }
  for (const std::string_view measure : kMeasures) {
    if (measure == kSize || !takes(kind, measure) || !attributes.is_set(measure)) continue;
    const CommandAttribute* const written = part.find(measure);
    const bool is_file = measure == kHeights;
    key += "\n" + std::string(measure) + " " +
           (is_file              ? picture_file(part, measure).string()
            : written == nullptr ? std::string()
                                 : written->value);
  }
  if (attributes.is_set(kTextureRow.name)) key += "\ntexture " + picture_file(part, kTextureRow.name).string();
  if (!attributes.is_set(kColorRow.name)) return key;
  key += "\ncolor";
  for (const double share : attributes.vector(kColorRow.name)) key += " " + format_number(share);
  return key;
}

PartContent make_shape(const Command& part, const AttributeValues& attributes, ContentPool& pool) {
  const auto root = std::make_shared<Separator>();
  PartContent content;
  content.root = root;
  if (!attributes.is_set(kShapeRow.name)) return content;
  const std::string& name = attributes.choice(kShapeRow.name);
  const auto node = std::make_shared<MaterialNode>(pool.intern(material_of(part, attributes, pool, content.warnings)));
  node->name = name;
  root->add(node);
  const ShapeKind& kind = kind_of(attributes);
  Mesh mesh;
  if (kind.name == "heightmap") {
    HeightMap map = height_map_of(part, attributes, kind);
    root->add(std::make_shared<Transform>(map.place));
    mesh = std::move(map.mesh);
  } else {
    mesh = mesh_of(attributes, kind);
    if (kind.name == "box") add_box_scale(size_of(attributes, kind), *root);
  }
  const auto shape = std::make_shared<Shape>(pool.intern(std::move(mesh)));
  shape->name = name;
  root->add(shape);
  return content;
}

}  // namespace simvis
