#include "import/gltf/gltf_compression.h"

#include <meshoptimizer.h>

#include <string>
#include <utility>
#include <vector>

#include "import/gltf/gltf_accessors.h"
#include "import/sandbox/sandboxed_decode.h"

namespace simvis {
namespace {

constexpr const char* kMeshoptName = "EXT_meshopt_compression";
constexpr const char* kDracoName = "KHR_draco_mesh_compression";

std::size_t whole_number(const tinygltf::Value& object, const std::string& name) {
  // The checked document has these numbers as whole ones that a 32-bit integer holds.
  return object.Has(name) ? static_cast<std::size_t>(object.Get(name).GetNumberAsInt()) : 0;
}

std::string text_of(const tinygltf::Value& object, const std::string& name) {
  return object.Has(name) ? object.Get(name).Get<std::string>() : "NONE";
}

// Adds a buffer of these bytes alone and returns its number.
int add_buffer(GltfDocument& document, Bytes&& bytes) {
  document.buffers.emplace_back(std::move(bytes));
  return static_cast<int>(document.buffers.size()) - 1;
}

// One buffer view that EXT_meshopt_compression compresses.
class MeshoptView {
 public:
  MeshoptView(const GltfDocument& document, std::size_t index, const tinygltf::Value& extension)
      : document_(document),
        place_("bufferViews/" + std::to_string(index) + "/extensions/" + kMeshoptName),
        extension_(extension),
        mode_(text_of(extension, "mode")),
        filter_(text_of(extension, "filter")),
        count_(whole_number(extension, "count")),
        stride_(whole_number(extension, "byteStride")) {}

  Bytes decode() const {
    check_layout();
    const Bytes source = read_source();
    // Vertices take at least two bits for every 16 bytes, indices at least a byte for three of them.
    constexpr std::size_t kMaxBytesPerByte = 64;
    if (count_ > source.size() * kMaxBytesPerByte / stride_) {
      fail("gives " + std::to_string(count_) + " elements, more than its " + std::to_string(source.size()) +
           " bytes can hold");
    }
    Bytes bytes(count_ * stride_);
    if (run_decoder(bytes, source) != 0) fail("holds broken data");
    apply_filter(bytes);
    return bytes;
  }

 private:
  void check_layout() const {
    const auto expect = [&](bool holds, const char* what) {
      if (!holds) fail(std::string("has ") + what);
    };
    const bool is_vertices = mode_ == "ATTRIBUTES", is_triangles = mode_ == "TRIANGLES";
    expect(is_vertices || is_triangles || mode_ == "INDICES",
           "an unknown mode; expected ATTRIBUTES, TRIANGLES or INDICES");
    expect(is_vertices ? stride_ % 4 == 0 : stride_ == 2 || stride_ == 4,
           "a byteStride that does not fit; expected a multiple of 4 for ATTRIBUTES, 2 or 4 for indices");
    expect(!is_triangles || count_ % 3 == 0, "a count of TRIANGLES that is no multiple of 3");
    expect(filter_ == "NONE" || is_vertices, "a filter of indices");
    expect(filter_ == "NONE" || filter_ == "EXPONENTIAL" ||
               (filter_ == "OCTAHEDRAL" && (stride_ == 4 || stride_ == 8)) || (filter_ == "QUATERNION" && stride_ == 8),
           "a filter that is unknown or does not fit the byteStride");
  }

  Bytes read_source() const {
    const GltfBuffer& buffer = document_.buffers[whole_number(extension_, "buffer")];
    const std::size_t first = whole_number(extension_, "byteOffset"), size = whole_number(extension_, "byteLength");
    if (first > buffer.size() || size > buffer.size() - first) fail("does not lie within its buffer");
    return buffer.read(first, size);
  }

  int run_decoder(Bytes& bytes, const Bytes& source) const {
    if (mode_ == "ATTRIBUTES") {
      return meshopt_decodeVertexBuffer(bytes.data(), count_, stride_, source.data(), source.size());
    }
    if (mode_ == "TRIANGLES") {
      return meshopt_decodeIndexBuffer(bytes.data(), count_, stride_, source.data(), source.size());
    }
    return meshopt_decodeIndexSequence(bytes.data(), count_, stride_, source.data(), source.size());
  }

  void apply_filter(Bytes& bytes) const {
    if (filter_ == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), count_, stride_);
    if (filter_ == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), count_, stride_);
    if (filter_ == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), count_, stride_);
  }

  [[noreturn]] void fail(const std::string& what) const { document_.fail(place_ + " " + what); }

  const GltfDocument& document_;
  std::string place_;
  const tinygltf::Value& extension_;
  std::string mode_, filter_;
  std::size_t count_, stride_;
};

void decode_meshopt_views(GltfDocument& document) {
  for (std::size_t i = 0; i < document.model.bufferViews.size(); ++i) {
    tinygltf::BufferView& view = document.model.bufferViews[i];
    const auto extension = view.extensions.find(kMeshoptName);
    if (extension == view.extensions.end() || !document.buffers[static_cast<std::size_t>(view.buffer)].empty())
      continue;
    Bytes bytes = MeshoptView(document, i, extension->second).decode();
    view.byteOffset = 0;
    view.byteLength = bytes.size();
    view.buffer = add_buffer(document, std::move(bytes));
  }
}

