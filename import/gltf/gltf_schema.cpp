#include "import/gltf/gltf_schema.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>

namespace simvis {
namespace {

using nlohmann::json;

enum class Kind {
  flag,
  integer,
  number,
  text,
  index,        // a whole number below the length of the array `of`
  object,       // described by `fields`
  numbers,      // array of `length` numbers; 0: any length
  indices,      // array of `index`
  texts,        // array of strings
  objects,      // array of objects described by `fields`
  index_map,    // object whose values are indices
  integer_map,  // object whose values are whole numbers
  index_maps,   // array of `index_map`
  commands  // `extras`; only the strings of its members `simvis` and `simvis_points`, `_models` and `_links` are used
};

constexpr double kFieldMax = std::numeric_limits<float>::max();
constexpr double kInt32Max = std::numeric_limits<std::int32_t>::max();
constexpr double kMaxOffset = 1e15;  // bytes; sums of a few such numbers still fit 64 bits

struct Field {
  std::string_view name;
  Kind kind;
  bool required = false;
  double min = -kFieldMax, max = kFieldMax;
  std::string_view of = {};
  std::span<const Field> fields = {};
  std::size_t length = 0;
};

constexpr Field flag(std::string_view name) { return {name, Kind::flag}; }
constexpr Field text(std::string_view name) { return {name, Kind::text}; }
constexpr Field texts(std::string_view name) { return {name, Kind::texts}; }
constexpr Field integer(std::string_view name, double min, double max = kInt32Max) {
  return {name, Kind::integer, false, min, max};
}
constexpr Field number(std::string_view name, double min = -kFieldMax, double max = kFieldMax) {
  return {name, Kind::number, false, min, max};
}
constexpr Field numbers(std::string_view name, std::size_t length, double min = -kFieldMax, double max = kFieldMax) {
  return {name, Kind::numbers, false, min, max, {}, {}, length};
}
constexpr Field index(std::string_view name, std::string_view of) {
  return {name, Kind::index, false, 0, kInt32Max, of};
}
constexpr Field indices(std::string_view name, std::string_view of) {
  return {name, Kind::indices, false, 0, kInt32Max, of};
}
constexpr Field index_map(std::string_view name) { return {name, Kind::index_map, false, 0, kInt32Max, "accessors"}; }
constexpr Field integer_map(std::string_view name) { return {name, Kind::integer_map, false, 0, kInt32Max}; }
constexpr Field index_maps(std::string_view name) { return {name, Kind::index_maps, false, 0, kInt32Max, "accessors"}; }
constexpr Field object(std::string_view name, std::span<const Field> fields) {
  return {name, Kind::object, false, 0, 0, {}, fields};
}
constexpr Field objects(std::string_view name, std::span<const Field> fields) {
  return {name, Kind::objects, false, 0, 0, {}, fields};
}
constexpr Field commands(std::string_view name) { return {name, Kind::commands}; }
constexpr Field required(Field field) {
  field.required = true;
  return field;
}

// The values that glTF 2.0 and the supported extensions allow for the properties that are read. All others are removed.
constexpr std::span<const Field> kNothing{};

constexpr Field kAsset[] = {required(text("version")), text("minVersion")};

constexpr Field kBuffer[] = {text("name"), text("uri"), required(integer("byteLength", 1, kMaxOffset))};

constexpr Field kMeshopt[] = {required(index("buffer", "buffers")),
                              integer("byteOffset", 0),
                              required(integer("byteLength", 1)),
                              required(integer("byteStride", 1, 256)),
                              required(integer("count", 1)),
                              required(text("mode")),
                              text("filter")};
constexpr Field kBufferViewExtensions[] = {object("EXT_meshopt_compression", kMeshopt)};
constexpr Field kBufferView[] = {required(index("buffer", "buffers")), integer("byteOffset", 0, kMaxOffset),
                                 required(integer("byteLength", 1, kMaxOffset)), integer("byteStride", 4, 252),
                                 object("extensions", kBufferViewExtensions)};

constexpr Field kSparseIndices[] = {required(index("bufferView", "bufferViews")), integer("byteOffset", 0),
                                    required(integer("componentType", 5121, 5125))};
constexpr Field kSparseValues[] = {required(index("bufferView", "bufferViews")), integer("byteOffset", 0)};
constexpr Field kSparse[] = {required(integer("count", 1)), required(object("indices", kSparseIndices)),
                             required(object("values", kSparseValues))};
constexpr Field kAccessor[] = {index("bufferView", "bufferViews"),
                               integer("byteOffset", 0, kMaxOffset),
                               required(integer("componentType", 5120, 5126)),
                               flag("normalized"),
                               required(integer("count", 1)),
                               required(text("type")),
                               object("sparse", kSparse)};

constexpr Field kDraco[] = {required(index("bufferView", "bufferViews")), required(integer_map("attributes"))};
constexpr Field kSplatting[] = {text("kernel"), text("colorSpace"), text("projection")};
constexpr Field kPrimitiveExtensions[] = {object("KHR_draco_mesh_compression", kDraco),
                                          object("KHR_gaussian_splatting", kSplatting)};
constexpr Field kPrimitive[] = {required(index_map("attributes")),
                                index("indices", "accessors"),
                                index("material", "materials"),
                                integer("mode", 0, 6),
                                index_maps("targets"),
                                object("extensions", kPrimitiveExtensions)};
constexpr Field kMesh[] = {text("name"), required(objects("primitives", kPrimitive)), numbers("weights", 0)};

constexpr Field kInstancing[] = {required(index_map("attributes"))};
constexpr Field kNodeLight[] = {required(index("light", "lights"))};
constexpr Field kNodeExtensions[] = {object("KHR_lights_punctual", kNodeLight),
                                     object("EXT_mesh_gpu_instancing", kInstancing)};
constexpr Field kNode[] = {text("name"),
                           indices("children", "nodes"),
                           index("mesh", "meshes"),
                           index("skin", "skins"),
                           index("camera", "cameras"),
                           numbers("matrix", 16),
                           numbers("translation", 3),
                           numbers("rotation", 4),
                           numbers("scale", 3),
                           numbers("weights", 0),
                           object("extensions", kNodeExtensions),
                           commands("extras")};
constexpr Field kScene[] = {text("name"), indices("nodes", "nodes")};
constexpr Field kSkin[] = {text("name"), required(indices("joints", "nodes")),
                           index("inverseBindMatrices", "accessors")};

constexpr Field kAnimationTarget[] = {index("node", "nodes"), required(text("path"))};
constexpr Field kAnimationChannel[] = {required(integer("sampler", 0)), required(object("target", kAnimationTarget))};
constexpr Field kAnimationSampler[] = {required(index("input", "accessors")), required(index("output", "accessors")),
                                       text("interpolation")};
constexpr Field kAnimation[] = {text("name"), required(objects("channels", kAnimationChannel)),
                                required(objects("samplers", kAnimationSampler))};

constexpr Field kTextureTransform[] = {numbers("offset", 2), number("rotation"), numbers("scale", 2),
                                       integer("texCoord", 0)};
constexpr Field kTextureInfoExtensions[] = {object("KHR_texture_transform", kTextureTransform)};
constexpr Field kTextureInfo[] = {required(index("index", "textures")), integer("texCoord", 0),
                                  object("extensions", kTextureInfoExtensions)};
constexpr Field kNormalTextureInfo[] = {required(index("index", "textures")), integer("texCoord", 0), number("scale"),
                                        object("extensions", kTextureInfoExtensions)};
constexpr Field kOcclusionTextureInfo[] = {required(index("index", "textures")), integer("texCoord", 0),
                                           number("strength", 0, 1), object("extensions", kTextureInfoExtensions)};
constexpr Field kPbr[] = {numbers("baseColorFactor", 4, 0, 1), object("baseColorTexture", kTextureInfo),
                          number("metallicFactor", 0, 1), number("roughnessFactor", 0, 1),
                          object("metallicRoughnessTexture", kTextureInfo)};
constexpr Field kEmissiveStrength[] = {number("emissiveStrength", 0)};
constexpr Field kIor[] = {number("ior", 0)};
constexpr Field kTransmission[] = {number("transmissionFactor", 0, 1)};
constexpr Field kMaterialExtensions[] = {
    object("KHR_materials_unlit", kNothing), object("KHR_materials_emissive_strength", kEmissiveStrength),
    object("KHR_materials_ior", kIor), object("KHR_materials_transmission", kTransmission)};
constexpr Field kMaterial[] = {text("name"),
                               object("pbrMetallicRoughness", kPbr),
                               object("normalTexture", kNormalTextureInfo),
                               object("occlusionTexture", kOcclusionTextureInfo),
                               numbers("emissiveFactor", 3, 0, 1),
                               object("emissiveTexture", kTextureInfo),
                               text("alphaMode"),
                               number("alphaCutoff", 0),
                               flag("doubleSided"),
                               object("extensions", kMaterialExtensions)};
constexpr Field kImage[] = {text("name"), text("uri"), text("mimeType"), index("bufferView", "bufferViews")};
constexpr Field kSampler[] = {integer("magFilter", 9728, 9729), integer("minFilter", 9728, 9987),
                              integer("wrapS", 10497, 33648), integer("wrapT", 10497, 33648)};
constexpr Field kTextureSource[] = {index("source", "images")};
constexpr Field kTextureExtensions[] = {object("EXT_texture_webp", kTextureSource),
                                        object("KHR_texture_basisu", kTextureSource),
                                        object("MSFT_texture_dds", kTextureSource)};
constexpr Field kTexture[] = {text("name"), index("sampler", "samplers"), index("source", "images"),
                              object("extensions", kTextureExtensions)};

constexpr double kHalfTurn = 3.1415927;  // pi rounded to float32
constexpr Field kSpot[] = {number("innerConeAngle", 0, kHalfTurn / 2), number("outerConeAngle", 0, kHalfTurn / 2)};
constexpr Field kLight[] = {text("name"),           required(text("type")), numbers("color", 3, 0),
                            number("intensity", 0), number("range", 0),     object("spot", kSpot)};
constexpr Field kLights[] = {required(objects("lights", kLight))};
constexpr Field kRootExtensions[] = {object("KHR_lights_punctual", kLights)};

constexpr Field kRoot[] = {required(object("asset", kAsset)), texts("extensionsUsed"),
                           texts("extensionsRequired"),       object("extensions", kRootExtensions),
                           objects("buffers", kBuffer),       objects("bufferViews", kBufferView),
                           objects("accessors", kAccessor),   objects("images", kImage),
                           objects("samplers", kSampler),     objects("textures", kTexture),
                           objects("materials", kMaterial),   objects("meshes", kMesh),
                           objects("skins", kSkin),           objects("cameras", kNothing),
                           objects("animations", kAnimation), objects("nodes", kNode),
                           objects("scenes", kScene),         index("scene", "scenes")};

// A place in the document. It is converted to text only for a message.
struct Place {
  const Place* parent;
  std::string_view name;
  std::size_t index = 0;

