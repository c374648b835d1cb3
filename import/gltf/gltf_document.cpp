#include "import/gltf/gltf_document.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include <simvis/error.h>
#include "engine/base/fnv1a.h"
#include "engine/base/read_error.h"
#include "import/gltf/gltf_schema.h"
#include "import/gltf/gltf_specular.h"

namespace simvis {
namespace {

using nlohmann::json;

// A texture in a format that cannot be decoded (KHR_texture_basisu, MSFT_texture_dds) has a warning of its own.
constexpr std::string_view kSupportedExtensions[] = {"EXT_mesh_gpu_instancing",
                                                     "EXT_meshopt_compression",
                                                     "EXT_texture_webp",
                                                     "KHR_draco_mesh_compression",
                                                     "KHR_gaussian_splatting",
                                                     "KHR_lights_punctual",
                                                     "KHR_materials_emissive_strength",
                                                     "KHR_materials_ior",
                                                     "KHR_materials_pbrSpecularGlossiness",
                                                     "KHR_materials_transmission",
                                                     "KHR_materials_unlit",
                                                     "KHR_mesh_quantization",
                                                     "KHR_texture_basisu",
                                                     "KHR_texture_transform",
                                                     "MSFT_texture_dds"};

// The geometry of a file that uses this extension is compressed and cannot be read.
constexpr std::string_view kCompressionExtensions[] = {"KHR_meshopt_compression"};

template <class Names>
bool is_one_of(std::string_view name, const Names& names) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

json parse_json(std::string_view text, const GltfDocument& document) {
  try {
    return json::parse(text);
  } catch (const json::exception& e) {
    // The message ends with the token that was read last, which may be a whole embedded buffer.
    const std::string_view message = e.what();
    document.fail("is not valid JSON: " + std::string(message.substr(0, message.find("; last read"))));
  }
}

// These extensions change looks and no geometry, so a file is shown without them although it requires them.
bool is_of_materials(std::string_view extension) { return extension.starts_with("KHR_materials_"); }

// Runs before all other checks, because a required extension may change the meaning of everything.
void check_required_extensions(const json& root, const GltfDocument& document) {
  const auto required = root.is_object() ? root.find("extensionsRequired") : root.end();
  if (!root.is_object() || required == root.end() || !required->is_array()) return;
  std::string unsupported;
  for (const json& item : *required) {
    if (!item.is_string()) continue;
    const std::string& name = item.get_ref<const std::string&>();
    if (is_one_of(name, kCompressionExtensions)) {
      document.fail("requires " + name + ": this compression is not supported; save the file without compression");
    }
    if (is_of_materials(name)) continue;  // told of by warn_of_unsupported_extensions()
    if (!is_one_of(name, kSupportedExtensions)) unsupported += (unsupported.empty() ? "" : ", ") + name;
  }
  if (unsupported.empty()) return;
  std::string supported;
  for (const std::string_view name : kSupportedExtensions)
    supported += (supported.empty() ? "" : ", ") + std::string(name);
  document.fail("requires extensions that are not supported: " + unsupported + "; supported are " + supported);
}

void warn_of_unsupported_extensions(GltfDocument& document) {
  std::vector<std::string> names = document.model.extensionsUsed;
  for (const std::string& name : document.model.extensionsRequired) {
    if (is_of_materials(name)) names.push_back(name);
  }
  for (const std::string& name : names) {
    if (!is_one_of(name, kSupportedExtensions)) document.warn("extension " + name + " is not supported and left out");
  }
}

// Returns the major number of the version, or -1.
int major_version(const std::string& version) {
  const std::size_t dot = version.find('.');
  const bool digits = dot != std::string::npos && dot > 0 && dot <= 4 && dot + 1 < version.size() &&
                      version.find_first_not_of("0123456789.") == std::string::npos &&
                      version.find('.', dot + 1) == std::string::npos;
  return digits ? std::stoi(version.substr(0, dot)) : -1;
}

// The tables of glTF 1.0 are objects, whose members have names. Its version is often missing or a number.
void refuse_version_1(const json& root, const GltfDocument& document) {
  if (!root.is_object()) return;
  for (const char* const table : {"buffers", "meshes", "nodes"}) {
    if (!root.contains(table) || !root.at(table).is_object()) continue;
    document.fail("is glTF of version 1, since its " + std::string(table) +
                  " have names; expected version 2, into which gltf-pipeline converts it");
  }
}

void check_version(const json& root, const GltfDocument& document) {
  const json& asset = root.at("asset");
  const auto version = asset.at("version").get<std::string>();
  if (major_version(version) != 2) document.fail("asset/version is \"" + version + "\"; expected 2.0");
  const auto least = asset.value("minVersion", "2.0");
  if (least != "2.0") document.fail("asset/minVersion is \"" + least + "\"; SimVis reads glTF 2.0");
}

// The files of the buffers must be there, also if their bytes are not wanted.
void look_for_buffers(const json& root, GltfDocument& document) {
  const auto buffers = root.find("buffers");
  if (buffers == root.end()) return;
  for (const json& buffer : *buffers) {
    const auto uri = buffer.find("uri");
    const std::string place = "buffers/" + std::to_string(document.buffers.size());
    document.buffers.emplace_back();
    if (uri == buffer.end() || uri->get_ref<const std::string&>().starts_with("data:")) continue;
    const auto& text = uri->get_ref<const std::string&>();
    const std::filesystem::path path = document.file.parent_path() / relative_gltf_path(text, document.file, place);
    if (!is_input_file(path)) open_gltf_uri(text, document.file, place);  // which throws
  }
}

// `binary` is what a .glb holds for its first buffer, if that is there.
void open_buffers(const json& root, const std::optional<GltfBuffer>& binary, GltfDocument& document) {
  const auto buffers = root.find("buffers");
  if (buffers == root.end()) return;
  for (const json& buffer : *buffers) {
    const std::size_t index = document.buffers.size();
    const std::string place = "buffers/" + std::to_string(index);
    const auto length = buffer.at("byteLength").get<std::size_t>();
    const auto uri = buffer.find("uri");
    GltfBuffer opened;
    if (uri != buffer.end()) {
      opened = open_gltf_uri(uri->get_ref<const std::string&>(), document.file, place);
    } else if (index == 0 && binary) {
      opened = *binary;
    } else {
      document.buffers.emplace_back();
      continue;
    }
    if (opened.size() < length) {
      document.fail(place + " has " + std::to_string(opened.size()) + " bytes; expected " + std::to_string(length) +
                    " (byteLength)");
    }
    opened.cut(length);
    document.buffers.push_back(std::move(opened));
  }
}

void check_node_transforms(const json& root, const GltfDocument& document) {
  const auto nodes = root.find("nodes");
  if (nodes == root.end()) return;
  for (std::size_t i = 0; i < nodes->size(); ++i) {
    const json& node = (*nodes)[i];
    const bool has_trs = node.contains("translation") || node.contains("rotation") || node.contains("scale");
    if (node.contains("matrix") && has_trs) {
      document.fail("nodes/" + std::to_string(i) + " has both a matrix and translation, rotation or scale");
    }
  }
}

void read_images(json& root, GltfDocument& document) {
  const auto images = root.find("images");
  if (images == root.end()) return;
  for (json& image : *images) {
    const bool has_uri = image.contains("uri"), has_view = image.contains("bufferView");
    if (has_uri == has_view) {
      document.fail("images/" + std::to_string(document.images.size()) + " must have either uri or bufferView");
    }
    GltfImage& read = document.images.emplace_back();
    read.name = image.value("name", "");
    if (has_uri) read.uri = std::move(image.at("uri").get_ref<std::string&>());
    if (has_view) read.buffer_view = image.at("bufferView").get<int>();
  }
}

void read_animations(const json& root, GltfDocument& document) {
  const auto animations = root.find("animations");
  if (animations == root.end()) return;
  for (const json& animation : *animations) {
    GltfAnimation& read = document.animations.emplace_back();
    read.name = animation.value("name", "");
    for (const json& channel : animation.at("channels")) {
      const json& target = channel.at("target");
      read.channels.push_back(
          {channel.at("sampler").get<std::size_t>(), target.value("node", -1), target.at("path").get<std::string>()});
    }
    for (const json& sampler : animation.at("samplers")) {
      read.samplers.push_back(
          {sampler.at("input").get<int>(), sampler.at("output").get<int>(), sampler.value("interpolation", "LINEAR")});
    }
  }
}

void move_indices_to_attributes(json& root) {
  if (!root.contains("meshes")) return;
  for (json& mesh : root.at("meshes")) {
    for (json& primitive : mesh.at("primitives")) {
      json& attributes = primitive.at("attributes");
      attributes.erase(kGltfIndices);
      if (!primitive.contains("indices")) continue;
      attributes[kGltfIndices] = primitive.at("indices");
      primitive.erase("indices");
    }
  }
}

// tinygltf 2.7 reads beyond the end of a buffer for image buffer views that do not fit, and requires more properties of
// cameras and animations than the importer uses. It therefore gets a document without these parts.
void read_structure(json& root, GltfDocument& document) {
  for (const char* part : {"buffers", "images", "cameras", "animations"}) root.erase(part);
  move_indices_to_attributes(root);
  const std::string text = root.dump();
  if (text.size() > std::numeric_limits<unsigned int>::max()) document.fail("has more than 4 GiB of JSON");
  std::string error, warning;
  bool read = false;
  try {
    tinygltf::TinyGLTF loader;
    read = loader.LoadASCIIFromString(&document.model, &error, &warning, text.data(),
                                      static_cast<unsigned int>(text.size()), "", tinygltf::NO_REQUIRE);
  } catch (const std::bad_alloc&) {
    throw;  // says nothing about the file
  } catch (const std::exception& e) {
    error = e.what();
  }
  while (!error.empty() && error.back() == '\n') error.pop_back();
  if (!read) document.fail("is not valid glTF: " + error);
}

}  // namespace

void GltfDocument::fail(const std::string& what) const { throw InputError(file.string() + ": error: " + what); }

void GltfDocument::warn(const std::string& what) { add_warning(file.string() + ": " + what); }

void GltfDocument::add_warning(std::string warning) {
  if (!is_one_of(warning, warnings)) warnings.push_back(std::move(warning));
}

bool GltfDocument::uses(std::string_view extension) const { return is_one_of(extension, model.extensionsUsed); }

namespace {

// `binary` is as open_buffers() takes it; null: buffers stay closed.
void read_content(std::string_view text, const std::optional<GltfBuffer>* binary, GltfDocument& document) {
  json root = parse_json(text, document);
  refuse_version_1(root, document);
  check_required_extensions(root, document);
  if (read_specular_glossiness(root)) {
    document.warn("materials with KHR_materials_pbrSpecularGlossiness are shown without their specular colour");
  }
  check_and_prune_gltf(root, document.file);
  check_version(root, document);
  check_node_transforms(root, document);
  binary == nullptr ? look_for_buffers(root, document) : open_buffers(root, *binary, document);
  read_images(root, document);
  read_animations(root, document);
  read_structure(root, document);
  warn_of_unsupported_extensions(document);
}

}  // namespace

GltfDocument read_gltf_document(const std::filesystem::path& file, bool buffers) {
  GltfDocument document;
  document.file = file;
  const auto input = std::make_shared<const InputFile>(file);
  const GltfChunks chunks = split_gltf(*input, file);
  if (chunks.extra_bytes > 0) {
    document.warn(std::to_string(chunks.extra_bytes) + " bytes after the end of the .glb are left out");
  }
  std::optional<GltfBuffer> binary;
  if (chunks.has_binary) binary.emplace(input, chunks.binary_first, chunks.binary_size);
  document.structure_hash = fnv1a(chunks.text());
  read_content(chunks.text(), buffers ? &binary : nullptr, document);
  return document;
}

GltfDocument read_converted_gltf(const std::filesystem::path& file, std::string_view text, Bytes binary) {
  GltfDocument document;
  document.file = file;
  const std::optional<GltfBuffer> first = GltfBuffer(std::move(binary));
  read_content(text, &first, document);
  return document;
}

}  // namespace simvis