// One primitive that KHR_draco_mesh_compression compresses.
class DracoPrimitive {
 public:
  DracoPrimitive(GltfDocument& document, tinygltf::Primitive& primitive, std::string place)
      : document_(document),
        primitive_(primitive),
        place_(std::move(place)),
        extension_(primitive.extensions.at(kDracoName)) {}

  // Whether the data that the compression stands for is not in the file in another form.
  bool is_needed() const {
    const tinygltf::Value& compressed = extension_.Get("attributes");
    for (const auto& [name, accessor] : primitive_.attributes) {
      if ((compressed.Has(name) || name == kGltfIndices) && !has_data(document_, accessor)) return true;
    }
    return false;
  }

  void decode() {
    if (primitive_.mode != TINYGLTF_MODE_TRIANGLES && primitive_.mode != TINYGLTF_MODE_TRIANGLE_STRIP) {
      document_.fail(place_ + " has a mode that Draco does not compress; expected triangles or a triangle strip");
    }
    const tinygltf::Value& compressed = extension_.Get("attributes");
    std::vector<std::string> names;
    std::vector<DracoAttribute> attributes;
    for (const auto& [name, accessor] : primitive_.attributes) {
      if (!compressed.Has(name)) continue;
      const tinygltf::Accessor& layout = document_.model.accessors[static_cast<std::size_t>(accessor)];
      names.push_back(name);
      attributes.push_back(
          {static_cast<std::uint32_t>(whole_number(compressed, name)), layout.componentType,
           static_cast<std::uint32_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(layout.type)))});
    }
    const Bytes source = view_bytes(document_, extension_.Get("bufferView").GetNumberAsInt(), place_);
    DracoMesh mesh = decode_draco_in_sandbox(source, attributes, document_.file.string() + ": error: " + place_);
    if (mesh.vertices == 0 || mesh.indices.empty()) document_.fail(place_ + " has no triangles");
    for (std::size_t i = 0; i < names.size(); ++i) {
      int& accessor = primitive_.attributes[names[i]];
      accessor = add_accessor(document_.model.accessors[static_cast<std::size_t>(accessor)], mesh.vertices,
                              std::move(mesh.attributes[i]));
    }
    set_indices(mesh.indices);
  }

 private:
  // The copy is this primitive's own: others may use the accessor with other data.
  int add_accessor(tinygltf::Accessor accessor, std::size_t count, Bytes&& bytes) {
    if (accessor.count != count) {
      document_.warn(place_ + " has " + std::to_string(count) + " elements where an accessor gives " +
                     std::to_string(accessor.count) + "; the compressed data counts");
    }
    tinygltf::BufferView view;
    view.byteLength = bytes.size();
    view.buffer = add_buffer(document_, std::move(bytes));
    document_.model.bufferViews.push_back(view);
    accessor.bufferView = static_cast<int>(document_.model.bufferViews.size()) - 1;
    accessor.byteOffset = 0;
    accessor.count = count;
    document_.model.accessors.push_back(std::move(accessor));
    return static_cast<int>(document_.model.accessors.size()) - 1;
  }

  // Draco data is a list of triangles, whatever the primitive's mode.
  void set_indices(const std::vector<std::uint32_t>& indices) {
    tinygltf::Accessor accessor;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.type = TINYGLTF_TYPE_SCALAR;
    const auto given = primitive_.attributes.find(kGltfIndices);
    const bool is_list = primitive_.mode == TINYGLTF_MODE_TRIANGLES && given != primitive_.attributes.end();
    accessor.count =
        is_list ? document_.model.accessors[static_cast<std::size_t>(given->second)].count : indices.size();
    const auto* const first = reinterpret_cast<const std::uint8_t*>(indices.data());
    const int index = add_accessor(std::move(accessor), indices.size(), Bytes(first, first + indices.size() * 4));
    primitive_.attributes[kGltfIndices] = index;
    primitive_.mode = TINYGLTF_MODE_TRIANGLES;
  }

  GltfDocument& document_;
  tinygltf::Primitive& primitive_;
  std::string place_;
  const tinygltf::Value& extension_;
};

void decode_draco_primitives(GltfDocument& document) {
  for (std::size_t m = 0; m < document.model.meshes.size(); ++m) {
    std::vector<tinygltf::Primitive>& primitives = document.model.meshes[m].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      if (primitives[p].extensions.count(kDracoName) == 0) continue;
      DracoPrimitive primitive(document, primitives[p],
                               "meshes/" + std::to_string(m) + "/primitives/" + std::to_string(p));
      if (primitive.is_needed()) primitive.decode();
    }
  }
}

}  // namespace

void decode_compressed_geometry(GltfDocument& document) {
  decode_meshopt_views(document);
  decode_draco_primitives(document);
}

}  // namespace simvis