  std::string text() const {
    const std::string own = name.empty() ? std::to_string(index) : std::string(name);
    return parent == nullptr ? own : parent->text() + "/" + own;
  }
};

class Checker {
 public:
  Checker(const json& root, const std::filesystem::path& file) : file_(file) {
    for (const Field& field : kRoot) {
      const auto found = root.find(field.name);
      if (field.kind == Kind::objects && found != root.end() && found->is_array()) {
        counts_.emplace_back(field.name, found->size());
      }
    }
    static const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
    if (root.contains(lights) && root.at(lights).is_array()) counts_.emplace_back("lights", root.at(lights).size());
  }

  void object(json& value, std::span<const Field> fields, const Place* place) const {
    if (!value.is_object()) fail(place, "must be an object, not " + type_name(value));
    json kept = json::object();
    for (const Field& field : fields) {
      const auto found = value.find(field.name);
      if (found == value.end()) {
        if (field.required) fail(place, "lacks the required property \"" + std::string(field.name) + "\"");
        continue;
      }
      const Place own{place, field.name};
      check(*found, field, own);
      kept[std::string(field.name)] = std::move(*found);
    }
    value = std::move(kept);
  }

 private:
  void check(json& value, const Field& field, const Place& place) const {
    switch (field.kind) {
      case Kind::flag:
        if (!value.is_boolean()) fail(&place, "must be true or false, not " + type_name(value));
        return;
      case Kind::text:
        return check_text(value, place);
      case Kind::number:
        return check_number(value, field, place);
      case Kind::integer:
        return check_integer(value, field, place);
      case Kind::index:
        return check_index(value, field, place);
      case Kind::object:
        return object(value, field.fields, &place);
      case Kind::index_map:
      case Kind::integer_map:
        return check_map(value, field, place);
      case Kind::commands:
        return check_commands(value, place);
      default:
        return check_array(value, field, place);
    }
  }

  void check_array(json& value, const Field& field, const Place& place) const {
    if (!value.is_array()) fail(&place, "must be an array, not " + type_name(value));
    if (field.length != 0 && value.size() != field.length) {
      fail(&place, "has " + std::to_string(value.size()) + " values; expected " + std::to_string(field.length));
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
      const Place own{&place, {}, i};
      switch (field.kind) {
        case Kind::numbers:
          check_number(value[i], field, own);
          break;
        case Kind::indices:
          check_index(value[i], field, own);
          break;
        case Kind::texts:
          check_text(value[i], own);
          break;
        case Kind::index_maps:
          check_map(value[i], field, own);
          break;
        default:
          object(value[i], field.fields, &own);
      }
    }
  }

  void check_text(const json& value, const Place& place) const {
    if (!value.is_string()) fail(&place, "must be a string, not " + type_name(value));
  }

  void check_number(json& value, const Field& field, const Place& place) const {
    if (!value.is_number()) fail(&place, "must be a number, not " + type_name(value));
    const double x = value.get<double>();
    if (!(x >= field.min && x <= field.max)) {
      fail(&place, "is " + value.dump() + "; expected a value from " + format_number(field.min) + " to " +
                       format_number(field.max));
    }
    value = x;
  }

  void check_integer(json& value, const Field& field, const Place& place) const {
    check_number(value, field, place);
    const double x = value.get<double>();
    if (x != std::floor(x)) fail(&place, "is " + value.dump() + "; expected a whole number");
    value = static_cast<std::uint64_t>(x);  // exact: the ranges of whole numbers lie within 0 and 2^53
  }

  void check_index(json& value, const Field& field, const Place& place) const {
    const std::size_t count = count_of(field.of);
    const bool is_negative = value.is_number() && value.get<double>() < 0;
    if (!is_negative) check_integer(value, field, place);
    if (!is_negative && value.get<std::uint64_t>() < count) return;
    fail(&place, "is " + value.dump() + ", but the file has " + std::to_string(count) + " " + std::string(field.of));
  }

  void check_map(json& value, const Field& field, const Place& place) const {
    if (!value.is_object()) fail(&place, "must be an object, not " + type_name(value));
    for (auto item = value.begin(); item != value.end(); ++item) {
      const Place own{&place, item.key()};
      if (field.kind == Kind::integer_map) {
        check_integer(item.value(), field, own);
      } else {
        check_index(item.value(), field, own);
      }
    }
  }

  void check_commands(json& extras, const Place& place) const {
    json kept = json::object();
    for (const char* const name : {"simvis", "simvis_points", "simvis_models", "simvis_links"}) {
      const auto found = extras.is_object() ? extras.find(name) : extras.end();
      kept[name] = json::array();
      if (!extras.is_object() || found == extras.end()) continue;
      kept[name] = std::move(*found);
      if (kept[name].is_string()) kept[name] = json::array({std::move(kept[name])});
      check_array(kept[name], texts(name), Place{&place, name});
    }
    extras = std::move(kept);
  }

  std::size_t count_of(std::string_view array) const {
    for (const auto& [name, count] : counts_) {
      if (name == array) return count;
    }
    return 0;
  }

  static std::string type_name(const json& value) { return std::string("a value of type ") + value.type_name(); }

  [[noreturn]] void fail(const Place* place, const std::string& what) const {
    throw InputError(file_.string() + ": error: " + (place == nullptr ? "the document" : place->text()) + " " + what);
  }

  const std::filesystem::path& file_;
  std::vector<std::pair<std::string_view, std::size_t>> counts_;
};

}  // namespace

void check_and_prune_gltf(json& root, const std::filesystem::path& file) {
  Checker(root, file).object(root, kRoot, nullptr);
}

}  // namespace simvis
